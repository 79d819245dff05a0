"""Proved properties of instrument: its scans are frames that its network takes."""

from tb.common.properties import Property
from tb.common.watch import sent


def properties(twin):
    scan, network = twin.scan_sequencer, twin.readout.network
    clocks = scan.scan_clocks
    taken = [n * scan.slot_clocks + scan.sample_clock for n in range(scan.slots)]
    judged, states, spacing = sent(network, f"u_readout_0.u_{network.entity}_0")
    at = " || ".join(f"clock_of_scan == {n}" for n in taken)
    arrived = " + ".join(f"(clock_of_scan > {n + 1})" for n in taken)
    # This counts the clocks since the last sample of the previous scan was judged.
    since = f"((clock_of_scan + {clocks - taken[-1] - 2}) % {clocks})"
    return [
        Property(
            name="right frames",
            sentence=f"Its network never sees a wrong frame: each scan of {clocks} clocks is a "
            f"frame of {scan.slots} samples, far enough behind the one before, from every reset "
            "on.",
            states=states,
            watch=judged
            + f"""
                reg [31:0] clock_of_scan = 0;
                reg sampled = 0, ended = 0;
                always @(posedge clk) begin
                    clock_of_scan <= rst || clock_of_scan == {clocks - 1} ? 0 : clock_of_scan + 1;
                    sampled <= !rst && ({at});
                    ended <= !rst && clock_of_scan == {taken[-1]};
                end
            """,
            helps=(
                f"clock_of_scan < {clocks}",
                "u_scan_sequencer_0.count == clock_of_scan",
                "valid == sampled && last == ended",
                f"!sampled || {' || '.join(f'clock_of_scan == {n + 1}' for n in taken)}",
                f"ended == (sampled && clock_of_scan == {taken[-1] + 1})",
                f"sampled || !({' || '.join(f'clock_of_scan == {n + 1}' for n in taken)})",
                f"sent_place == ({arrived}) % {scan.slots}",
                "!sent_skipping",
                f"sent_closed == 0 || sent_closed + {since} < {spacing}",
            ),
            reached=("last",),
            refuted_by=(
                (r"slot == 1\)\)", "slot == 0))"),
                (r"count == 63", "count == 30"),
                (r"\.in_last\(last\)", ".in_last(valid)"),
            ),
            clocks=clocks + 8,
        ),
    ]

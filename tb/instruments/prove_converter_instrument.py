"""Proved properties of converter_instrument: its frames are those that its network takes."""

from tb.common.properties import Property
from tb.common.watch import sent
from tb.sensing.prove_converter_reader import turns, verdict_clock


def properties(twin):
    reader, network = twin.converter_reader, twin.readout.network
    at = "u_converter_reader_0."
    slots, scan, verdict = reader.slots, reader.scan_clocks, verdict_clock(reader)
    # The clock of a scan behind the one in which its last transfer is judged.
    begin = (reader.inputs - 1) * reader.slot_clocks + verdict + 1
    judged, states, spacing = sent(network, f"u_readout_0.u_{network.entity}_0")
    return [
        Property(
            name="right frames",
            sentence=f"Its network never sees a wrong frame: all frames have {slots} samples, one "
            "per clock, and come far enough apart, whatever the converter sends and from every "
            "reset on.",
            states=states,
            assumes={
                f"A scan takes {scan} clocks, and its transfers end in the clocks that are proved "
                "of converter_reader.": (
                    f"any_clock < {scan} && {at}done == (sensor && into == {verdict}) "
                    f"&& (!{at}done || {at}slot == turn_of_scan)"
                ),
            },
            # A reset may come in any clock of a scan, so what is reached is reached soon.
            watch=f"""
                (* anyseq *) reg [31:0] any_clock;
                {turns(reader, "any_clock")}
                // Clocks since the last transfer of the scan was judged.
                wire [31:0] since = clock_of_scan >= {begin} ? clock_of_scan - {begin}
                    : clock_of_scan + {scan - begin};
                // Clocks since a frame has ended, if the scan before gave one.
                wire [31:0] ended = since > {slots} ? since - {slots} : since + {scan - slots};
            """
            + judged,
            helps=(
                f"clock_of_scan < {scan}",
                f"!{at}sending || (since < {slots} && {at}place == since)",
                f"!valid || (since >= 1 && since <= {slots})",
                f"last == (valid && since == {slots})",
                f"since < 1 || since >= {slots} || {at}sending == valid",
                "sent_place == (valid ? since - 1 : 0) && !sent_skipping",
                f"sent_closed == 0 || sent_closed + ended == {spacing}",
            ),
            free=(f"{at}done", f"{at}slot", f"{at}wrong"),
            reached=("last",),
            refuted_by=(
                (r"place == 3\)", "place == 2)"),
                (r"out_last <= closing", "out_last <= sending"),
                (r"\.in_last\(last\)", ".in_last(valid)"),
                (r"sending <= 0;", ""),
            ),
            clocks=slots + 6,
        ),
    ]

"""Proved properties of scan_sequencer."""

from tb.common.properties import Property


def properties(twin):
    slot = twin.slot_clocks
    taken = [n * slot + twin.sample_clock for n in range(twin.slots)]
    at = " || ".join(f"clock_of_scan == {n}" for n in taken)
    watch = f"""
        reg [15:0] clock_of_scan = 0;
        reg sampled = 0, ended = 0;
        reg signed [{twin.fmt.width - 1}:0] code;
        always @(posedge clk) begin
            clock_of_scan <= rst || clock_of_scan == {twin.scan_clocks - 1} ? 0 : clock_of_scan + 1;
            sampled <= !rst && ({at});
            ended <= !rst && clock_of_scan == {taken[-1]};
            if ({at}) code <= adc;
        end
    """
    helps = (f"clock_of_scan < {twin.scan_clocks}", "count == clock_of_scan")
    return [
        Property(
            name="one frame a scan",
            sentence=f"Each scan of {twin.scan_clocks} clocks sends {twin.slots} samples, each one "
            f"clock after clock {twin.sample_clock} of its slot, the last one with out_last. A "
            "reset begins a new scan and sends nothing of the old one.",
            states=("out_valid == sampled", "out_last == ended", "!out_valid || out_data == code"),
            watch=watch,
            helps=helps,
            reached=("out_last",),
            refuted_by=(
                (rf"clock == {twin.sample_clock}", f"clock == {twin.sample_clock - 1}"),
                (r"slot == 1\)\)", "slot == 0))"),
                (rf"count == {twin.scan_clocks - 1}", "count == 5"),
                (r"rst == 1\) begin\s+out_last", "0) begin out_last"),
            ),
            clocks=twin.scan_clocks + 4,
        ),
        Property(
            name="settled",
            sentence="In the clock in which a code is taken, the address has named its sensor "
            f"for {twin.sample_clock} clocks, including that one.",
            states=(f"!({at}) || (steady >= {twin.sample_clock - 1} && address == sensor)",),
            watch=watch
            + f"""
                // Clocks before this one in which the address was the same, and that of the slot.
                reg [15:0] steady = 0;
                reg [15:0] was = 0;
                always @(posedge clk) begin
                    was <= address;
                    steady <= rst ? 0 : address != was ? 1 : steady == 1000 ? 1000 : steady + 1;
                end
                // In what is left of the scan behind the slots, the first sensor's.
                wire [15:0] turn_of_scan = clock_of_scan / {slot};
                wire [15:0] sensor =
                    turn_of_scan < {twin.slots} ? turn_of_scan % {twin.inputs} : 0;
                wire [15:0] into = clock_of_scan % {slot};
            """,
            helps=(
                *helps,
                "steady <= 1000",
                "into < 1 || address == sensor",
                "into < 2 || (was == address && steady >= into - 1)",
            ),
            reached=(at,),
            refuted_by=((r"0: turn = 0", "0: turn = 1"),),
            clocks=twin.scan_clocks + 4,
        ),
    ]

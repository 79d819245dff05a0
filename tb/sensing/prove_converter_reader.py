"""Proved properties of converter_reader."""

from tb.common.properties import Property
from tb.common.watch import ago, results


def verdict_clock(twin):
    """The clock of a turn in which its transfer is judged."""
    return twin.begin_clock + 2 + 2 * twin.part.clocks * twin.half_clocks


def turns(twin, after_reset="0"):
    """Verilog that knows the clock of the scan, which is ``after_reset`` after a reset."""
    half, scan, first = twin.half_clocks, twin.scan_clocks, twin.begin_clock + 2
    return f"""
        reg [31:0] clock_of_scan = 0;
        always @(posedge clk)
            clock_of_scan <= rst ? {after_reset}
                : clock_of_scan == {scan - 1} ? 0 : clock_of_scan + 1;
        wire [31:0] turn_of_scan = clock_of_scan / {twin.slot_clocks};
        wire [31:0] into = clock_of_scan % {twin.slot_clocks};
        wire sensor = turn_of_scan < {twin.inputs};
        wire working = sensor && into >= {first};
        wire [31:0] halves = (into - {first}) / {half};
        wire [31:0] halves_next = (into - {first - 1}) / {half};
    """


def properties(twin):
    part, half, turn = twin.part, twin.half_clocks, twin.slot_clocks
    # The first clock of a turn in which the wires are active, and the clock of the verdict.
    first, verdict = twin.begin_clock + 2, verdict_clock(twin)
    least, slots = part.high_clocks(twin.clock), twin.slots
    clocks = turns(twin)
    helps = (
        f"clock_of_scan < {twin.scan_clocks}",
        "scan0_count == clock_of_scan",
        f"running == (sensor && into >= {first - 1} && into < {turn - 1})",
        "half == (running ? halves_next : 0)",
        *((f"transfer0_tick == (running ? (into - {first - 1}) % {half} : 0)",) * (half > 1)),
    )
    timing = Property(
        name="wires",
        sentence=f"In each of {twin.inputs} turns of {turn} clocks cs_n is low from clock {first} "
        f"on, and sclk changes every {'clock' if half == 1 else f'{half} clocks'} from then on, "
        f"{2 * part.clocks} times. At all other times cs_n is high and sclk is low. Before it "
        f"falls, cs_n is high for {first} clocks, also after a reset; the part asks for {least}.",
        states=(
            "cs_n == !working",
            "sclk == (working && halves[0])",
            f"!(was_high && !cs_n) || high_for >= {least}",
        ),
        watch=clocks
        + """
            reg was_high = 0;
            reg [15:0] high_for = 0;
            always @(posedge clk) begin
                was_high <= cs_n;
                high_for <= !cs_n ? 0 : high_for == 1000 ? 1000 : high_for + 1;
            end
        """,
        helps=(
            *helps,
            "high_for <= 1000",
            f"!sensor || into > {first} || high_for >= into || high_for == 1000",
            f"was_high == (high_for != 0) || into == {first} || clock_of_scan == 0",
        ),
        reached=("sclk",),
        refuted_by=(
            (r"cs_n <= \(!running\)", "cs_n <= 0"),
            (r"sclk <= \(running && half\[0\]\)", "sclk <= running && half[1]"),
            (rf"scan0_clock == {twin.begin_clock}\)", "scan0_clock == 0)"),
            (rf"half == {2 * part.clocks}(\)+ begin\s+running)", r"half == 3\1"),
        ),
        clocks=12,
    )

    mask = sum(1 << (part.clocks - clock) for clock in part.zeros)
    low = part.clocks - part.last
    mirror = [f"received[{low + i}] != received[{low - i}]" for i in range(1, part.bits)]
    bad = " || ".join(
        [
            f"!received[{part.clocks}]",
            f"(received & {mask}) != 0",
            *(mirror if part.mirrored else []),
        ]
    )
    telling = f"miso was not 1 before it, was 1 in clock {' or '.join(map(str, part.zeros))}"
    verdicts = Property(
        name="verdicts",
        sentence=f"In clock {verdict} of each turn, and in no other, a transfer is judged. It is "
        f"wrong exactly where {telling}"
        f"{', or did not repeat the code' if part.mirrored else ''}.",
        states=(
            f"done == (sensor && into == {verdict})",
            "!done || slot == turn_of_scan",
            f"wrong == ({bad})",
        ),
        watch=clocks,
        helps=helps,
        reached=("wrong", "!wrong"),
        refuted_by=(
            (r"\(!received\[\d+\]\) \|\| ", ""),
            (r"\(judge0_driven != 0\) \|\| ", ""),
            (r"other = 1'b1", "other = 1'b0"),
            (r"done <= \(read && ", "done <= (1 || "),
        ),
        clocks=8,
    )
    frames = Property(
        name="no frame beside the error",
        sentence="converter_error rises with each wrong transfer, and falls with the first scan "
        f"that has none. Such a scan, and nothing else, yields a frame: {slots} samples that begin "
        "two clocks after the verdict on its last transfer, the last one with out_last. No sample "
        "leaves while converter_error is high.",
        states=(
            "converter_error == told",
            "out_valid == sent",
            "out_last == sent_last",
            "!(out_valid && converter_error)",
        ),
        assumes={
            "No transfer ends while a frame leaves: a frame is shorter than a turn, as the twin "
            "checks.": "!(done && sending)",
        },
        watch=f"""
            reg was_bad = 0, told = 0;
            wire spoiled = wrong || (slot != 0 && was_bad);
            wire good = done && slot == {twin.inputs - 1} && !spoiled && !rst;
            always @(posedge clk) begin
                if (done) was_bad <= spoiled;
                if (done && spoiled) told <= 1;
                if (good) told <= 0;
                if (rst) begin was_bad <= 0; told <= 0; end
            end
        """
        + ago("good_ago", "good", 1)
        + results(slots, "good_ago[0]")
        + """
            reg sent = 0, sent_last = 0;
            always @(posedge clk) begin
                sent <= !rst && left != 0;
                sent_last <= !rst && left == 1;
            end
        """,
        helps=(
            "failed == was_bad",
            f"left <= {slots}",
            "sending == (left != 0)",
            f"!sending || place == {slots} - left",
            "left == 0 || !told",
            "!sent || !told",
        ),
        free=("done", "slot", "wrong"),
        reached=("out_last", "converter_error", "told && good"),
        refuted_by=(
            (r"failed <= spoilt", "failed <= 0"),
            (r"&& \(!spoilt\)", ""),
            (rf"place == {slots - 1}", f"place == {slots - 2}"),
            (r"out_last <= closing", "out_last <= sending"),
            (r"converter_error <= 1'b0", "converter_error <= converter_error"),
        ),
        clocks=slots + 8,
    )
    heard = Property(
        name="bits",
        sentence=f"miso is read {part.clocks + 1} times a turn: once before cs_n falls, and in "
        "each clock at whose end sclk falls. Each bit that is read is kept behind those before it, "
        "and nothing else is kept.",
        states=("!known || received == (reading_ago ? caught : before)",),
        watch=clocks
        + f"""
            wire reading = sensor && into >= {first - 1} && into <= {verdict - 1}
                && (into - {first - 1}) % {2 * half} == 0;
            reg reading_ago = 0, miso_before = 0, known = 0, begun = 0;
            reg [{part.clocks}:0] before = 0;
            wire [{part.clocks}:0] caught = {{before[{part.clocks - 1}:0], miso_before}};
            always @(posedge clk) begin
                reading_ago <= reading;
                miso_before <= miso;
                before <= received;
                begun <= 1;
                known <= begun;
            end
        """,
        helps=helps,
        reached=("reading_ago && miso_before",),
        refuted_by=(
            (r"if \(read\) begin", "if (1) begin"),
            (r"\}, miso\}|, miso\}", ", 1'b1}"),
            (r"running && \(!half\[0\]\)", "running && half[0]"),
        ),
        clocks=12,
    )
    return [timing, heard, verdicts, frames]

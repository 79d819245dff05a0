"""converter_reader against its twin, with a model of the part on its wires.

Random codes, recorded voltages, each bit that shows the presence of a converter wrong in each turn,
and resets in each bit of a transfer. The model judges every limit of the timing. What a reset about
the end of a transfer does, and while samples leave, is proved.
"""

import cocotb
import numpy as np

from golden.common.border import State
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.stimulus import random_resets
from tb.common.watch import ago, results
from tb.sensing.spi_converter import PINS, Converter, Timeline, check_error, listen

CASES = cases("converters")

WATCH = [*PINS, "out_valid", "out_data", "out_last", "converter_error"]
# How many scans a test plays, if they fit into so many clocks.
SCANS, MOST_CLOCKS = 20, 10_000


def check_pins(bench, recording, timeline):
    """Check ``cs_n`` and ``sclk`` in the clocks that the twin states."""
    twin = bench.twin
    reset = np.isin(timeline.rows - 1, timeline.marks)
    turn, clock = timeline.count // twin.slot_clocks, timeline.count % twin.slot_clocks
    into = clock - twin.begin_clock - 2
    low = (turn < twin.inputs) & (timeline.count < 1 << twin.counter_width) & (into >= 0) & ~reset
    high = low & (into // twin.half_clocks % 2 == 1)
    rows = timeline.rows
    bench.compare("cs_n", recording.unsigned("cs_n", rows), 1 - low, clock=timeline.count)
    bench.compare("sclk", recording.unsigned("sclk", rows), 1 * high, clock=timeline.count)
    bench.visit("turn", turn[turn < 1 << twin.slot_width])


def check_frames(bench, recording, timeline, transfers):
    """Check samples, their clocks and the right transfers, and return the codes of whole scans."""
    twin = bench.twin
    read, codes, right = timeline.read, timeline.codes, timeline.right
    if len(codes):
        bench.meet("rounded code", twin.quantities(codes)["rounded code"].ravel())

    whole = right.all(axis=1)
    frames = twin.process(codes[whole])[:, np.arange(twin.slots) % twin.inputs]
    at = read[whole, -1, -1:] + twin.latency + np.arange(twin.slots)
    begun = np.repeat(timeline.starts[whole], twin.slots)
    alive = recording.undisturbed(begun, at.ravel() - 1) & (at.ravel() < recording.clocks)
    left, got = at.ravel()[alive], frames.ravel()[alive]
    last = np.tile(np.arange(twin.slots) == twin.slots - 1, len(frames))[alive]
    bench.compare_stream(recording, left, got, last, clock=left)
    stays = np.flatnonzero(recording.undisturbed(left[:-1], left[1:] - 1))
    kept = recording.signed("out_data", left[stays + 1] - 1)
    bench.compare("kept data", kept, got[stays], clock=left[stays])

    # Every transfer of a complete scan was of its channel, and the code is the one that was sent.
    sent = {transfer.rows.start: transfer for transfer in transfers}
    first = read[:, :, 0] + 1
    asked = np.array([[sent[int(row)].channel for row in scan] for scan in first]).reshape(-1)
    bench.compare("channels", asked, np.tile(np.arange(twin.inputs), len(first)))
    return codes, right, np.array([[sent[int(r)].code for r in scan] for scan in first])


async def check(bench, scans, convert, resets=None, fault=lambda number: None):
    """Play scans and compare everything; gives codes received and sent, and what was right."""
    twin = bench.twin
    clocks = scans * twin.scan_clocks + twin.slots + 5 if resets is None else len(resets)
    column = np.zeros(clocks, dtype=np.int64) if resets is None else resets
    recording, transfers = await listen(bench, twin, column, WATCH, convert, fault)
    timeline = Timeline(twin, recording)
    check_pins(bench, recording, timeline)
    found = check_frames(bench, recording, timeline, transfers)
    beside = check_error(bench, twin, recording, timeline)
    assert not len(beside), f"a sample leaves in clock {beside[0]} beside converter_error"
    return recording, timeline, *found


def scans_that_fit(bench):
    return max(3, min(SCANS, MOST_CLOCKS // bench.twin.scan_clocks))


def random_codes(bench, count):
    """Random codes; one in four is an end of the range or near a border of the rounding."""
    top = 1 << bench.twin.part.bits
    marks = np.concatenate([np.arange(-6, 2), top // 2 + np.arange(-6, 2)]) % top
    codes = bench.rng.integers(0, top, count)
    return np.where(bench.rng.random(count) < 1 / 4, bench.rng.choice(marks, count), codes)


@cocotb.test()
async def codes(dut):
    """Play random codes, and check that the sent codes arrive."""
    bench = Bench(dut)
    twin, scans = bench.twin, scans_that_fit(bench)
    drawn = random_codes(bench, (scans + 2) * twin.inputs)
    # Few scans bring few codes, so the first two codes are those at the border.
    every = np.arange(1 << twin.part.bits)
    for border in twin.borders:
        exact = twin.quantities(every)[border.quantity]
        drawn[:2] = every[exact == border.at][0], every[exact == border.at - 1][-1]
    *_, got, right, sent = await check(bench, scans, lambda channel, number: int(drawn[number]))
    bench.compare("codes", got.ravel(), sent.ravel())
    assert right.all(), "a converter that works was told to be wrong"
    bench.finish(at_least=scans * twin.slots)


@cocotb.test()
async def voltages(dut):
    """Play recorded voltages, and check that the samples are those that the networks know."""
    bench = Bench(dut)
    twin = bench.twin
    recorded = np.concatenate(bench.given.recordings)
    scans = min(len(recorded), scans_that_fit(bench))
    frames = recorded[:scans]
    ideal = Converter(twin.part.name, twin.clock_mhz, bench.rng).sheet.ideal(frames)

    def convert(channel, number):
        scan, turn = divmod(number, twin.inputs)
        assert channel == turn, f"got channel {channel} in turn {turn}"
        return int(ideal[min(scan, scans - 1), channel])

    *_, got, right, _ = await check(bench, scans, convert)
    bench.compare("codes", got, ideal[: len(got)])
    bench.compare("the twin's converter", twin.converted(frames), ideal)
    step = 1 << max(0, -twin.shift)
    error = np.abs(twin.process(got) - frames[: len(got)])
    assert error.max() <= (step if frames.max() > twin.fmt.high - step else step // 2)
    assert right.all(), "a converter that works was told to be wrong"
    bench.finish(at_least=scans * twin.slots)


@cocotb.test()
async def missing_and_stuck(dut):
    """Play a line that nobody drives or that is stuck, then single wrong bits in each turn.

    Each of these bits shows the presence of a converter. Good scans come between them, so that the
    flag falls.
    """
    bench = Bench(dut)
    twin, part = bench.twin, bench.twin.part
    telling = [0, *part.zeros]
    if part.mirrored:
        telling += range(part.first, part.last + part.bits)
    wrong = [1, 0, *({bit: 1} for bit in telling)]
    if len(wrong) * twin.inputs * 2 * twin.scan_clocks > 2 * MOST_CLOCKS:
        wrong = wrong[:6]
    drawn = random_codes(bench, 3 * len(wrong) * twin.inputs * twin.inputs + 40)
    faults, scan = {}, 1
    for turn in range(twin.inputs):
        for one in wrong:
            faults[scan * twin.inputs + turn] = one
            scan += 2 if bench.rng.random() < 1 / 2 else 1
    # All of the line at once, and an end with scans that go right.
    for number in range(scan * twin.inputs, (scan + 2) * twin.inputs):
        faults[number] = 1
    *_, right, _ = await check(
        bench, scan + 4, lambda channel, number: int(drawn[number % len(drawn)]), fault=faults.get
    )
    # The middle bit is its own mirror image.
    harmless = sum(1 for one in faults.values() if one == {part.last: 1})
    expected = len([n for n in faults if n < right.size]) - harmless
    middle = np.array([int((~right).sum())])
    bench.compare("transfers that were told to be wrong", middle, np.array([expected]))
    bench.finish(at_least=scan)


@cocotb.test()
async def resets(dut):
    """Play resets at random, then one reset in each bit of a transfer."""
    bench = Bench(dut)
    twin, part = bench.twin, bench.twin.part
    drawn = random_codes(bench, 4000)

    def convert(channel, number):
        return int(drawn[number % len(drawn)])

    clocks = scans_that_fit(bench) * twin.scan_clocks // 2
    column = random_resets(bench.rng, clocks, 3 * twin.scan_clocks)
    column[-2 * twin.scan_clocks :] = 0
    await check(bench, 0, convert, resets=column)

    at, clock = [], -1
    for bit in range(part.clocks + 1):
        # The scan begins in the clock after a reset.
        row = int(twin.read_clocks[0, bit]) + int(bench.rng.integers(0, 2 * twin.half_clocks))
        clock += 1 + row
        at.append(clock)
    column = np.zeros(clock + twin.scan_clocks + twin.slots + 5, dtype=np.int64)
    column[at] = 1
    recording, *_ = await check(bench, 0, convert, resets=column)
    since = np.diff(recording.resets(), prepend=RESET_CLOCKS - 1) - 1
    bits = (since - twin.read_clocks[0, 0]) // (2 * twin.half_clocks)
    state = State("bit of a transfer that a reset cuts", range(part.clocks + 1))
    bench.visit(state, bits)
    bench.finish(at_least=twin.slots)


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
    transfers = Property(
        name="transfers",
        sentence=f"In each of {twin.inputs} turns of {turn} clocks cs_n is low from clock {first} "
        f"on, and sclk changes every {'clock' if half == 1 else f'{half} clocks'} from then on, "
        f"{2 * part.clocks} times. At all other times cs_n is high and sclk is low. Before it "
        f"falls, cs_n is high for {first} clocks, also after a reset; the part asks for {least}. "
        f"miso is read {part.clocks + 1} times a turn: once before cs_n falls, and in each clock "
        "at whose end sclk falls. Each bit that is read is kept behind those before it, and "
        f"nothing else is kept. In clock {verdict} of each turn, and in no other, a transfer is "
        f"judged. It is wrong exactly where {telling}"
        f"{', or did not repeat the code' if part.mirrored else ''}.",
        states=(
            "cs_n == !working",
            "sclk == (working && halves[0])",
            f"!(was_high && !cs_n) || high_for >= {least}",
            "!known || received == (reading_ago ? caught : before)",
            f"done == (sensor && into == {verdict})",
            "!done || slot == turn_of_scan",
            f"wrong == ({bad})",
        ),
        watch=turns(twin)
        + f"""
            reg was_high = 0;
            reg [15:0] high_for = 0;
            wire reading = sensor && into >= {first - 1} && into <= {verdict - 1}
                && (into - {first - 1}) % {2 * half} == 0;
            reg reading_ago = 0, miso_before = 0, known = 0, begun = 0;
            reg [{part.clocks}:0] before = 0;
            wire [{part.clocks}:0] caught = {{before[{part.clocks - 1}:0], miso_before}};
            always @(posedge clk) begin
                was_high <= cs_n;
                high_for <= !cs_n ? 0 : high_for == 1000 ? 1000 : high_for + 1;
                reading_ago <= reading;
                miso_before <= miso;
                before <= received;
                begun <= 1;
                known <= begun;
            end
        """,
        helps=(
            f"clock_of_scan < {twin.scan_clocks}",
            "scan0_count == clock_of_scan",
            f"running == (sensor && into >= {first - 1} && into < {turn - 1})",
            "half == (running ? halves_next : 0)",
            *((f"transfer0_tick == (running ? (into - {first - 1}) % {half} : 0)",) * (half > 1)),
            "high_for <= 1000",
            f"!sensor || into > {first} || high_for >= into || high_for == 1000",
            f"was_high == (high_for != 0) || into == {first} || clock_of_scan == 0",
        ),
        reached=("sclk", "reading_ago && miso_before", "wrong", "!wrong"),
        refuted_by=(
            (r"cs_n <= \(!running\)", "cs_n <= 0"),
            (r"sclk <= \(running && half\[0\]\)", "sclk <= running && half[1]"),
            (rf"scan0_clock == {twin.begin_clock}\)", "scan0_clock == 0)"),
            (rf"half == {2 * part.clocks}(\)+ begin\s+running)", r"half == 3\1"),
            (r"if \(read\) begin", "if (1) begin"),
            (r"\}, miso\}|, miso\}", ", 1'b1}"),
            (r"running && \(!half\[0\]\)", "running && half[0]"),
            (r"\(!received\[\d+\]\) \|\| ", ""),
            (r"\(judge0_driven != 0\) \|\| ", ""),
            (r"other = 1'b1", "other = 1'b0"),
            (r"done <= \(read && ", "done <= (1 || "),
        ),
        clocks=12,
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
            "checks.": "!(done && sending)"
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
    return [transfers, frames]

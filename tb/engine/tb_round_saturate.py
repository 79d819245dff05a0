"""round_saturate against its twin.

Sweeps: every sample; sums at and around both ends of the sum and of the word, around zero, around
the places at which the result changes, at every power of two, and 4000 random sums of every size;
where bits are cut, also sums half way between two codes, and with one bit more.
Drives: a sum and a sample every clock, alternately while a frame is computed and while none is,
with ReLU and without it where the block has ReLU.
Checks: the word bit for bit, and the clock in which it appears.
Does not prove: that every sum is right.
"""

import cocotb
import numpy as np

from golden.engine.formats import DROPPED
from golden.engine.operand_memory import WORD
from golden.fixed import Fix
from golden.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.small import ENGINES, LAYERED

WITH_RELU = ("layers-engine", "exact-engine", "floor-engine")
CASES = {"rails-engine": ENGINES["rails-engine"]} | {name: LAYERED[name] for name in WITH_RELU}
# The hardware of these cases has ReLU. The last two also drop bits: one rounds halves to even, and
# the other rounds down.
ALSO = WITH_RELU
FAULTS = [
    (r"above != 0\)", "above != 1)"),
    (r"if \(acc\[\d+\]\)", "if (!acc[0])"),
    (r"wide << 3", "wide << 2"),
    (r"if \(run\)", "if (1)"),
]


def sums(bench):
    """Codes of the sum for which an error shows in the result."""
    fmt = Fix(bench.twin.acc_width, 0)
    steps = bench.rng.integers(WORD.low, WORD.high + 1, 1000)
    marks = np.concatenate([[WORD.low, WORD.high, WORD.high + 1, 0, 1, -1], steps]) << DROPPED
    if bench.twin.cut:
        # These sums lie half way between two codes of the result, or have a single one of the bits
        # below that. There are enough of them that some come with ReLU.
        unit = bench.twin.cut + DROPPED
        halves = (steps >> bench.twin.cut) << unit
        alone = (1 << unit) + (1 << np.arange(unit).repeat(10))
        marks = np.concatenate([marks, halves, alone])
    powers = 1 << np.arange(fmt.width - 1)
    marks = np.concatenate([marks, powers, -powers, [fmt.low, fmt.high]])
    near = (marks[:, np.newaxis] + np.arange(-2, 3)).ravel()
    random = bench.rng.integers(fmt.low, fmt.high + 1, 4000) >> bench.rng.integers(
        0, fmt.width - 1, 4000
    )
    codes = np.concatenate([near, random])
    return codes[(codes >= fmt.low) & (codes <= fmt.high)]


@cocotb.test()
async def sums_and_samples(dut):
    bench = Bench(dut)
    accs = sums(bench)
    samples = np.arange(SIGNAL.low, SIGNAL.high + 1)
    order = bench.rng.permutation(len(accs) + len(samples))
    run = order < len(accs)
    acc, sample = bench.rng.choice(accs, len(order)), bench.rng.choice(samples, len(order))
    acc[run], sample[~run] = accs[order[run]], samples[order[~run] - len(accs)]
    drive = {"run": run.astype(np.int64), "acc": acc, "sample": sample}
    if bench.twin.rectifies:
        drive["relu"] = bench.rng.integers(0, 2, len(order))
    recording = await bench.play(drive, ["word"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    flags = recording.unsigned("run", rows).astype(bool)
    seen = recording.signed("acc", rows), recording.signed("sample", rows)
    got = recording.signed("word", rows + bench.latency)
    relu = recording.unsigned("relu", rows) if bench.twin.rectifies else np.zeros(len(rows), int)
    expected = bench.twin.process(flags, *seen, relu)
    bench.meet("sum", seen[0][flags])
    bench.compare("word", got, expected, run=flags, acc=seen[0], sample=seen[1], relu=relu)
    bench.finish(at_least=16384)

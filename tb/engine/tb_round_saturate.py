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

from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import SERIAL_ENGINES
from tb.common.stimulus import sums_to_round

# The hardware of these cases has ReLU. The last two also drop bits: one rounds halves to even, and
# the other rounds down.
ALSO = ("layers-serial", "exact-serial", "floor-serial")
CASES = {name: SERIAL_ENGINES[name] for name in ("rails-serial", *ALSO)}


@cocotb.test()
async def sums_and_samples(dut):
    bench = Bench(dut)
    accs = sums_to_round(bench.rng, bench.twin.acc_width, bench.twin.cut)
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

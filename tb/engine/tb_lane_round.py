"""lane_round against its twin.

Sweeps: sums at and around both ends of the sum and of the word, around zero, around the places at
which the result changes, at every power of two, and 4000 random sums of every size; where bits are
cut, also sums half way between two codes, and with one bit more; in the first lane every sample, in
another lane both ends and random words of the first one, some with zeros.
Drives: a sum and what is given in its place every clock, in random order, with ReLU and without it
where the block has ReLU.
Checks: the word bit for bit, and the clock in which it appears; in the first lane also what the
other lanes are given, in the clock before.
Does not prove: that every sum is right.
"""

import cocotb
import numpy as np

from golden.engine.lane_accumulate import beyond
from golden.engine.operand_memory import WORD
from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LANES
from tb.common.stimulus import sums_to_round

# The hardware of these cases has ReLU. The last two also drop bits: one rounds halves to even, and
# the other rounds down.
ALSO = ("relu-lanes", "exact-lanes", "floor-lanes")
CASES = {name: LANES[name] for name in ("rails-lanes", *ALSO)}


@cocotb.test()
async def sums_and_what_is_given(dut):
    bench = Bench(dut)
    twin, rng = bench.twin, bench.rng
    accs, fmt = sums_to_round(rng, twin.acc_width, twin.cut), SIGNAL if twin.leads else WORD
    count = 16384
    given = np.arange(fmt.low, fmt.high + 1)
    if not twin.leads:
        random = rng.integers(fmt.low, fmt.high + 1, count - 2)
        given = np.concatenate([[fmt.low, fmt.high], random])
    order = rng.permutation(len(accs) + count)
    own = order < len(accs)
    acc, other = rng.choice(accs, len(order)), rng.choice(given, len(order))
    acc[own], other[~own] = accs[order[own]], given[order[~own] - len(accs)]
    high, low = beyond(acc)
    drive = {"own": own.astype(np.int64), "acc": acc, "high": high, "low": low}
    drive |= {"sample": other} if twin.leads else {"other": other}
    if not twin.leads:
        drive |= {f"other_{name}": rng.integers(0, 2, len(order)) for name in twin.zeros}
    if twin.rectifies:
        drive["relu"] = rng.integers(0, 2, len(order))
    passed = ["next_word", *(f"next_{name}" for name in twin.zeros)] if twin.leads else []
    # The last one only fills the pipeline.
    recording = await bench.play(
        {n: np.append(c, c[:1]) for n, c in drive.items()}, ["word", *passed]
    )
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)

    def shown(word, where):
        """A word behind the register, where the flags of ``where`` tell of zeros."""
        zero = {name: recording.unsigned(f"{where}_{name}", rows) for name in twin.zeros}
        return twin.without_zeros(recording.signed(word, rows), zero)

    flags = recording.unsigned("own", rows).astype(bool)
    seen = recording.signed("acc", rows)
    if twin.leads:
        taken = recording.signed("sample", rows)
    else:
        taken = shown("other", "other")
    relu = recording.unsigned("relu", rows) if twin.rectifies else np.zeros(len(rows), int)
    expected = twin.process(flags, seen, taken, relu)
    got = recording.signed("word", rows + bench.latency)
    bench.compare("word", got, expected, own=flags, acc=seen, given=taken, relu=relu)
    if twin.leads:
        bench.compare("next_word", shown("next_word", "next"), expected)
    bench.finish(at_least=16384)

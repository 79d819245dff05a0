"""bipartite against its twin: codes over the whole range, back to back, with gaps and resets.

For each bit of every word of both tables there is a code of either sign whose result it changes.
"""

import cocotb

from tb.common import activation
from tb.common.bench import Bench
from tb.common.case_library import BIPARTITE
from tb.common.properties import Property
from tb.common.watch import ago, pipeline

CASES = BIPARTITE


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await activation.sweep(bench, bench.twin.word_codes, at_least=4096)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await activation.gaps_and_resets(bench, bench.twin.word_codes)


# In one copy the valid flag skips its last register, in the other a register has no reset.
LATE = (
    (r"out_valid <= (\w+)\[\(3 - 1\)\]", r"out_valid <= \1[1]"),
    (r"(delay\d+_taps\[2\]) <= 0;", ""),
)
EARLY_SIGN = (r"(\w+)negative_late <= [^;]+", r"\1negative_late <= \1negative")


def sign(activation, node="", refuted_by=EARLY_SIGN):
    """The property that the sign of a node is right, whatever the tables hold."""
    number = node.strip("_") or "0"
    tables = "memories" if activation.memory == "block_ram" else "logic"
    inside = f"node{number}_from_{tables}{number}"
    late, last = activation.latency, activation.out_fmt.width - 1
    top = activation.in_fmt.width - 1
    return Property(
        name=f"sign{node}",
        sentence=f"A result of out_data{node} has the sign that in_data{node} had {late} clocks "
        "before.",
        states=(f"!out_valid || out_data{node}[{last}] == sign_ago[{late - 1}]",),
        watch=ago("sign_ago", f"in_data{node}[{top}]", late) + ago("valid_ago", "in_valid", late),
        helps=(f"out_valid == valid_ago[{late - 1}]",),
        free=(f"{inside}_base_word", f"{inside}_slope_word"),
        reached=(f"out_valid && out_data{node}[{last}]",),
        refuted_by=(refuted_by,),
        clocks=late + 3,
        induction=late + 1,
    )


def properties(twin):
    return [pipeline(twin, LATE), sign(twin)]

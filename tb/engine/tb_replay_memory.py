"""replay_memory against its twin.

Sweeps: every pass over every neuron of the program, the word after the program, and every address
of the table that the port can carry.
Drives: one run from the first word to beyond the last one and around the memory; then runs of
random length with ``finish`` at random clocks, also together with ``run``; then resets. The port of
the table carries a random address in every clock, and a word is requested in two of three clocks.
Checks: word, plane, first and the word of the table bit for bit, and their clocks. In the clock
after a reset nothing has been read yet, so only the plane is checked.
Does not prove: that the program is the right one (the bench of the engine does).
"""

import cocotb
import numpy as np

from golden.networks.engine import Engine
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import SERIAL_PARTS
from tb.common.stimulus import look_ups, random_resets, random_runs

CASES = SERIAL_PARTS


async def check(bench, run, finish, resets):
    twin, rng = bench.twin, bench.rng
    length = len(run)
    asked = look_ups(rng, 1 << twin.segment_addr_width, length)
    drive = {"run": run, "finish": finish, **asked}
    if resets:
        drive["rst"] = random_resets(rng, length, every=200)
    recording = await bench.play(drive, ["word", "plane", "first", "table_word"])

    # The program begins after the initial reset.
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    flags = [recording.unsigned(name, rows) for name in ("run", "finish", "rst")]
    for name, values in zip(("place", "plane"), twin.places(*flags)[:2], strict=True):
        bench.visit(name, values)
    # A word that is read in a clock of a reset is not valid, and the plane is then reset.
    read = recording.undisturbed(rows - 1, rows - 1) & (rows > RESET_CLOCKS)
    every = np.ones(len(rows), dtype=bool)
    compared = {"word": read, "plane": every, "first": read}
    for (name, valid), expected in zip(compared.items(), twin.process(*flags), strict=True):
        got = recording.unsigned(name, rows[valid])
        bench.compare(name, got, expected[valid], clock=rows[valid])
    seen = [recording.unsigned(name, rows) for name in ("segment", "look_up")]
    asked = recording.undisturbed(rows, rows + bench.latency - 1)
    got = recording.unsigned("table_word", rows[asked] + bench.latency)
    bench.compare("table_word", got, twin.look_up(*seen)[asked], segment=seen[0][asked])


@cocotb.test()
async def whole_program(dut):
    bench = Bench(dut)
    # The counter runs past the program, where no word ends a pass, and through the table to the
    # beginning of the program.
    length = bench.around(Engine)[0].output_clocks[-1] + 2 * len(bench.twin.contents)
    await check(bench, np.ones(length), np.zeros(length), resets=False)
    bench.finish(at_least=length)


@cocotb.test()
async def runs(dut):
    bench = Bench(dut)
    await check(bench, *random_runs(bench.rng, 6000, longest=600, every=300), resets=False)
    bench.finish(at_least=20000)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    await check(bench, *random_runs(bench.rng, 6000, longest=600, every=300), resets=True)
    bench.finish(at_least=20000)

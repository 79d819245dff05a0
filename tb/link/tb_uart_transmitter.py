"""uart_transmitter against its twin.

Sweeps: every byte.
Drives: bytes as soon as they are taken, then at random clocks; resets at random, in each bit, and
in each clock of a bit before a pause; and a UART of cocotbext-uart that listens.
Checks: ``tx`` and ``in_ready`` in every clock; that the UART receives every byte.
Does not prove: that a computer with an inexact clock reads the line (tb_uart_receiver drives such a
line).
"""

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge
from cocotbext.uart import UartSink

from golden.link.uart_transmitter import BYTE_BITS
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import UARTS
from tb.common.stimulus import random_resets

CASES = UARTS
CLOCK_NS = 10


async def check(bench, valid, resets=None):
    """Play bytes and compare every clock."""
    length = len(valid)
    data = bench.rng.permutation(np.arange(length) % 256)
    drive = {"in_valid": valid, "in_data": data}
    if resets is not None:
        drive["rst"] = resets
    recording = await bench.play(drive, ["in_ready", "tx"])
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    names = ("in_valid", "in_data", "rst")
    seen = [recording.unsigned(name, rows) for name in names]
    ready, tx = bench.twin.process(*seen)
    bench.compare("in_ready", recording.unsigned("in_ready", rows), ready, clock=rows)
    bench.compare("tx", recording.unsigned("tx", rows), tx, clock=rows)
    taken = rows[ready & (seen[0] == 1) & (seen[2] == 0)]
    cut = recording.resets()
    if len(taken) and len(cut):
        before = np.searchsorted(taken, cut) - 1
        into = (cut - taken[before] - 1)[before >= 0]
        bench.visit("bit that a reset cuts", into[into >= 0] // bench.twin.divisor)


@cocotb.test()
async def back_to_back(dut):
    bench = Bench(dut)
    await check(bench, np.ones(12 * bench.twin.interval, dtype=np.int64))
    bench.finish(at_least=10 * bench.twin.interval)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    length = 40 * bench.twin.interval
    valid = (bench.rng.random(length) < 1 / bench.twin.interval).astype(np.int64)
    await check(bench, valid)
    resets = random_resets(bench.rng, length, bench.twin.interval)
    await check(bench, valid, resets)
    # A byte is taken in the clock after each reset, and the next reset falls into another bit of
    # it.
    into = bench.rng.integers(0, bench.twin.divisor, BYTE_BITS)
    at = np.cumsum(2 + np.arange(BYTE_BITS) * bench.twin.divisor + into)
    resets = np.zeros(at[-1] + 5, dtype=np.int64)
    resets[at] = 1
    await check(bench, np.ones_like(resets), resets)
    # A reset comes in each clock of a bit, with no byte after it.
    into = np.arange(bench.twin.divisor)
    taken = 3 * bench.twin.interval * into
    valid, resets = np.zeros((2, taken[-1] + 3 * bench.twin.interval), dtype=np.int64)
    valid[taken], resets[taken + 1 + bench.twin.divisor + into] = 1, 1
    await check(bench, valid, resets)
    bench.finish(at_least=length)


@cocotb.test()
async def a_uart_listens(dut):
    """Send every byte, in random order and with random pauses."""
    bench = Bench(dut)
    dut.in_valid.value, dut.rst.value = 0, 1
    cocotb.start_soon(Clock(dut.clk, CLOCK_NS, unit="ns").start(start_high=False))
    await ClockCycles(dut.clk, 3)
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    sink = UartSink(dut.tx, baud=1e9 / (CLOCK_NS * bench.twin.divisor))
    sink.log.setLevel("WARNING")
    sent = bench.rng.permutation(256)
    for byte in sent.tolist():
        await FallingEdge(dut.clk)
        dut.in_valid.value, dut.in_data.value = 1, byte
        while not int(dut.in_ready.value):
            await RisingEdge(dut.in_ready)
            await FallingEdge(dut.clk)
        await FallingEdge(dut.clk)
        dut.in_valid.value = 0
        if bench.rng.random() < 1 / 8:
            await ClockCycles(dut.clk, int(bench.rng.integers(1, 2 * bench.twin.interval)))
    await ClockCycles(dut.clk, (BYTE_BITS + 1) * bench.twin.divisor)
    bench.compare("bytes", np.frombuffer(bytes(sink.read_nowait()), np.uint8), sent)
    bench.finish(at_least=256)

"""uart_receiver against its twin.

Sweeps: every byte.
Drives: bytes on a line whose bits are up to 2 % too short or too long and begin at any part of a
clock, back to back and with pauses; bytes without a stop bit; a line that stays 0; low pulses that
are too short for a start bit, and two falling edges within half a bit; noise; resets in each bit;
and the bytes that a UART of cocotbext-uart sends.
Checks: the byte, ``out_valid`` and ``line_error`` in every clock; that every byte which was sent
correctly arrives.
Does not prove: that the block works if the line changes while the clock rises; two registers are
there for this.
"""

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge
from cocotbext.uart import UartSource

from golden.link.uart_transmitter import bits_of
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import UART
from tb.common.stimulus import random_resets

CASES = {"uart": UART}
CLOCK_NS = 10


def wire(bench, stretches):
    """The levels of the line; each lasts a given number of bits of ``bit`` clocks."""
    edges = np.cumsum([0.0, *(length for _, length in stretches)]) + bench.rng.random()
    clocks = np.arange(int(edges[-1]) + 3 * bench.twin.interval)
    place = np.searchsorted(edges, clocks, side="right") - 1
    levels = np.array([level for level, _ in stretches] + [1])
    return np.where(place < 0, 1, levels[np.clip(place, 0, len(stretches))])


def stretches_of(bench, sent, off, pause):
    """The levels and durations of bytes whose bits are ``off`` times as long as they should be."""
    bit = bench.twin.divisor * off
    found = [(1, 3.0)]
    for byte in sent:
        found += [(level, bit) for level in bits_of(byte)]
        if bench.rng.random() < pause:
            found.append((1, float(bench.rng.random() * bit * 20)))
    return found


async def check(bench, line, resets=None):
    """Play a line, compare every clock, and return the received bytes."""
    drive = {"rx": line}
    if resets is not None:
        drive["rst"] = resets
    recording = await bench.play(drive, ["out_valid", "out_data", "line_error"])
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    expected = bench.twin.process(recording.unsigned("rx", rows), recording.unsigned("rst", rows))
    came = recording.rows("out_valid")
    bench.compare("clocks of out_valid", came, rows[expected.out_valid])
    bench.compare("clocks of line_error", recording.rows("line_error"), rows[expected.line_error])
    got = recording.unsigned("out_data", came)
    bench.compare("out_data", got, expected.out_data[expected.out_valid], clock=came)
    return got, recording


@cocotb.test()
async def every_byte(dut):
    """Bits of exact length and off by 2 %: each byte arrives."""
    bench = Bench(dut)
    for off, pause in ((1.0, 0.0), (0.98, 0.0), (1.02, 0.3)):
        sent = bench.rng.permutation(256)[: 256 if off == 1.0 else 100]
        got, _ = await check(bench, wire(bench, stretches_of(bench, sent.tolist(), off, pause)))
        bench.compare("bytes", got, sent)
    bench.finish(at_least=800)


@cocotb.test()
async def noise(dut):
    """Bytes without a stop bit, a line that stays 0, short low pulses, and random levels."""
    bench = Bench(dut)
    twin, rng = bench.twin, bench.rng
    found, sent = [(1, 3.0)], []
    for byte in rng.integers(0, 256, 40).tolist():
        bits = bits_of(byte)
        wrong = int(rng.integers(0, 4))
        if wrong == 0:
            bits = (*bits[:-1], 0)
        elif wrong == 1:
            found += [(0, twin.divisor // 2 - 0.5), (1, 2.0 * twin.interval)]
        elif wrong == 2:
            found += [(0, float(rng.integers(11, 30) * twin.divisor)), (1, float(twin.interval))]
        found += [(level, float(twin.divisor)) for level in bits] + [(1, 2.0 * twin.divisor)]
        sent += [byte] if wrong else []
    got, recording = await check(bench, wire(bench, found))
    bench.compare("bytes", got, np.array(sent))
    assert len(recording.rows("line_error")), "no byte was without a stop bit"
    random = [(int(rng.integers(0, 2)), float(rng.integers(1, 12))) for _ in range(600)]
    await check(bench, wire(bench, random))
    # The line is 0 half a bit after the first of two falling edges, so the byte begins there.
    twice = [(1, 3.0)]
    for byte in rng.integers(0, 256, 20).tolist():
        twice += [(0, 1.0), (1, twin.divisor // 2 - 1.0)]
        twice += [(level, float(twin.divisor)) for level in bits_of(byte)]
        twice += [(1, 2.0 * twin.interval)]
    await check(bench, wire(bench, twice))
    bench.finish(at_least=40)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    twin, rng = bench.twin, bench.rng
    sent = rng.integers(0, 256, 60).tolist()
    line = wire(bench, stretches_of(bench, sent, 1.0, 0.1))
    await check(bench, line, random_resets(rng, len(line), 2 * twin.interval))
    # One byte after another is cut by a reset, each in the next of its bits.
    cut, at = np.zeros(0, dtype=np.int64), []
    pieces = []
    for bit in twin.states[0].values:
        piece = wire(bench, [(1, 3.0 * twin.divisor), *((0, twin.divisor) for _ in range(10))])
        start = int(np.flatnonzero(piece == 0)[0]) + twin.synchroniser
        at.append(start + bit * twin.divisor + int(rng.integers(0, twin.divisor)))
        column = np.zeros(len(piece), dtype=np.int64)
        column[at[-1]] = 1
        pieces.append(piece)
        cut = np.concatenate([cut, column])
        at[-1] = (at[-1] - start) // twin.divisor
    await check(bench, np.concatenate(pieces), cut)
    bench.visit(twin.states[0], np.array(at))
    bench.finish(at_least=10)


@cocotb.test()
async def a_uart_sends(dut):
    bench = Bench(dut)
    dut.rst.value = 1
    source = UartSource(dut.rx, baud=1e9 / (CLOCK_NS * bench.twin.divisor))
    source.log.setLevel("WARNING")
    cocotb.start_soon(Clock(dut.clk, CLOCK_NS, unit="ns").start(start_high=False))
    await ClockCycles(dut.clk, 3)
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    sent = bench.rng.permutation(256)[:64].tolist()
    source.write_nowait(sent)
    got = []
    for _ in range(12 * len(sent) * bench.twin.divisor):
        await FallingEdge(dut.clk)
        if int(dut.out_valid.value):
            got.append(int(dut.out_data.value))
            if len(got) == len(sent):
                break
    bench.compare("bytes", np.array(got), np.array(sent))
    bench.finish(at_least=64)

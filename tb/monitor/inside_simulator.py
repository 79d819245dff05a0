"""The simulated board from inside the simulator: converter, line to the computer and back.

Drives: ``miso`` as the part of the scene answers, each scan with a row of the recording; ``rx``
with the bytes that come from the computer. Gives on what ``tx`` sends. Checks nothing, and runs
until it is ended.
"""

from __future__ import annotations

import json
import os
import select
from typing import Any, Literal

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from golden.fixed import Codes
from golden.link.uart_transmitter import bits_of
from tb.sensing.spi_converter import RELEASED, SHEETS, Sheet

CONFIGURATION = "TACTUS_BOARD"
UNIT: Literal["ps"] = "ps"
# Bits of the line between two looks for what came from the computer.
PAUSE_BITS = 20
PAUSE_SECONDS = 1.0


class Rows:
    """Which row of the recording the sensors read."""

    def __init__(self, samples: list[list[int]], hold: int, orders: int) -> None:
        self.samples, self.hold, self.orders = np.array(samples), hold, orders
        self.scans, self.row, self.text = 0, -1, b""

    def next(self) -> Codes:
        """The samples of the next scan."""
        self.listen()
        row = self.scans // self.hold % len(self.samples) if self.row < 0 else self.row
        self.scans += 1
        samples: Codes = self.samples[row]
        return samples

    def listen(self) -> None:
        """Take orders where to stay; without somebody to give any, the simulation ends."""
        while select.select([self.orders], [], [], 0)[0]:
            text = os.read(self.orders, 4096)
            if not text:
                os._exit(0)
            *whole, self.text = (self.text + text).split(b"\n")
            self.row = int(whole[-1]) if whole else self.row


async def convert(dut: Any, sheet: Sheet, clocks: int, rows: Rows) -> None:
    """Answer each transfer as the part's sheet draws it; a scan begins with channel 0."""
    # What is sent hangs on the channel in its code alone.
    _, sent = sheet.diagram([1] * clocks)
    codes = np.array([])
    while True:
        dut.miso.value = RELEASED
        await FallingEdge(dut.cs_n)
        asked: list[int] = []
        code = -1
        for n in range(clocks):
            level = sent[n] if n < len(sent) else 0
            if isinstance(level, str):
                if code < 0:
                    channel, _ = sheet.diagram(asked)
                    codes = codes if channel else sheet.ideal(rows.next())
                    code = int(codes[channel])
                level = code >> int(level[1:]) & 1
            dut.miso.value = level
            await RisingEdge(dut.sclk)
            asked.append(int(dut.mosi.value))
            if n < clocks - 1:
                await FallingEdge(dut.sclk)
        await RisingEdge(dut.cs_n)


async def give(dut: Any, line: int, bit: int, rows: Rows) -> None:
    """Bytes of ``tx`` to the computer; the simulation waits where it does not read."""
    while True:
        await FallingEdge(dut.tx)
        await Timer(bit + bit // 2, UNIT)
        byte = 0
        for place in range(8):
            byte |= int(dut.tx.value) << place
            await Timer(bit, UNIT)
        if dut.tx.value == 1:
            while not select.select([], [line], [], PAUSE_SECONDS)[1]:
                rows.listen()
            os.write(line, bytes([byte]))


async def take(dut: Any, line: int, bit: int) -> None:
    """Bytes from the computer to ``rx``."""
    while True:
        await Timer(PAUSE_BITS * bit, UNIT)
        while select.select([line], [], [], 0)[0]:
            for byte in os.read(line, 4096):
                for level in bits_of(byte):
                    dut.rx.value = level
                    await Timer(bit, UNIT)


@cocotb.test()
async def board(dut: Any) -> None:
    """A board whose power is on."""
    given = json.loads(os.environ[CONFIGURATION])
    bit = given["bit_ps"]
    if given["reload"]:
        cocotb.start_soon(take(dut, given["line"], bit))
    rows = Rows(given["samples"], given["hold"], given["orders"])
    cocotb.start_soon(convert(dut, SHEETS[given["part"]], given["part_clocks"], rows))
    await give(dut, given["line"], bit, rows)

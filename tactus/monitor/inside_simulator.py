"""The simulated board from inside the simulator: its converter, and the line to the computer.

It drives ``miso`` as the scene's converter answers, with a row of the recording in each scan, and
``rx`` with the bytes that come from the computer. It passes on what ``tx`` sends. It checks nothing
and runs until it is ended.
"""

from __future__ import annotations

import json
import os
import select
from typing import Any, Literal

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from golden.link.uart import bits_of
from golden.numbers.fixed import Codes
from tb.sensing.spi_converter import RELEASED, SHEETS, Sheet

CONFIGURATION = "TACTUS_BOARD"
UNIT: Literal["ps"] = "ps"
# The time between two looks for bytes from the computer, in bits of the line.
PAUSE_BITS = 20
PAUSE_SECONDS = 1.0


class PlayedRows:
    """Chooses the row of the recording that the sensors read."""

    def __init__(self, samples: list[list[int]], hold: int, orders: int) -> None:
        self.samples, self.hold, self.orders = np.array(samples), hold, orders
        self.scans, self.row, self.text = 0, -1, b""

    def next(self) -> Codes:
        self.listen()
        row = self.scans // self.hold % len(self.samples) if self.row < 0 else self.row
        self.scans += 1
        return self.samples[row]

    def listen(self) -> None:
        """Take orders at which row to stay; when nobody can give any more, end the simulation."""
        while select.select([self.orders], [], [], 0)[0]:
            text = os.read(self.orders, 4096)
            if not text:
                os._exit(0)
            *whole, self.text = (self.text + text).split(b"\n")
            self.row = int(whole[-1]) if whole else self.row


async def convert(dut: Any, sheet: Sheet, clocks: int, rows: PlayedRows) -> None:
    """Answer each transfer as the data sheet of the part draws it; a scan begins with channel 0."""
    # The answers to all channels differ only in the code.
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


async def give(dut: Any, line: int, bit: int, rows: PlayedRows) -> None:
    """Send the bytes of ``tx`` to the computer; the simulation waits while it does not read."""
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
    """Send the bytes from the computer to ``rx``."""
    while True:
        await Timer(PAUSE_BITS * bit, UNIT)
        while select.select([line], [], [], 0)[0]:
            for byte in os.read(line, 4096):
                for level in bits_of(byte):
                    dut.rx.value = level
                    await Timer(bit, UNIT)


@cocotb.test()
async def board(dut: Any) -> None:
    given = json.loads(os.environ[CONFIGURATION])
    bit = given["bit_ps"]
    if given["hears"]:
        cocotb.start_soon(take(dut, given["line"], bit))
    rows = PlayedRows(given["samples"], given["hold"], given["orders"])
    cocotb.start_soon(convert(dut, SHEETS[given["part"]], given["part_clocks"], rows))
    await give(dut, given["line"], bit, rows)

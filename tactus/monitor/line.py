"""Opens what a user names with ``PORT=``: a serial port, or a board of twins.

The cable of a serial port may be cut and come back.
"""

from __future__ import annotations

import os
import termios
import time
from collections.abc import Iterator
from contextlib import suppress

import serial
from serial.tools import list_ports

from golden.input_error import InputError
from golden.link.decoder import Decoder, fault
from golden.link.packets import Frame
from tactus.monitor.board import Board
from tactus.monitor.twin_board import PAUSE, TWIN, TwinBoard
from tactus.scene.disturbance import Disturbance

# A board of twins plays each row for so many seconds.
TWIN_HOLD = 0.5
FAULTS = (OSError, ValueError, termios.error)


class SerialLine:
    """A serial port with 8 bits, no parity and one stop bit.

    label: The system's name of the port, such as ``/dev/ttyUSB0``.

    cut: Why the port is gone; empty while it is open.
    silence, patience: After ``silence`` seconds without a packet this is reported. After
        ``patience`` seconds a command that needs a packet gives up.
    """

    silence, patience = 2.0, 10.0

    def __init__(self, label: str, baud: int) -> None:
        self.label, self.baud = label, baud
        self.cut = ""
        self._port: serial.Serial | None = None
        try:
            self._port = self._opened()
        except FAULTS as error:
            raise InputError(f"PORT={self.label}: cannot be opened: {_reason(error)}") from None

    def __enter__(self) -> SerialLine:
        return self

    def __exit__(self, *error: object) -> None:
        self._close()

    def read(self) -> bytes:
        """The bytes that have come, after ``PAUSE`` at the latest; none while the port is gone."""
        if self._port is None:
            try:
                self._port, self.cut = self._opened(), ""
            except FAULTS:
                time.sleep(PAUSE)
                return b""
        try:
            first: bytes = self._port.read(1)
            return first + self._port.read(self._port.in_waiting) if first else b""
        except FAULTS as error:
            self._lost(error)
            return b""

    def drop(self) -> None:
        """Forget the bytes that have come but were not read."""
        try:
            if self._port is not None:
                self._port.reset_input_buffer()
        except FAULTS as error:
            self._lost(error)

    def write(self, data: bytes) -> None:
        """Send bytes, and wait until they have left."""
        try:
            if self._port is not None:
                self._port.write(data)
                self._port.flush()
                return
        except FAULTS as error:
            self._lost(error)
        raise InputError(f"PORT={self.label}: the line was cut: {self.cut}")

    def _opened(self) -> serial.Serial:
        # Two programs that read one port would each get a part of the bytes.
        return serial.Serial(self.label, self.baud, timeout=PAUSE, exclusive=True)

    def _lost(self, error: Exception) -> None:
        self.cut = _reason(error)
        self._close()

    def _close(self) -> None:
        port, self._port = self._port, None
        if port is not None:
            # The device may be gone.
            with suppress(*FAULTS):
                port.close()


def ports_there() -> str:
    """The serial ports of this machine, for a message."""
    found = [f"{port.device} ({port.description})" for port in sorted(list_ports.comports())]
    return ", ".join(found) or "no serial port"


def _reason(error: Exception) -> str:
    """The reason in words that help a user."""
    # An error of termios has its number only among its arguments.
    number = getattr(error, "errno", None) or next(iter(error.args), None)
    number = number if isinstance(number, int) else None
    text = str(error)
    if number == 2 or "No such file" in text:
        return f"no such port; there is {ports_there()}, and PORT=twin without a board"
    if number == 13:
        return "permission denied; on Debian: sudo adduser $USER dialout, then log in anew"
    if "exclusively lock" in text:
        return "another program has it open"
    gone = "returned no data", "Bad file descriptor", "Input/output error"
    if number == 5 or any(words in text for words in gone):
        return "the device is gone"
    return os.strerror(number) if number else text or type(error).__name__


Line = SerialLine | TwinBoard


def open_line(
    port: str, baud: int | None, board: Board, drift: Disturbance | None = None, seed: int = 1
) -> Line:
    """The line to a board, with the baud rate of its scene if no other is given.

    drift, seed: How far the sensors of a simulated board have drifted; see ``TwinBoard``.
    """
    if not port:
        raise InputError(
            f"PORT=: missing, expected {TWIN} or a serial port; there is {ports_there()}"
        )
    if port == TWIN:
        rate = float(board.instrument.packets_a_second)
        hold = max(1, round(TWIN_HOLD * rate))
        return TwinBoard(board.hardware, rate, hold, drift, seed)
    return SerialLine(port, baud or board.baud)


def frames_from(line: Line, board: Board) -> Iterator[Frame]:
    """The frames that come from now on, as long as some come."""
    line.drop()
    decoder = Decoder(board.layout)
    last = time.monotonic()
    while time.monotonic() - last < line.patience:
        for frame in decoder.feed(line.read()):
            last = time.monotonic()
            yield frame
        if line.cut:
            raise InputError(f"PORT={line.label}: the line was cut: {line.cut}")
    faults = "; ".join(filter(None, (fault(*one) for one in decoder.tally.items())))
    raise InputError(
        f"PORT={line.label}: no packet for {line.patience:g} s: "
        + (faults or "is the bitstream loaded, and are TX and RX crossed?")
    )

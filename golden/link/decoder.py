"""Turns the bytes of a serial line into frames, and counts what is wrong with other bytes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace

from golden.link.packets import (
    CHECK_BYTES,
    FRAME,
    FRAME_HEADER,
    MOST_PAYLOAD,
    SYNC,
    VERSION,
    Frame,
    FrameLayout,
    check_of,
    kind_byte,
)

# The most bytes that are held back until it is known what they are.
MOST_WAITING = FRAME_HEADER + MOST_PAYLOAD + CHECK_BYTES
_NUMBERS = 256
_KIND = 0x0F
# A packet of another kind that is seen only once may be noise that happens to pass the check.
_SURE = 2


@dataclass
class Tally:
    """Counts of what came over a line.

    frames: Packets of this layout whose check is right.
    skipped: Bytes that belong to no packet. The bytes at the start of a line are not counted,
        because they may be the end of a packet that began before the line was opened.
    failed: Packets whose check failed. Their bytes are also counted as skipped.
    missed: Packets that are missing according to the numbers of the others. A gap of 256 is not
        noticed.
    others: Sound packets of another version or length, by (version, bytes of the payload).
    """

    frames: int = 0
    skipped: int = 0
    failed: int = 0
    missed: int = 0
    others: Counter[tuple[int, int]] = field(default_factory=Counter)

    def copy(self) -> Tally:
        return replace(self, others=self.others.copy())

    def faults(self, before: Tally, layout: FrameLayout) -> dict[str, str]:
        """A line for each kind of fault that has occurred since the counts ``before``."""
        found = {}
        if count := self.skipped - before.skipped:
            found["skipped"] = (
                f"{count} bytes are part of no packet: garbage on the line, or another baud rate"
            )
        if count := self.failed - before.failed:
            found["failed"] = f"{count} packets are damaged: their check fails"
        if count := self.missed - before.missed:
            found["missed"] = f"{count} packets are missing: the numbers jump"
        for (version, length), total in self.others.items():
            if total < _SURE or total == before.others[version, length]:
                continue
            if version != VERSION:
                found[f"version {version}"] = (
                    f"packets are of version {version} of the protocol, expected {VERSION}: the "
                    "board and tactus are of different versions"
                )
            else:
                found[f"length {length}"] = (
                    f"packets have a payload of {length} bytes, expected {layout.payload_bytes}: "
                    "the board runs the hardware of another scene"
                )
        return found


class Decoder:
    """Finds an instrument's packets in the bytes of a serial line, which may hold other bytes too.

    A packet begins wherever SYNC is followed by the kind byte of a frame. If its check fails, only
    this SYNC is skipped, and the search continues at the next byte. So no whole packet behind
    garbage is lost, unless noise passes for a packet: this happens to one in 65536 places that
    begin like a packet, and it can hide all packets that begin within ``MOST_WAITING`` bytes. Bytes
    that begin like a packet hold back the packets behind them until all their bytes have come, at
    most ``MOST_WAITING``.
    """

    def __init__(self, layout: FrameLayout) -> None:
        self.layout = layout
        self.tally = Tally()
        self._kept = bytearray()
        self._number: int | None = None
        # Whoever opens a line first hears the end of a packet, which is no fault.
        self._joining = layout.packet_bytes - 1

    def feed(self, data: bytes) -> list[Frame]:
        """The frames that are completed by ``data``, in their order."""
        kept, tally = self._kept, self.tally
        kept += data
        frames: list[Frame] = []
        at = 0
        while True:
            start = kept.find(SYNC, at)
            self._skip((start if start >= 0 else len(kept)) - at)
            at = start if start >= 0 else len(kept)
            if len(kept) - at < FRAME_HEADER:
                break
            kind, length, number = kept[at + 1 : at + FRAME_HEADER]
            end = at + FRAME_HEADER + length + CHECK_BYTES
            if kind & _KIND != FRAME:
                end = at + 1
                self._skip(1)
            elif len(kept) < end:
                break
            # The check over bytes and their own check is 0.
            elif check_of(bytes(kept[at + 1 : end])):
                tally.failed += self._own(kind, length)
                self._skip(1)
                end = at + 1
            elif self._own(kind, length):
                payload = bytes(kept[at + FRAME_HEADER : end - CHECK_BYTES])
                frames.append(self.layout.from_payload(number, payload))
                self._count(number)
            else:
                tally.others[kind >> 4, length] += 1
            at = end
        del kept[:at]
        return frames

    def restart(self) -> None:
        """Start anew after the line was cut: drop half a packet, and allow any number next."""
        self._skip(len(self._kept))
        self._kept.clear()
        self._number = None
        self._joining = self.layout.packet_bytes - 1

    def _own(self, kind: int, length: int) -> bool:
        return kind == kind_byte(FRAME) and length == self.layout.payload_bytes

    def _count(self, number: int) -> None:
        tally = self.tally
        tally.frames += 1
        if self._number is not None:
            tally.missed += (number - self._number - 1) % _NUMBERS
        self._number, self._joining = number, 0

    def _skip(self, count: int) -> None:
        unheard = min(count, self._joining)
        self._joining -= unheard
        self.tally.skipped += count - unheard

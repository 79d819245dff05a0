"""Bytes of a serial line become frames, and what was wrong with the others is counted."""

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

# Bytes that are kept back at most, until it is known what they are.
MOST_WAITING = FRAME_HEADER + MOST_PAYLOAD + CHECK_BYTES
_NUMBERS = 256
_KIND = 0x0F
# A packet of another kind that is seen once may be noise that happens to pass the check.
_SURE = 2


@dataclass
class Tally:
    """What came over a line.

    Attributes
    ----------
    frames : int
    skipped : int
        Bytes that are part of no packet, without those that may be the end of one that began
        before anybody listened.
    failed : int
        Packets whose check failed; their bytes are among those that were skipped.
    missed : int
        By how many the numbers of packets jumped; of a gap of 256 nothing is seen.
    others : Counter
        Sound packets of another version or length, by (version, bytes of the payload).
    """

    frames: int = 0
    skipped: int = 0
    failed: int = 0
    missed: int = 0
    others: Counter[tuple[int, int]] = field(default_factory=Counter)

    def copy(self) -> Tally:
        return replace(self, others=self.others.copy())

    def faults(self, before: Tally, layout: FrameLayout) -> dict[str, str]:
        """A line for each kind of fault that there are more of than ``before``."""
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
                    f"packets are of version {version} of the protocol, expected {VERSION}: board "
                    "and tactus are not of one age"
                )
            else:
                found[f"length {length}"] = (
                    f"packets have a payload of {length} bytes, expected {layout.payload_bytes}: "
                    "the board runs the hardware of another scene"
                )
        return found


class Decoder:
    """Finds the packets of an instrument in what a serial line brings, whatever is between them.

    A packet begins wherever a SYNC is followed by the kind of a frame. Where its check fails only
    that SYNC is skipped, and the search goes on at the next byte: so no whole packet behind garbage
    is lost, unless noise passes for a packet, one in 65536 of those that begin like one; such a one
    may hide as many packets as begin in ``MOST_WAITING`` bytes. What begins like a packet keeps
    those behind it waiting until its bytes are there, ``MOST_WAITING`` at most.

    Parameters
    ----------
    layout : FrameLayout

    Attributes
    ----------
    tally : Tally
    """

    def __init__(self, layout: FrameLayout) -> None:
        self.layout = layout
        self.tally = Tally()
        self._kept = bytearray()
        self._number: int | None = None
        # Who begins to listen hears the end of a packet first: that is no fault.
        self._joining = layout.packet_bytes - 1

    def feed(self, data: bytes) -> list[Frame]:
        """The frames that end in ``data``, in their order."""
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
            elif not _sound(kept, at, end):
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
        """The line was cut: what was half read is dropped, and any number may come next."""
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


def _sound(kept: bytearray, at: int, end: int) -> bool:
    check = int.from_bytes(kept[end - CHECK_BYTES : end], "big")
    return check_of(bytes(kept[at + 1 : end - CHECK_BYTES])) == check

"""Turns the bytes of a serial line into frames, and counts what is wrong with other bytes."""

from collections import Counter

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


# What can be wrong with the bytes of a line. Those at its start are not counted as skipped, because
# they may be the end of a packet that began before the line was opened; those of a packet that
# failed are. A gap of 256 packets is not noticed.
FAULTS = {
    "skipped": "{} bytes are part of no packet: garbage on the line, or another baud rate",
    "failed": "{} packets are damaged: their check fails",
    "missed": "{} packets are missing: the numbers jump",
}
FRAMES = "frames"


def fault(kind: str, count: int, before: int = 0) -> str:
    """The text for a count of ``Decoder.tally`` that was told at ``before``; empty for no fault."""
    if kind == FRAMES or count == before:
        return ""
    return FAULTS[kind].format(count - before) if kind in FAULTS else kind * (count >= _SURE)


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
        self.tally: Counter[str] = Counter()
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
                tally["failed"] += self._own(kind, length)
                self._skip(1)
                end = at + 1
            elif self._own(kind, length):
                payload = bytes(kept[at + FRAME_HEADER : end - CHECK_BYTES])
                frames.append(self.layout.from_payload(number, payload))
                self._count(number)
            else:
                tally[self._other(kind >> 4, length)] += 1
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

    def _other(self, version: int, length: int) -> str:
        if version != VERSION:
            return (
                f"packets are of version {version} of the protocol, expected {VERSION}: the board "
                "and tactus are of different versions"
            )
        return (
            f"packets have a payload of {length} bytes, expected {self.layout.payload_bytes}: the "
            "board runs the hardware of another scene"
        )

    def _count(self, number: int) -> None:
        tally = self.tally
        tally[FRAMES] += 1
        if self._number is not None:
            tally["missed"] += (number - self._number - 1) % _NUMBERS
        self._number, self._joining = number, 0

    def _skip(self, count: int) -> None:
        unheard = min(count, self._joining)
        self._joining -= unheard
        self.tally["skipped"] += count - unheard

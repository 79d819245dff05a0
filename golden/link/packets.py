"""The packets on an instrument's serial line: frames to a computer, images and lessons to a board.

docs/streams.md says what a packet of each kind holds, byte by byte. An image has a check of its own
(``golden.engine.image``). The codes of a lesson that are more than it needs have no effect.
"""

from binascii import crc_hqx
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from struct import Struct, pack

from golden.input_error import InputError

SYNC = 0xA5
VERSION = 1
FRAME, IMAGE, LESSON = 1, 2, 3
CHECK_PRESET = 0xFFFF
CHECK_BYTES = 2
CODE_BYTES = 2
COUNT_BYTES = 2
# The bits of the byte of flags. STATES are as they are when the packet begins; the others say what
# has happened since the packet before.
FLAGS = (
    "converter_error",
    "frame_error",
    "image_error",
    "line_error",
    "lesson_error",
    "learn_error",
    "learning",
)
STATES = ("converter_error", "learning")
# The bits of the first byte of a lesson: whether the board learns from now on; whether the codes
# are the known outputs of the next frame; whether they are the theta that is used behind that one.
LESSON_BITS = ("learn", "known", "theta")
FRAME_HEADER = 4
MOST_PAYLOAD = 255
MOST_IMAGE = (1 << 16) - 1


def kind_byte(kind: int) -> int:
    return VERSION << 4 | kind


def check_of(data: bytes) -> int:
    return crc_hqx(data, CHECK_PRESET)


@dataclass(frozen=True)
class Frame:
    """The contents of one packet.

    number: Number of the packet, modulo 256.
    flags: The FLAGS that are set.
    count: Number of frames that the network has computed, modulo 65536.
    samples, outputs: The values as codes.
    point: Number, i_p and f(i_p) of a point of the profile.
    winner: Index and margin of the largest output.
    theta: Number and code of an element of theta.
    """

    number: int
    flags: tuple[str, ...]
    count: int
    samples: tuple[int, ...]
    outputs: tuple[int, ...]
    point: tuple[int, ...] | None = None
    winner: tuple[int, ...] | None = None
    theta: tuple[int, ...] | None = None


@dataclass(frozen=True)
class FrameLayout:
    """The positions of all values in the packets of an instrument.

    drawn: Whether the instrument draws a profile.
    decides: Whether it looks for the largest output.
    learns: Whether its network learns.
    """

    inputs: int
    outputs: int
    drawn: bool = False
    decides: bool = False
    learns: bool = False

    def __post_init__(self) -> None:
        if self.payload_bytes > MOST_PAYLOAD:
            raise InputError(
                f"uart: got {self.inputs} samples and {self.outputs} outputs, a payload of "
                f"{self.payload_bytes} bytes, expected {MOST_PAYLOAD} at most"
            )

    @property
    def _payload(self) -> Struct:
        """Flags, count and codes; index and margin; number and element; number and point."""
        parts = "BH" * self.decides + "Bh" * self.learns + "Bhh" * self.drawn
        return Struct(f">BH{self.inputs + self.outputs}h{parts}")

    @property
    def payload_bytes(self) -> int:
        return self._payload.size

    @property
    def packet_bytes(self) -> int:
        return FRAME_HEADER + self.payload_bytes + CHECK_BYTES

    def to_bytes(self, frame: Frame) -> bytes:
        """The bytes of a packet, as they are sent."""
        flags = sum(1 << FLAGS.index(name) for name in frame.flags)
        told = ((self.decides, frame.winner), (self.learns, frame.theta), (self.drawn, frame.point))
        parts = [value for on, part in told if on for value in part or ()]
        payload = self._payload.pack(flags, frame.count, *frame.samples, *frame.outputs, *parts)
        return _checked(bytes([kind_byte(FRAME), len(payload), frame.number]) + payload)

    def from_payload(self, number: int, payload: bytes) -> Frame:
        """The frame in a payload, which must have ``payload_bytes`` bytes."""
        bits, count, *values = self._payload.unpack(payload)
        flags = tuple(name for bit, name in enumerate(FLAGS) if bits >> bit & 1)
        counts = self.inputs, self.outputs, 2 * self.decides, 2 * self.learns, 3 * self.drawn
        rest = iter(values)
        samples, outputs, *told = (tuple(islice(rest, count)) for count in counts)
        winner, theta, point = (part or None for part in told)
        return Frame(number, flags, count, samples, outputs, point, winner, theta)


def image_packet(image: bytes) -> bytes:
    """A packet that loads an image."""
    if not 1 <= len(image) <= MOST_IMAGE:
        raise InputError(f"image: got {len(image)} bytes, expected 1 to {MOST_IMAGE}")
    return bytes([SYNC, kind_byte(IMAGE)]) + len(image).to_bytes(2, "big") + image


def lesson_packet(codes: int, learn: bool, given: Sequence[int] = (), what: str = "known") -> bytes:
    """A packet that says whether a board learns, and may say what the outputs should be.

    codes: How many codes a lesson has for the board.
    given: The codes of the known outputs of the next frame, or of theta; none if nothing is given.
    what: "known" or "theta".
    """
    bits = learn << LESSON_BITS.index("learn") | bool(given) << LESSON_BITS.index(what)
    payload = pack(f">B{codes}h", bits, *given, *(0,) * (codes - len(given)))
    return _checked(bytes([kind_byte(LESSON), len(payload)]) + payload)


def _checked(body: bytes) -> bytes:
    return bytes([SYNC]) + body + check_of(body).to_bytes(CHECK_BYTES, "big")

"""UART instrument: a converter instrument with a serial line to a computer."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, input_port, output_port
from golden.instruments.converter_instrument import ConverterInstrument
from golden.link.image_receiver import ImageReceiver
from golden.link.lesson_receiver import LessonReceiver
from golden.link.packet_sender import InTurn, PacketSender
from golden.link.packets import image_packet
from golden.link.uart import BYTE_BITS, UartReceiver, UartTransmitter
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class PulseDensity(Block):
    """A digital-to-analogue converter of one bit and of the first order (ours).

    Behind a low pass on the board, made of a resistor and a capacitor, code c becomes (c - low) /
    2**width of the voltage of the bit. The sum of all requested values minus the ones that were
    given stays below 2**width. So in any 2**width clocks with the same code there are exactly as
    many ones as the code requests, and in any other interval at most one more or one fewer.

    fmt: Format of the codes.
    """

    block = "pulse_density"
    part_of = "uart_instrument"
    area = "visualisation"
    latency = 1
    fmt: Fix

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_data", "the code, in every clock", self.fmt),
            output_port("out_bit", "the bit; from a register"),
        )

    def process(self, in_data: ArrayLike, reset: ArrayLike) -> Codes:
        """``out_bit`` in each clock; all arrays have one element for each clock."""
        asked = self.fmt.check(in_data, f"{self.entity} in_data") - self.fmt.low
        bits = np.zeros(len(asked), dtype=np.int64)
        total = bit = 0
        for t, (code, cleared) in enumerate(
            zip(asked.tolist(), np.asarray(reset).tolist(), strict=True)
        ):
            bits[t] = bit
            bit, total = (0, 0) if cleared else divmod(total + code, 1 << self.fmt.width)
        return bits


# How long the line must be idle before a packet counts as cut off, in bytes.
IDLE_BYTES = 20


@dataclass(frozen=True)
class UartInstrument(ConverterInstrument):
    """``ConverterInstrument`` that sends its frames to a computer, and listens to it (ours).

    The computer sends images to an engine that can be loaded, and lessons to one that learns.

    divisor: Number of clocks of a bit on the line.
    analogue: Whether the profile leaves as two bits of pulse density. One point of each profile is
        given, and the next point with the next profile, so that a point lasts as long as a low pass
        needs to follow.
    """

    block = "uart_instrument"
    divisor: int = field(kw_only=True)
    analogue: bool = field(kw_only=True, default=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        left = self.converter_reader.scan_clocks - self.converter_reader.slots
        last = self.readout.output_clocks[-1]
        self.require(
            last <= left,
            f"a scan of {self.interval} clocks",
            f"{last + self.converter_reader.slots} or more: outputs leave before the next samples "
            "come",
        )
        drawn = self.readout.load_profile is not None
        self.require(drawn or not self.analogue, "analogue without a profile", "one")
        core = self.core
        if isinstance(core, LearningEngine):
            free = left - self.readout.busy
            self.require(
                free >= core.longest_equation,
                f"a scan that leaves {free} clocks in one piece",
                f"{core.longest_equation} or more, which an equation takes",
            )
        _ = self.parts()

    @property
    def learns(self) -> bool:
        return bool(self.readout.network.lesson_ports)

    @property
    def elements(self) -> int:
        """How many elements of theta the engine inside learns."""
        core = self.core
        return core.program.places.unknowns if isinstance(core, LearningEngine) else 0

    @property
    def hears(self) -> bool:
        return self.reload or self.learns

    @property
    def reload(self) -> bool:
        return bool(self.readout.image)

    @property
    def image(self) -> bytes:
        """The bytes of the image as they are sent over the line."""
        return image_packet(self.readout.image) if self.reload else b""

    @property
    def ports(self) -> tuple[Port, ...]:
        own = super().ports
        dac = ("x", "i_p"), ("y", "f(i_p)")
        what = "lessons" if self.learns else "images"
        return (
            *own[:6],
            *(
                [input_port("rx", f"from the computer: {what}; comes at any time")]
                if self.hears
                else []
            ),
            output_port("tx", "to the computer: packets; from a register"),
            *(
                output_port(f"dac_{axis}", f"the density of its ones is {name}; from a register")
                for axis, name in dac
                if self.analogue
            ),
            *own[6:],
        )

    @property
    def packet_sender(self) -> PacketSender:
        profile = self.readout.load_profile
        return PacketSender(
            self.inputs,
            self.outputs,
            profile.ramp.points if profile else 0,
            self.reload,
            self.interval,
            self.readout.decides,
            self.elements,
        )

    @property
    def uart_transmitter(self) -> UartTransmitter:
        return UartTransmitter(self.divisor)

    @property
    def uart_receiver(self) -> UartReceiver:
        return UartReceiver(self.divisor)

    @property
    def image_receiver(self) -> ImageReceiver:
        """It has room for all bytes that come while the longest program in the memory runs."""
        engine = self.core
        if not isinstance(engine, Engine) or not engine.loaded:
            raise NotImplementedError(f"{self.entity}: {engine.entity} takes no images")
        waits = 1 << engine.loaded.sizes.program_addr_width
        return ImageReceiver(self.idle_clocks, waits // self.uart_receiver.interval + 2)

    @property
    def lesson_receiver(self) -> LessonReceiver:
        return LessonReceiver(self.outputs, self.elements, self.idle_clocks)

    @property
    def idle_clocks(self) -> int:
        """Clocks without a byte after which a packet counts as cut off."""
        return IDLE_BYTES * BYTE_BITS * self.divisor

    @property
    def pulse_density(self) -> PulseDensity:
        return PulseDensity(SIGNAL)

    def dac(self, profile: Mapping[str, ArrayLike], reset: ArrayLike) -> tuple[Codes, Codes]:
        """``dac_x`` and ``dac_y`` in each clock.

        profile: The columns of the ports ``profile_*``, by name.
        """
        names = ("profile_valid", "profile_x", "profile_y", "profile_last")
        columns = [np.asarray(profile[name]).tolist() for name in names]
        shown = np.zeros((2, len(columns[0])), dtype=np.int64)
        point, ended = InTurn(self.packet_sender.points, codes=2), False
        for t, (valid, x, y, last, clears) in enumerate(
            zip(*columns, np.asarray(reset).tolist(), strict=True)
        ):
            shown[:, t] = point.item[1:]
            point.step(ended, valid, (x, y), valid and last)
            ended = bool(last)
            if clears:
                point, ended = InTurn(self.packet_sender.points, codes=2), False
        given_x, given_y = (self.pulse_density.process(codes, reset) for codes in shown)
        return given_x, given_y

    @property
    def packet_scans(self) -> int:
        """Scans from one packet to the next, if each scan yields a frame."""
        # The line is free when all bytes of a packet have left it.
        clocks = self.packet_sender.layout.packet_bytes * self.uart_transmitter.interval + 1
        return -(-clocks // self.interval)

    @property
    def packets_a_second(self) -> Fraction:
        """Packets per second, if each scan yields a frame, at the scene's clock."""
        return self.converter_reader.clock * 1_000_000 / (self.packet_scans * self.interval)

    def parts(self) -> tuple[Block, ...]:
        return (
            *super().parts(),
            self.packet_sender,
            self.uart_transmitter,
            *((self.uart_receiver,) if self.hears else ()),
            *((self.image_receiver,) if self.reload else ()),
            *((self.lesson_receiver,) if self.learns else ()),
            *((self.pulse_density,) if self.analogue else ()),
        )

    def facts(self) -> tuple[str, ...]:
        baud = self.converter_reader.clock * 1_000_000 / self.divisor
        return (
            f"{float(baud):.6g} bits a second on the line, {self.divisor} clocks each",
            f"{float(self.packets_a_second):.6g} packets a second, one every "
            f"{self.packet_scans} scan{'s' * (self.packet_scans > 1)}",
        )

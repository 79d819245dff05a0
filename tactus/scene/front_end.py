"""The sections ``[front_end]``, ``[uart]`` and ``[visualisation]``: what is around the networks."""

from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from golden.link.uart import LEAST_DIVISOR
from golden.networks.network import Network
from golden.numbers.precision import SIGNAL
from golden.sensing.converter_parts import PARTS
from golden.sensing.converter_reader import ConverterReader
from golden.sensing.scan_sequencer import MOST_SCAN_CLOCKS, ScanSequencer
from golden.trained.window import Window
from golden.visualisation.load_profile import LoadProfile, load_profile
from tactus.core.finding import Finding, fault, refuse
from tactus.scene.scale import AUTO


@dataclass(frozen=True)
class FrontEnd:
    """The front end that a scene describes: its keys, and the clock."""

    counter_width: int
    sample_at: float
    rate_hz: float
    converter: str
    reference: float
    clock_mhz: float

    @property
    def scan_clocks(self) -> int:
        """Clocks from one scan to the next, as close to ``rate_hz`` as whole clocks allow."""
        if not self.rate_hz:
            return 1 << self.counter_width
        return round(_hertz(self.clock_mhz) / _exact(self.rate_hz))

    def describe(self) -> str:
        """A text with the scans per second, and their deviation from the requested rate."""
        rate = _hertz(self.clock_mhz) / self.scan_clocks
        clock = f"{self.clock_mhz:g} MHz"
        text = f"a scan every {self.scan_clocks} clocks, {float(rate):.9g} Hz at {clock}"
        if not self.rate_hz:
            return text
        deviation = rate / _exact(self.rate_hz) - 1
        if not deviation:
            return f"{text}, exactly as asked"
        side = "above" if deviation > 0 else "below"
        return (
            f"{text}, {float(abs(deviation)) * 1e6:.3g} ppm {side} the {self.rate_hz:g} Hz "
            "that are asked for"
        )

    def scan_sequencer(self, network: Network) -> ScanSequencer:
        """The sequencer that makes frames for ``network``."""
        return self._sequencer(network.inputs, network.input_controller.inputs)

    def converter_reader(self, network: Network) -> ConverterReader:
        """The reader that makes frames for ``network`` from the codes of ``converter``."""
        return ConverterReader(
            SIGNAL,
            PARTS[self.converter],
            network.inputs,
            network.input_controller.inputs,
            self.counter_width,
            self.clock_mhz,
            self.scan_clocks - (1 << self.counter_width),
        )

    def clocks_left(self, window: Window) -> int:
        """Clocks from a frame's last sample to the next, which a network without slots may use.

        With a past, a frame window sends the samples, and those of a converter are sent when the
        scan is complete. In both cases they come one per clock.
        """
        if not window.plain:
            return self.scan_clocks - len(window.taps)
        inputs = len(window.delays)
        if self.converter:
            return self.scan_clocks - inputs
        scan = self._sequencer(inputs, inputs)
        samples = scan.sample_clocks
        return scan.scan_clocks - int(samples[-1]) + int(samples[0]) - 1

    def _sequencer(self, inputs: int, slots: int) -> ScanSequencer:
        whole = 1 << self.counter_width
        slot_clocks = whole >> max(1, (slots - 1).bit_length())
        return ScanSequencer(
            SIGNAL,
            inputs,
            slots,
            self.counter_width,
            int(self.sample_at * slot_clocks),
            self.scan_clocks - whole,
        )


def front_end(scene: dict[str, Any], path: Path) -> FrontEnd | None:
    if "front_end" not in scene:
        return None
    values, clock_mhz = scene["front_end"], scene["hardware"]["clock_mhz"]
    found = FrontEnd(**values, clock_mhz=clock_mhz)
    shortest = 1 << found.counter_width
    low, high = (_hertz(clock_mhz) / clocks for clocks in (MOST_SCAN_CLOCKS, shortest))
    if found.rate_hz and not low <= found.rate_hz <= high:
        ends = f"{_six_digits(low, ROUND_CEILING)} to {_six_digits(high, ROUND_FLOOR)}"
        raise InputError(
            f"{path}: front_end.rate_hz: got {found.rate_hz:g}, expected {ends}, with a scan of "
            f"{shortest} clocks (counter_width {found.counter_width}) of {clock_mhz:g} MHz; or 0"
        )
    return found


def _exact(value: float) -> Fraction:
    """The number exactly as it was written, and not the nearest floating-point number."""
    return Fraction(str(value))


def _hertz(clock_mhz: float) -> Fraction:
    return _exact(clock_mhz) * 1_000_000


def _six_digits(rate: Fraction, rounding: str) -> str:
    """Six digits, rounded so that every rate that a message allows is really allowed."""
    return f"{Context(6, rounding).divide(Decimal(rate.numerator), Decimal(rate.denominator)):f}"


# What the UART of a computer tolerates, including the deviation of its own clock.
TOLERANCE = Fraction(2, 100)


@dataclass(frozen=True)
class Uart:
    """The serial line that a scene describes.

    baud: Requested bits per second.
    divisor: Clocks per bit.
    """

    baud: int
    divisor: int


def uart(values: dict[str, Any], path: Path) -> Uart | None:
    if "uart" not in values:
        return None
    baud, clock_mhz = values["uart"]["baud"], values["hardware"]["clock_mhz"]
    clock = _hertz(clock_mhz)
    most = clock / LEAST_DIVISOR
    if not 1 <= baud <= most:
        raise InputError(
            f"{path}: uart.baud: got {baud}, expected 1 to {int(most)}, a bit of {LEAST_DIVISOR} "
            f"clocks of {clock_mhz:g} MHz"
        )
    divisor = round(clock / baud)
    rate = clock / divisor
    if abs(rate / baud - 1) > TOLERANCE:
        raise InputError(
            f"{path}: uart.baud: got {baud}, expected within 2 % of {clock_mhz:g} MHz divided "
            f"by a whole number, such as {float(rate):.6g}"
        )
    return Uart(baud, divisor)


RESULTS = ("load", "position", "width", "shape")


@dataclass(frozen=True)
class Visualisation:
    """The profile that a scene describes.

    results: Indices of the scene's outputs that are load, position, width and shape.
    analogue: The form in which it also leaves for an oscilloscope; empty for none.
    """

    load_profile: LoadProfile
    results: tuple[int, int, int, int]
    analogue: str = ""


def visualisation(scene: dict[str, Any], path: Path) -> Visualisation | None:
    """The profile, if the scene has that section. Lengths of position and width determine C."""
    if "visualisation" not in scene:
        return None
    values, data = scene["visualisation"], scene["data"]
    outputs = data["outputs"]
    scaled = outputs if data["scale"] == AUTO else data["scale"]
    names = [values[key] for key in RESULTS]
    found: list[Finding] = []
    for key, name in zip(RESULTS, names, strict=True):
        place = f"{path}: visualisation.{key}: got {name!r}"
        if name not in outputs:
            known = f"{', '.join(outputs)}{suggest(name, outputs)}"
            found.append(fault(f"{place}, expected one of the outputs {known}"))
        elif name in scaled:
            text = "which has a data.scale, expected an output that has none: the profile is drawn"
            found.append(fault(f"{place}, {text} from signals"))
        elif (first := RESULTS[names.index(name)]) != key:
            text = f"which is visualisation.{first} too, expected four different outputs"
            found.append(fault(f"{place}, {text}"))
    units = []
    for key in ("position", "width"):
        name = values[key]
        if name in data["length_mm"]:
            length, scale = (Fraction(str(data[k][name])) for k in ("length_mm", "full_scale"))
            units.append(length / scale)
        elif name in outputs:
            text = f"expected the length of the output that is the {key} of the visualisation"
            found.append(fault(f"{path}: data.length_mm: {name!r} is missing, {text}"))
    refuse(found)
    drawn = {key: values[key] for key in ("start", "stop", "step", "shape_threshold")}
    try:
        profile = load_profile(gain=2 * units[0] / units[1], **drawn)
    except InputError as error:
        raise InputError(f"{path}: visualisation: {error}") from None
    first, second, third, fourth = (outputs.index(name) for name in names)
    return Visualisation(profile, (first, second, third, fourth), values["analogue"])

"""Instrument: everything from a converter and an analogue multiplexer to the results."""

from dataclasses import dataclass, field

from golden.common.block import Block
from golden.common.flow import Flow, Wire
from golden.common.port import CLOCKED, Port
from golden.instruments.readout import Readout
from golden.layers.argmax import Argmax
from golden.networks.network import Around, Network
from golden.numbers.precision import SIGNAL
from golden.sensing.converter_reader import ConverterReader
from golden.sensing.scan_sequencer import ScanSequencer


@dataclass(frozen=True)
class Scanned(Around):
    """A network whose frames are scans; it computes what the network inside computes."""

    area = "instruments"
    readout: Readout = field(kw_only=True)

    def check_scan(self, scan: ScanSequencer | ConverterReader, left: int) -> None:
        """Refuse scans that follow each other faster than the network accepts frames.

        left: Clocks from the last sample of one scan to the first of the next.
        """
        got, taken = (scan.inputs, scan.slots), (self.inputs, self.readout.input_controller.inputs)
        self.require(got == taken, f"a scan of (inputs, slots) {got}", str(taken))
        width, scan_clocks = scan.counter_width, scan.scan_clocks
        self.require(
            scan_clocks >= self.readout.interval,
            f"counter_width={width}, a scan of {scan_clocks} clocks",
            f"{self.readout.interval} or more, which the network needs",
        )
        self.require(
            left >= self.readout.busy,
            f"counter_width={width}, a scan that leaves {left} clocks between two frames",
            f"{self.readout.busy} or more, in which the network computes",
        )

    @property
    def inside(self) -> Network:
        return self.readout

    @property
    def scan(self) -> ScanSequencer | ConverterReader:
        """The part that makes frames of scans."""
        raise NotImplementedError

    @property
    def burst(self) -> int:
        """Clocks from the last code of a scan to the last sample of its frame."""
        return self.scan.latency

    @property
    def interval(self) -> int:
        return self.scan.scan_clocks

    @property
    def output_clocks(self) -> tuple[int, ...]:
        """They are counted from the last code of a scan."""
        return tuple(self.burst + c for c in self.readout.output_clocks)

    def parts(self) -> tuple[Block, ...]:
        return (self.scan, self.readout)

    @property
    def shown_ports(self) -> tuple[Port, ...]:
        """The ports that show results; frames of the wrong length cannot occur."""
        network = self.readout.network
        inner = (*network.load_ports, *network.lesson_ports)
        hidden = {"frame_error", *(port.name for port in inner)}
        results = [port for port in self.readout.ports if port.direction == "out"]
        return tuple(port for port in results if port.name not in hidden)

    @property
    def image(self) -> bytes:
        return self.readout.image

    @property
    def argmax(self) -> Argmax | None:
        return self.readout.argmax


@dataclass(frozen=True)
class Instrument(Scanned):
    """Reads the sensors in turn, with network and readout (thesis Figures 5.5, 5.12 and 5.25).

    It computes what the network inside computes, with one frame per scan.
    """

    block = "instrument"
    section = "5.4.4, 5.5, 5.8"
    stream = "converter"
    scan_sequencer: ScanSequencer

    def __post_init__(self) -> None:
        scan = self.scan_sequencer
        samples = scan.sample_clocks
        self.check_scan(scan, scan.scan_clocks - int(samples[-1]) + int(samples[0]) - 1)

    @property
    def ports(self) -> tuple[Port, ...]:
        scan = {port.name: port for port in self.scan_sequencer.ports}
        return (*CLOCKED, scan["adc"], scan["address"], *self.shown_ports)

    @property
    def unreachable(self) -> dict[str, str]:
        return self.scan_sequencer.unreachable

    @property
    def frame_clocks(self) -> int:
        """A frame begins when its scan begins."""
        return int(self.scan_sequencer.sample_clocks[-1]) + 1

    @property
    def scan(self) -> ScanSequencer:
        return self.scan_sequencer

    def flow(self) -> Flow:
        given = Wire("codes of the converter", SIGNAL)
        return Flow((given, self.scan_sequencer, None, self.readout))

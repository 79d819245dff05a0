"""Instrument: everything from a converter and an analogue multiplexer to the results."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.common.port import CLOCKED, Port
from golden.instruments.scanned import Scanned
from golden.sensing.scan_sequencer import ScanSequencer


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
        self.check_frames(scan.inputs, scan.slots)
        samples = scan.sample_clocks
        left = scan.scan_clocks - int(samples[-1]) + int(samples[0]) - 1
        self.check_scan(scan.counter_width, scan.scan_clocks, left)

    @property
    def interval(self) -> int:
        return self.scan_sequencer.scan_clocks

    @property
    def ports(self) -> tuple[Port, ...]:
        scan = {port.name: port for port in self.scan_sequencer.ports}
        return (*CLOCKED, scan["adc"], scan["address"], *self.shown_ports)

    @property
    def unreachable(self) -> dict[str, str]:
        return self.scan_sequencer.unreachable

    @property
    def latency(self) -> int:
        return self.scan_sequencer.latency + self.readout.latency

    @property
    def output_clocks(self) -> tuple[int, ...]:
        return tuple(self.scan_sequencer.latency + c for c in self.readout.output_clocks)

    @property
    def frame_clocks(self) -> int:
        """A frame begins when its scan begins."""
        return int(self.scan_sequencer.sample_clocks[-1]) + 1

    @property
    def scanner(self) -> ScanSequencer:
        return self.scan_sequencer

    def parts(self) -> tuple[Block, ...]:
        return (self.scan_sequencer, self.readout)

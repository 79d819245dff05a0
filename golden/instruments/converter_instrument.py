"""Converter instrument: everything from a converter on an SPI to the results."""

from dataclasses import dataclass

from golden.common.flow import Flow, Wire
from golden.common.port import CLOCKED, Port
from golden.instruments.instrument import Scanned
from golden.numbers.fixed import Codes
from golden.sensing.converter_reader import ConverterReader


@dataclass(frozen=True)
class ConverterInstrument(Scanned):
    """``Instrument`` with a converter that can be bought, which digitises the samples."""

    block = "converter_instrument"
    stream = "spi"
    converter_reader: ConverterReader

    def __post_init__(self) -> None:
        reader = self.converter_reader
        self.check_scan(reader, reader.scan_clocks - reader.slots)

    @property
    def scan(self) -> ConverterReader:
        return self.converter_reader

    @property
    def ports(self) -> tuple[Port, ...]:
        wires = {port.name: port for port in self.converter_reader.ports}
        return (
            *CLOCKED,
            *(wires[name] for name in ("miso", "sclk", "cs_n", "mosi", "converter_error")),
            *self.shown_ports,
        )

    @property
    def burst(self) -> int:
        return self.scan.latency + self.scan.slots - 1

    @property
    def frame_clocks(self) -> int:
        """A frame begins with its scan and ends with the scan's last bit."""
        return int(self.converter_reader.read_clocks[-1, -1]) + 1

    def flow(self) -> Flow:
        given = Wire("codes of the converter", self.converter_reader.part.bits)
        return Flow((given, self.converter_reader, None, self.readout))

    def compute(self, frames: Codes) -> Codes:
        reader = self.converter_reader
        return self.readout.compute(reader.process(reader.converted(frames)))

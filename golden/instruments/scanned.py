"""What all instruments share, whatever reads their sensors: the readout at the end."""

from dataclasses import dataclass, field

from golden.common.port import Port
from golden.input_error import InputError
from golden.instruments.readout import Readout
from golden.layers.argmax import Argmax
from golden.networks.network import Around, Network


@dataclass(frozen=True)
class Scanned(Around):
    """A network whose frames are scans; it computes what the network inside computes."""

    area = "instruments"
    readout: Readout = field(kw_only=True)

    def check_frames(self, inputs: int, slots: int) -> None:
        """Refuse scans whose frames are not those of the network.

        inputs, slots: Number of sensors, and of elements of a frame.
        """
        got, expected = (inputs, slots), (self.inputs, self.readout.input_controller.inputs)
        if got != expected:
            raise InputError(
                f"{self.entity}: got a scan of (inputs, slots) {got}, expected {expected}"
            )

    def check_scan(self, width: int, scan_clocks: int, left: int) -> None:
        """Refuse scans that follow each other faster than the network accepts frames.

        width: Bits of the scan's counter.
        scan_clocks, left: Clocks from scan to scan, and from the last sample of one scan to the
            first of the next.
        """
        if scan_clocks < self.readout.interval:
            raise InputError(
                f"{self.entity}: got counter_width={width}, a scan of {scan_clocks} clocks, "
                f"expected {self.readout.interval} or more, which the network needs"
            )
        if left < self.readout.busy:
            raise InputError(
                f"{self.entity}: got counter_width={width}, a scan that leaves {left} "
                f"clocks between two frames, expected {self.readout.busy} or more, in which the "
                "network computes"
            )

    @property
    def inside(self) -> Network:
        return self.readout

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

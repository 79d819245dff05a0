"""The section ``[front_end]`` of a scene: how its sensors are read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.networks.network import Network
from golden.precision import SIGNAL
from golden.sensing.scan_sequencer import ScanSequencer

# Key, type, default; see ``golden.scene``.
KEYS: dict[str, tuple[Any, Any]] = {"counter_width": (int, 12), "sample_at": (float, 0.9)}


@dataclass(frozen=True)
class FrontEnd:
    """What a scene says of its front end.

    Attributes
    ----------
    counter_width : int
        Bits of the counter; a scan takes 2**counter_width clocks.
    sample_at : float
        Where in a slot the converter's code is taken, as a part of the slot.
    """

    counter_width: int
    sample_at: float

    def scan_sequencer(self, network: Network) -> ScanSequencer:
        """The sequencer that makes frames for ``network``.

        Raises
        ------
        ValueError
            When the counter is too narrow for the frame, or the slot too short for ``sample_at``.
        """
        return self._sequencer(network.inputs, network.input_controller.inputs)

    def clocks_left(self, inputs: int) -> int:
        """Clocks from the last sample of a frame to the first of the next, where it has no slots.

        Raises
        ------
        ValueError
            As ``scan_sequencer``.
        """
        scan = self._sequencer(inputs, inputs)
        samples = scan.sample_clocks
        return scan.scan_clocks - int(samples[-1]) + int(samples[0]) - 1

    def _sequencer(self, inputs: int, slots: int) -> ScanSequencer:
        slot_clocks = (1 << self.counter_width) >> max(1, (slots - 1).bit_length())
        return ScanSequencer(
            SIGNAL, inputs, slots, self.counter_width, int(self.sample_at * slot_clocks)
        )


def front_end(values: dict[str, Any], path: Path) -> FrontEnd:
    """The section's values, types checked and defaults filled in.

    Raises
    ------
    ValueError
        For a counter outside 1 to 24 bits, or a ``sample_at`` outside its slot.
    """
    if not 1 <= values["counter_width"] <= 24:
        raise ValueError(
            f"{path}: front_end.counter_width: got {values['counter_width']}, expected 1 to 24"
        )
    if not 0 < values["sample_at"] < 1:
        raise ValueError(
            f"{path}: front_end.sample_at: got {values['sample_at']}, expected above 0 and below 1"
        )
    return FrontEnd(**values)

"""The facts about a board that its scene states: packets, units and baud rate."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from golden.input_error import InputError
from golden.instruments.uart_instrument import UartInstrument
from golden.layers.argmax import Argmax
from golden.link.packets import FLAGS, Frame, FrameLayout
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.rig.predict import decimals, decision_columns
from tactus.scene import Scene, load_scene
from tactus.scene.scale import readings, signals


@dataclass(frozen=True)
class Board:
    """A scene that runs on a board.

    scene: The scene whose networks run. It names the columns and their units.
    hardware: The scene whose hardware the board has. It says what the packets hold.
    """

    scene: Scene
    hardware: Scene

    def __post_init__(self) -> None:
        if self.hardware.uart is None:
            raise InputError(
                f"{self.hardware.path}: got no section [uart], expected one, as scene digit-board "
                "has, or HARDWARE= a scene with one"
            )
        for key in ("sensors", "outputs"):
            got, most = (len(getattr(one, key)) for one in (self.scene, self.hardware))
            if got != most and (got > most or key == "sensors"):
                raise InputError(
                    f"{self.scene.path}: data.{key}: got {got}, expected {most}"
                    f"{' at most' if key == 'outputs' else ''}, as the packets of "
                    f"{self.hardware.path} hold"
                )

    @cached_property
    def layout(self) -> FrameLayout:
        return self.instrument.packet_sender.layout

    @cached_property
    def instrument(self) -> UartInstrument:
        twin = self.hardware.twin()
        assert isinstance(twin, UartInstrument), "a scene with a section [uart] is that"
        return twin

    @property
    def baud(self) -> int:
        assert self.hardware.uart is not None, "looked at when it was made"
        return self.hardware.uart.baud

    @cached_property
    def flags(self) -> list[str]:
        """The flags that its hardware can raise."""
        ports = {port.name for port in self.instrument.packet_sender.ports}
        return [name for name in FLAGS if name in ports]

    @property
    def columns(self) -> tuple[str, ...]:
        return (*self.scene.sensors, *self.scene.outputs)

    @cached_property
    def decision_columns(self) -> list[str]:
        """The names of what ``decision`` gives; none if nothing is decided.

        Packets carry a decision if the hardware has ``argmax``. Otherwise it follows from the
        outputs, if the scene has classes.
        """
        decides = self.layout.decides or self.scene.labels
        return decision_columns(self.scene) if decides else []

    def decision(self, frame: Frame) -> list[str]:
        """The label that a frame is decided for, and the margin in codes, as texts.

        Without classes the label is the name of an output. It is empty if the scene has no such
        label, because then the board runs something else.
        """
        if not self.decision_columns:
            return []
        count = len(self.scene.outputs)
        index, margin = frame.winner or Argmax(SIGNAL, count).process(frame.outputs[:count])
        labels = self.scene.labels or self.scene.outputs
        return [labels[index] if index < count else "", str(margin)]

    @cached_property
    def decimals(self) -> list[int]:
        """The number of decimals of each column: so many that any two codes differ."""
        return [decimals(scale.factor) for scale in self.scene.scales(self.columns)]

    def in_units(self, frames: list[Frame]) -> Real:
        """Samples and outputs in the units of their columns, shape (frames, columns)."""
        count = len(self.columns)
        # Packets hold as many outputs as the hardware has, which may be more than the scene's.
        codes = np.array([(frame.samples + frame.outputs)[:count] for frame in frames])
        return readings(SIGNAL.to_real(codes), self.scene.scales(self.columns))

    def known_codes(self, values: object) -> list[int]:
        """The codes of known outputs, which are given in their units as texts."""
        outputs = self.scene.outputs
        if not isinstance(values, dict) or not all(isinstance(v, str) for v in values.values()):
            raise InputError(f"known: got {values!r:.40}, expected a text for each output")
        if len(outputs) < self.layout.outputs:
            raise InputError(
                f"{self.scene.path}: data.outputs: got {len(outputs)}, expected "
                f"{self.layout.outputs}, those that {self.hardware.path} learns from"
            )
        return [self._known_code(name, values.get(name, "").strip()) for name in outputs]

    def _known_code(self, name: str, text: str) -> int:
        scales, places = self.scene.scales([name]), self.decimals[self.columns.index(name)]
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if math.isfinite(number):
            (code,), outside = SIGNAL.quantise(signals(np.array([number]), scales))
            if not outside:
                return int(code)
        low, high = readings(SIGNAL.to_real([[SIGNAL.low], [SIGNAL.high]]), scales)[:, 0]
        raise InputError(
            f"{name}: got {repr(text) if text else 'nothing'}, expected a number from "
            f"{low:.{places}f} to {high:.{places}f}"
        )

    def millimetres(self, name: str) -> float:
        """How many millimetres one unit of an output is; 0 if the output is no length."""
        scene = self.scene
        length = scene.length_mm.get(name, 0.0)
        return length / scene.full_scale[name] if length else 0.0

    def texts(self, values: Real) -> list[str]:
        """The values of one frame as texts with their decimals; -0 becomes 0."""
        return [f"{v.round(d) + 0:.{d}f}" for v, d in zip(values, self.decimals, strict=True)]


def board_of(scene: str, hardware: str = "") -> Board:
    """The board of a scene by name or path, with its own hardware or that of another scene."""
    own = load_scene(scene)
    return Board(own, load_scene(hardware) if hardware else own)

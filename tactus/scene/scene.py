"""A scene: its sensors, its outputs, its networks, and the form of its hardware."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from golden.activation.scheme import Scheme
from golden.activation.schemes import SCHEMES
from golden.engine.ranges import function_input_ranges, hidden_peaks
from golden.input_error import InputError, naming
from golden.networks.arrangement import process_real
from golden.networks.design import Design, Settings
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.networks.hybrid import Hybrid
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.numbers.precision import EXACT, SIGNAL, THESIS, Precision
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from golden.trained.window import Window
from tactus.network_files.network_file import provenance_path
from tactus.network_files.parsed import file_of
from tactus.scene.building import build_twin, choice_of, chosen
from tactus.scene.data import tap_names
from tactus.scene.front_end import FrontEnd, Uart, Visualisation
from tactus.scene.known_scales import converter_scales, trained_scales
from tactus.scene.labels import check_labels, class_scale
from tactus.scene.network import SceneNetwork
from tactus.scene.scale import AUTO, Scale, on_signals, readings, signals
from tactus.scene.training import Training
from tactus.scene.vectors import Vectors, read_recorded, read_vectors
from tactus.sizing.choice import DEFAULT, DEVICES, NO_DEMAND, UNDECIDED, Choice, Demand, Device

# While a network is trained whose design is still to be chosen, it is computed by these.
STAND_INS: dict[str, type[Design]] = {EXACT.name: Engine, THESIS.name: Hybrid}


@dataclass(frozen=True)
class Scene:
    """One scene, read and checked. ``keys.toml`` explains attributes with the names of keys.

    data_paths: The recordings. No recording is the continuation of another.
    outputs: If there are classes, each of them is an output.
    labels: The labels, in the order of the outputs; empty if outputs are numbers.
    window: The samples that the networks read, of the newest frame and of past frames.
    scale: Columns with their ``Scale``, or "auto", as the file says; see ``known_scales``.
    members: The networks, in the order of the outputs.
    design: A name of ``DESIGNS``, or "auto"; see ``chosen``.
    demand: How fast the networks must be.
    device: The device whose shares are compared where the design is to be chosen.
    """

    name: str
    path: Path
    data_paths: tuple[Path, ...]
    sensors: tuple[str, ...]
    outputs: tuple[str, ...]
    classes: str
    labels: tuple[str, ...]
    window: Window
    group_by: str
    where: dict[str, float | str]
    full_scale: dict[str, float]
    length_mm: dict[str, float]
    scale: dict[str, Scale | str]
    units: dict[str, str]
    ends: tuple[float, ...]
    reference: str
    arrangement: str
    members: tuple[SceneNetwork, ...]
    design: str
    design_options: dict[str, Any]
    activation: str
    activation_options: dict[str, Any]
    precision: Precision
    clock_mhz: float
    interface: str
    argmax: bool
    training: Training
    front_end: FrontEnd | None
    visualisation: Visualisation | None
    uart: Uart | None
    learning: str = ""
    demand: Demand = NO_DEMAND
    device: Device = DEVICES[DEFAULT]

    @property
    def weights_paths(self) -> list[Path]:
        """Where each network stands; one of several in a file has its name behind the file's."""
        return [member.weights_path for member in self.members]

    @property
    def network_files(self) -> list[Path]:
        return list(dict.fromkeys(map(file_of, self.weights_paths)))

    @property
    def provenance_paths(self) -> list[Path]:
        return list(map(provenance_path, self.network_files))

    @property
    def files(self) -> list[Path]:
        """All files that the scene reads: its own, its networks, points of functions, and data."""
        provenance = self.provenance_paths if self.auto else []
        points = self.members[0].function_files
        return [self.path, *self.network_files, *provenance, *points, *self.data_paths]

    @property
    def own_files(self) -> list[Path]:
        """All files of the scene: those that it reads, and those that training writes."""
        return [*self.files, *self.provenance_paths]

    @property
    def data_path(self) -> Path:
        """The recording; the first one if there are several."""
        return self.data_paths[0]

    @property
    def data_text(self) -> str:
        """The names of the recordings for a message."""
        return ", ".join(map(str, self.data_paths))

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """A name for each sample that the networks read; without a past these are the sensors."""
        return tap_names(self.window, self.sensors)

    @property
    def window_text(self) -> str:
        """The delays of the samples in frames, as text."""
        texts = [" ".join(map(str, delays)) for delays in self.window.delays]
        if len(set(texts)) == 1:
            return texts[0]
        return ", ".join(f"{name} {text}" for name, text in zip(self.sensors, texts, strict=True))

    @property
    def activation_text(self) -> str:
        """The activation as text, with the options that the scene sets."""
        if self.design == UNDECIDED and self.precision == EXACT:
            return "the activation of the design"
        options = ", ".join(f"{name} = {value}" for name, value in self.activation_options.items())
        return f"{self.activation} ({options})" if options else self.activation

    def hidden_text(self) -> str:
        """What hidden nodes compute: the hardware's approximation of tanh, or other activations."""
        layers = [layer for network in self.networks() for layer in network.layers[:-1]]
        kinds = {"tanh": self.activation_text, "sigmoid": f"sigmoid by {self.activation_text}"}
        named = [
            "functions in tables" if one.functions else kinds.get(one.activation) for one in layers
        ]
        texts = [text or one.activation_text for text, one in zip(named, layers, strict=True)]
        return ", ".join(dict.fromkeys(texts)) or "none"

    @property
    def scheme(self) -> Scheme:
        """The activation with the options that the scene sets."""
        return SCHEMES[self.activation].configured(self.activation_options)

    def vectors(self) -> Vectors:
        """The recorded vectors of this scene, read once; see ``read_vectors``."""
        return self._vectors

    @cached_property
    def _vectors(self) -> Vectors:
        return read_vectors(self)

    def networks(self) -> list[DenseNetwork]:
        """The trained networks in floating point, on signals, read once."""
        return self._networks

    def mlps(self) -> list[DenseNetwork]:
        """The networks, for callers that only handle one hidden layer of tanh."""
        found = []
        for member, network in zip(self.members, self.networks(), strict=True):
            if not network.plain:
                raise InputError(
                    f"{member.weights_path}: got hidden layers of "
                    f"{', '.join(network.activations) or 'none'}, expected one hidden layer "
                    "of tanh, which is all that this command can do"
                )
            found.append(network)
        return found

    @cached_property
    def _networks(self) -> list[DenseNetwork]:
        found: list[DenseNetwork] = []
        if self.labels:
            check_labels(self)
        for number, member in enumerate(self.members):
            held = member.load()
            scales = self.scales_as_read(held, number)
            with naming(f"{member.weights_path}, with data.scale of {self.path}"):
                found.append(on_signals(held, *scales))
        return found

    def columns_of(self, number: int) -> list[str]:
        """A network's inputs, which are samples and earlier outputs, and its own outputs."""
        member = self.members[number]
        return [*[*self.inputs, *self.outputs][: member.inputs], *member.outputs]

    def column(self, name: str) -> str:
        """The column that holds a name's readings; that of a past sample is its sensor's."""
        return self._columns.get(name, name)

    @cached_property
    def _columns(self) -> dict[str, str]:
        taps = zip(self.inputs, self.window.taps, strict=True)
        return {name: self.sensors[tap.sensor] for name, tap in taps}

    def scales_of(self, number: int) -> tuple[list[Scale], list[Scale]]:
        scales, inputs = self.scales(self.columns_of(number)), self.members[number].inputs
        return scales[:inputs], scales[inputs:]

    def scales_as_read(self, network: DenseNetwork, number: int) -> tuple[list[Scale], list[Scale]]:
        """The scales with which a network is read from its file.

        The logits of a network that tells classes apart have a scale of their own.
        """
        inputs, outputs = self.scales_of(number)
        if self.labels:
            outputs = [class_scale(network, read_recorded(self).inputs)] * len(outputs)
        return inputs, outputs

    def scales(self, columns: Sequence[str]) -> list[Scale]:
        """The scale of each of these columns or samples; see ``trained_scales``."""
        return [self.known_scales.get(self.column(name), Scale()) for name in columns]

    @property
    def auto(self) -> list[str]:
        """The columns with a scale of "auto", except the sensors of a converter."""
        fixed = self.sensors if self.front_end and self.front_end.converter else ()
        return [n for n, scale in self.scale.items() if scale == AUTO and n not in fixed]

    @cached_property
    def converter_scales(self) -> dict[str, Scale]:
        """The scales that the scene's converter sets; see ``tactus.scene.known_scales``."""
        return converter_scales(self)

    @cached_property
    def known_scales(self) -> dict[str, Scale]:
        """The scales of all columns that have one; see ``trained_scales``."""
        return trained_scales(self)

    def codes_of(self, readings: Real) -> Codes:
        """Codes of the networks' inputs, shape (frames, inputs), from readings of sensors."""
        return SIGNAL.quantise(signals(readings, self.scales(self.inputs)), "readings")[0]

    def in_units(self, outputs: Real) -> Real:
        """Outputs in their units, from outputs as signals, shape (frames, outputs)."""
        return readings(outputs, self.scales(self.outputs))

    def outputs_in_units(self, codes: Codes) -> Real:
        """Outputs in their units, from codes of the outputs, shape (frames, outputs)."""
        return self.in_units(SIGNAL.to_real(codes))

    def process_real(self, samples: Real) -> Real:
        """Outputs of the trained networks in floating point, with this scene's activation.

        Samples and outputs are signals.
        """
        return process_real(self.arrangement, self.networks(), samples, self.scheme.real)

    def settings(
        self, lean: bool = True, networks: Sequence[DenseNetwork] | None = None
    ) -> Settings:
        """What this scene chooses of the hardware of its networks, or of others in their place."""
        given = self.networks() if networks is None else networks
        options = dict(self.design_options)
        if self.learning:
            options["lanes"] = 1
        # One hidden layer of tanh needs no range, and so no frames.
        ends = [((), ()) if one.plain else self._ends(one) for one in given]
        return Settings(
            self.precision,
            self.activation,
            self.activation_options,
            options,
            lean,
            tuple(met for met, _ in ends),
            tuple(reached for _, reached in ends),
        )

    def _ends(
        self, network: DenseNetwork
    ) -> tuple[tuple[float, ...], tuple[tuple[float, float], ...]]:
        """What its layers, and its sums that take functions, come to on the recorded frames."""
        inputs = self.inputs_of(network)
        return hidden_peaks(network, inputs), function_input_ranges(network, inputs)

    def inputs_of(self, network: DenseNetwork) -> Real:
        """The inputs of a network in the recorded frames, as signals.

        If a network reads outputs of earlier networks, the targets are used in their place, because
        these outputs come near to them.
        """
        vectors = self.vectors()
        earlier = network.shape[0] - len(self.inputs)
        inputs = [SIGNAL.to_real(vectors.codes), vectors.targets[:, :earlier]]
        return np.concatenate(inputs, axis=1)

    def build(self, network: DenseNetwork, lean: bool = True) -> Design:
        """The bit-true network of ``network`` in this scene's hardware; see ``Design.of``."""
        design = DESIGNS.get(self.design) or STAND_INS[self.precision.name]
        return design.of([network], self.settings(lean, [network]))

    @cached_property
    def choice(self) -> Choice | None:
        """The design that is chosen; None where the scene names one."""
        return choice_of(self) if self.design == UNDECIDED else None

    @cached_property
    def chosen(self) -> Scene:
        """This scene, with the design that is chosen in the place of "auto"; see ``choice``."""
        return chosen(self, self.choice) if self.choice else self

    def twin(self, lean: bool = True) -> Network:
        """The bit-true twin of this scene's hardware, built once; see ``build_twin``."""
        return self._lean if lean else self._whole

    @cached_property
    def _lean(self) -> Network:
        return build_twin(self, lean=True)

    @cached_property
    def _whole(self) -> Network:
        return build_twin(self, lean=False)

    def describe(self) -> str:
        """Inputs, hidden nodes of each layer and outputs of each network, as text."""
        return ", ".join(":".join(map(str, network.shape)) for network in self.networks())

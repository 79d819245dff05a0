"""A scene: which sensors, which outputs, which network, in which form of hardware.

A scene is one TOML file, in ``golden/scenes`` or anywhere else. Paths in it are relative to it.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.activation.schemes import SCHEMES, Scheme
from golden.fixed import Codes
from golden.instruments.instrument import Instrument
from golden.instruments.readout import Readout
from golden.network_file import load_network
from golden.networks.arrangement import ARRANGEMENTS, arrange, process_real
from golden.networks.axis_network import AxisNetwork
from golden.networks.build import DESIGNS
from golden.networks.mlp import Mlp, Real
from golden.networks.network import Network
from golden.precision import PRECISIONS, SIGNAL, Precision
from golden.sensing.section import KEYS as FRONT_END_KEYS
from golden.sensing.section import FrontEnd, front_end
from golden.table import read_table, rows_where, suggest
from golden.visualisation.section import KEYS as VISUALISATION_KEYS
from golden.visualisation.section import Visualisation, visualisation

FOLDER = Path(__file__).parent / "scenes"

# Section, key, type, default; None as a default makes the key required. A type in brackets is one
# such value for all networks of the scene, or a list of one for each.
_KEYS: dict[str, dict[str, tuple[Any, Any]]] = {
    "data": {
        "file": (str, None),
        "sensors": (list, None),
        "outputs": (list, None),
        "group_by": (str, ""),
        "where": (dict, {}),
        "full_scale": (dict, {}),
        "length_mm": (dict, {}),
        "reference": (str, ""),
    },
    "network": {
        "arrangement": (str, None),
        "hidden": ([int], 0),
        "weights": ([str], None),
    },
    "hardware": {
        "design": (str, None),
        "activation": (str, ""),
        "activation_options": (dict, {}),
        "precision": (str, None),
        "clock_mhz": (float, 64.0),
        "interface": (str, "stream"),
    },
    "training": {
        "optimiser": (str, "levenberg-marquardt"),
        "hidden": (list, [4, 25]),
        "seed": (int, 1),
        "restarts": (int, 8),
        "weight_decay": (float, 1e-4),
        "steps": (int, 200),
        "patience": (int, 40),
        "earlier_outputs": (str, "bit-true"),
    },
    "front_end": FRONT_END_KEYS,
    "visualisation": VISUALISATION_KEYS,
}
# Sections without which a scene has no such thing; of the others the defaults stand.
_OPTIONAL = ("front_end", "visualisation")
_CHOICES = {
    ("network", "arrangement"): ARRANGEMENTS,
    ("hardware", "design"): tuple(DESIGNS),
    ("hardware", "activation"): tuple(SCHEMES),
    ("hardware", "precision"): tuple(PRECISIONS),
    ("hardware", "interface"): ("stream", "axi_stream"),
    ("training", "optimiser"): ("levenberg-marquardt", "scg"),
    ("training", "earlier_outputs"): ("bit-true", "float"),
}


@dataclass(frozen=True)
class Training:
    """How a scene's networks are trained; see ``golden.training``.

    ``earlier_outputs`` tells what a network of a cascade trains on: the outputs that the networks
    before it give in floating point (the thesis' cascade A) or bit-true (cascade B).
    """

    optimiser: str
    hidden: tuple[int, int]
    seed: int
    restarts: int
    weight_decay: float
    steps: int
    patience: int
    earlier_outputs: str


@dataclass(frozen=True)
class Member:
    """One network of a scene.

    Attributes
    ----------
    inputs : int
        Sensors and, in a cascade, the outputs of the networks before it.
    hidden : int
        0 takes as many as the network file has; training then searches ``training.hidden``.
    outputs : tuple of str
    weights_path : Path
    """

    inputs: int
    hidden: int
    outputs: tuple[str, ...]
    weights_path: Path

    def load(self) -> Mlp:
        """The trained network.

        Raises
        ------
        FileNotFoundError, ValueError
            See ``load_network``.
        """
        return load_network(self.weights_path, (self.inputs, self.hidden, len(self.outputs)))


@dataclass(frozen=True)
class Scene:
    """One scene, read and checked.

    Attributes
    ----------
    name : str
        The file's name without its ending.
    path : Path
    data_path : Path
    sensors, outputs : tuple of str
        Columns of the recorded vectors.
    group_by : str
        Column of the positions over which equation 3.15 averages; empty where there are none.
    where : dict
        Columns and the values that they have in the rows that are used.
    full_scale : dict
        Outputs whose error is divided by this constant instead of by the target.
    length_mm : dict
        What the full scale of an output is in millimetres.
    reference : str
        Table of golden/data/thesis_numbers.toml to compare with, or nothing.
    arrangement : str
    members : tuple of Member
        The networks, in the order of the outputs.
    form : str
        The hardware's design, a name of ``DESIGNS``.
    activation : str
    activation_options : dict
        What the scene chooses of the activation's options.
    precision : Precision
    clock_mhz : float
    interface : str
        ``stream``, the network's own ports, or ``axi_stream``.
    training : Training
    front_end : FrontEnd or None
        How the sensors are read, where the scene has that section.
    visualisation : Visualisation or None
        The profile of the load, where the scene has that section.
    """

    name: str
    path: Path
    data_path: Path
    sensors: tuple[str, ...]
    outputs: tuple[str, ...]
    group_by: str
    where: dict[str, float]
    full_scale: dict[str, float]
    length_mm: dict[str, float]
    reference: str
    arrangement: str
    members: tuple[Member, ...]
    form: str
    activation: str
    activation_options: dict[str, Any]
    precision: Precision
    clock_mhz: float
    interface: str
    training: Training
    front_end: FrontEnd | None
    visualisation: Visualisation | None

    @property
    def weights_paths(self) -> list[Path]:
        """The network files."""
        return [member.weights_path for member in self.members]

    @property
    def files(self) -> list[Path]:
        """Everything that the scene reads: its own file, its networks, its data."""
        return [self.path, *self.weights_paths, self.data_path]

    @property
    def activation_text(self) -> str:
        """The activation as a reader names it, with the options that the scene chooses."""
        options = ", ".join(f"{name} = {value}" for name, value in self.activation_options.items())
        return f"{self.activation} ({options})" if options else self.activation

    @property
    def scheme(self) -> Scheme:
        """The activation with the scene's options."""
        return SCHEMES[self.activation].configured(self.activation_options)

    def vectors(self) -> Vectors:
        """The recorded vectors of this scene.

        Raises
        ------
        FileNotFoundError, ValueError
            See ``read_table`` and ``rows_where``; also for a target outside -1 to 1, or a target
            of 0 where the error is relative to the target.
        """
        columns = [*self.sensors, *self.outputs] + ([self.group_by] if self.group_by else [])
        kept = rows_where(self.data_path, self.where)
        table = read_table(self.data_path, columns)[kept]
        inputs = table[:, : len(self.sensors)]
        last = len(self.sensors) + len(self.outputs)
        targets = table[:, len(self.sensors) : last]
        groups = table[:, -1] if self.group_by else np.zeros(len(table))
        beyond = np.argwhere(np.abs(targets) > 1)
        if len(beyond):
            row, c = beyond[0]
            raise ValueError(
                f"{self.data_path}: column {self.outputs[c]!r}: got a target of {targets[row, c]:g}"
                f" in row {kept[row] + 1}, expected -1 to 1, the range of {SIGNAL}"
            )
        for c, name in enumerate(self.outputs):
            if name not in self.full_scale and (targets[:, c] == 0).any():
                raise ValueError(
                    f"{self.data_path}: column {name!r} holds a target of 0, whose relative error "
                    f"is not defined; give {name} a full_scale in {self.path}"
                )
        codes, saturated = SIGNAL.quantise(inputs, f"{self.data_path} sensors")
        return Vectors(inputs, targets, groups, codes, saturated)

    def mlps(self) -> list[Mlp]:
        """The trained networks in floating point.

        Raises
        ------
        FileNotFoundError, ValueError
            See ``load_network``.
        """
        return [member.load() for member in self.members]

    def process_real(self, samples: Real) -> Real:
        """Outputs of the trained networks with this scene's activation in floating point."""
        return process_real(self.arrangement, self.mlps(), samples, self.scheme.real)

    def build(self, mlp: Mlp, variant: str = "", lean: bool = True) -> Network:
        """The bit-true network of ``mlp`` in this scene's hardware; see ``build_hybrid``."""
        build = DESIGNS[self.form].build
        options = self.activation_options
        return build(mlp, self.precision, self.activation, options, variant, lean)

    def design(self, lean: bool = True) -> Network:
        """The bit-true twin of this scene's hardware.

        ``lean`` leaves out what the weights make useless; see ``build_hybrid``.

        Raises
        ------
        FileNotFoundError, ValueError
            See ``load_network`` and ``build_hybrid``; also for a front end that cannot make the
            network's frames.
        """
        build = partial(self.build, lean=lean)
        network = arrange(self.arrangement, self.mlps(), build)
        if self.interface == "axi_stream":
            return AxisNetwork(network)
        drawn = self.visualisation
        if drawn is not None:
            network = Readout(network, drawn.load_profile, drawn.results)
        if self.front_end is None:
            return network
        readout = network if isinstance(network, Readout) else Readout(network)
        try:
            return Instrument(self.front_end.scan_sequencer(network), readout)
        except ValueError as error:
            raise ValueError(f"{self.path}: front_end: {error}") from None

    def describe(self) -> str:
        """Inputs, hidden nodes and outputs of each network."""
        return ", ".join(":".join(str(n) for n in mlp.shape) for mlp in self.mlps())


@dataclass(frozen=True)
class Vectors:
    """Recorded vectors: real inputs, targets, positions, and the inputs as codes.

    ``saturated`` counts inputs outside [-1, 1) that were replaced by the nearest code.
    """

    inputs: NDArray[np.float64]
    targets: NDArray[np.float64]
    groups: NDArray[np.float64]
    codes: Codes
    saturated: int


def thesis_table(key: str) -> dict[str, Any]:
    """A table of golden/data/thesis_numbers.toml by its dotted name; empty where there is none."""
    text = (FOLDER.parent / "data" / "thesis_numbers.toml").read_text(encoding="utf-8")
    table: Any = tomllib.loads(text)
    for part in key.split("."):
        table = table.get(part) if isinstance(table, dict) else None
    return table if isinstance(table, dict) else {}


def thesis_figures(key: str, outputs: int, path: Path) -> list[float]:
    """The thesis' largest mean errors that a scene names, one per output, in percent.

    Raises
    ------
    ValueError
        When golden/data/thesis_numbers.toml has no such table, or another number of figures.
    """
    figures = thesis_table(key).get("simulation")
    if figures is None or len(figures) != outputs:
        raise ValueError(
            f"{path}: data.reference: got {key!r}, expected a table of thesis_numbers.toml with "
            f"{outputs} simulation figures, such as digit.hybrid"
        )
    return [float(figure) for figure in figures]


def scene_names() -> list[str]:
    """The scenes that tactus ships."""
    return sorted(p.stem for p in FOLDER.glob("*.toml") if ".provenance" not in p.name)


def load_scene(name: str) -> Scene:
    """Read a scene by its name, or by a path that ends in ``.toml``.

    Raises
    ------
    FileNotFoundError
        For an unknown scene; the message lists those there are.
    ValueError
        For a fault in the file; the message names file, key, what was got and what was expected.
    """
    known = scene_names()
    path = Path(name).expanduser() if name.endswith(".toml") else FOLDER / f"{name}.toml"
    if not path.is_file() or (path.parent == FOLDER and path.stem not in known):
        raise FileNotFoundError(
            f"scene {name!r}: no such scene, expected a path to a .toml file or one of "
            f"{', '.join(known)}{suggest(name, known)}"
        )
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{path}: not TOML: {error}") from None
    values = _checked(raw, path)
    return _scene(values, path)


def _checked(raw: dict[str, Any], path: Path) -> dict[str, dict[str, Any]]:
    """Every section with every key, types and choices checked, defaults filled in."""
    _refuse_unknown(raw, _KEYS, f"{path}: section")
    values: dict[str, dict[str, Any]] = {}
    for section, keys in _KEYS.items():
        if section in _OPTIONAL and section not in raw:
            continue
        given = raw.get(section, {})
        if not isinstance(given, dict):
            raise ValueError(f"{path}: {section}: got {given!r}, expected a section")
        _refuse_unknown(given, keys, f"{path}: {section}: key")
        values[section] = {}
        for key, (kind, default) in keys.items():
            value = given.get(key, default)
            if value is None:
                raise ValueError(f"{path}: {section}.{key}: missing, expected {_kind(kind)}")
            if kind is float and type(value) is int:
                value = float(value)
            if not _is(value, kind):
                raise ValueError(f"{path}: {section}.{key}: got {value!r}, expected {_kind(kind)}")
            choices = _CHOICES.get((section, key))
            if choices and key in given and value not in choices:
                raise ValueError(
                    f"{path}: {section}.{key}: got {value!r}, expected one of "
                    f"{', '.join(choices)}{suggest(str(value), choices)}"
                )
            values[section][key] = value
    return values


def _is(value: Any, kind: Any) -> bool:
    if isinstance(kind, list):
        values = value if isinstance(value, list) else [value]
        return all(type(v) is kind[0] for v in values)
    return type(value) is kind


def _kind(kind: Any) -> str:
    if isinstance(kind, list):
        return f"{_kind(kind[0])}, or a list with one for each network"
    names = {str: "text", int: "a whole number", float: "a number", list: "a list", dict: "a table"}
    return names[kind]


def _refuse_unknown(given: dict[str, Any], known: dict[str, Any], place: str) -> None:
    for name in given:
        if name not in known:
            raise ValueError(
                f"{place} {name!r} is not known, expected {', '.join(known)}"
                f"{suggest(name, list(known))}"
            )


def _scene(values: dict[str, dict[str, Any]], path: Path) -> Scene:
    data, network, hardware = values["data"], values["network"], values["hardware"]
    for key in ("sensors", "outputs"):
        names = data[key]
        if not names or any(type(n) is not str for n in names) or len(set(names)) < len(names):
            raise ValueError(f"{path}: data.{key}: got {names!r}, expected column names, each once")
    for key, known in (("full_scale", data["outputs"]), ("length_mm", list(data["full_scale"]))):
        for name, scale in data[key].items():
            if name not in known:
                what = "output" if key == "full_scale" else "output with a full_scale"
                raise ValueError(
                    f"{path}: data.{key}: {name!r} is no {what}, expected one of "
                    f"{', '.join(known)}{suggest(name, known)}"
                )
            if type(scale) not in (int, float) or not 0 < scale < math.inf:
                raise ValueError(
                    f"{path}: data.{key}.{name}: got {scale!r}, expected a number above 0"
                )
    for name, value in data["where"].items():
        if type(value) not in (int, float) or not math.isfinite(value):
            raise ValueError(f"{path}: data.where.{name}: got {value!r}, expected a number")
    possible = DESIGNS[hardware["design"]].arrangements
    if network["arrangement"] not in possible:
        raise ValueError(
            f"{path}: network.arrangement: got {network['arrangement']!r} with design "
            f"{hardware['design']!r}, expected {' or '.join(possible)}"
        )
    _check_interface(values, path)
    members = _members(data, network, path)
    span = values["training"]["hidden"]
    if [type(n) for n in span] != [int, int] or not 1 <= span[0] <= span[1]:
        raise ValueError(
            f"{path}: training.hidden: got {span!r}, expected the least and the largest number of "
            "hidden nodes, such as [4, 25]"
        )
    positive = [("hardware.clock_mhz", hardware["clock_mhz"])]
    positive += [
        (f"training.{k}", values["training"][k]) for k in ("restarts", "steps", "patience")
    ]
    for key, value in positive:
        if not 0 < value < math.inf:
            raise ValueError(f"{path}: {key}: got {value!r}, expected above 0")
    for key in ("weight_decay", "seed"):
        value = values["training"][key]
        if not 0 <= value < math.inf:
            raise ValueError(f"{path}: training.{key}: got {value!r}, expected 0 or more")
    precision = PRECISIONS[hardware["precision"]]
    activation = hardware["activation"] or precision.activation
    place = f"{path}: hardware.activation_options"
    scheme = SCHEMES[activation].configured(hardware["activation_options"], place)
    if precision not in scheme.precisions:
        fitting = ", ".join(name for name, s in SCHEMES.items() if precision in s.precisions)
        raise ValueError(
            f"{path}: hardware.activation: got {activation!r} with precision {precision.name!r}, "
            f"expected one of {fitting}"
        )
    if data["reference"]:
        thesis_figures(data["reference"], len(data["outputs"]), path)
    return Scene(
        name=path.stem,
        path=path,
        data_path=path.parent / data["file"],
        sensors=tuple(data["sensors"]),
        outputs=tuple(data["outputs"]),
        group_by=data["group_by"],
        where={name: float(value) for name, value in data["where"].items()},
        full_scale={name: float(s) for name, s in data["full_scale"].items()},
        length_mm={name: float(s) for name, s in data["length_mm"].items()},
        reference=data["reference"],
        arrangement=network["arrangement"],
        members=members,
        form=hardware["design"],
        activation=activation,
        activation_options=hardware["activation_options"],
        precision=precision,
        clock_mhz=hardware["clock_mhz"],
        interface=hardware["interface"],
        training=Training(**(values["training"] | {"hidden": (span[0], span[1])})),
        front_end=(
            front_end(values["front_end"], hardware["design"], path)
            if "front_end" in values
            else None
        ),
        visualisation=(
            visualisation(values["visualisation"], data, hardware["design"], path)
            if "visualisation" in values
            else None
        ),
    )


def _check_interface(values: dict[str, dict[str, Any]], path: Path) -> None:
    """AXI4-Stream is built around a network whose outputs are a stream, and around nothing else."""
    design = values["hardware"]["design"]
    if values["hardware"]["interface"] != "axi_stream":
        return
    if design == "parallel":
        raise ValueError(
            f"{path}: hardware.design: got {design!r} with interface 'axi_stream', expected hybrid"
        )
    for section in ("front_end", "visualisation"):
        if section in values:
            raise ValueError(
                f"{path}: hardware.interface: got 'axi_stream' with a section [{section}], "
                "expected stream"
            )


def _members(data: dict[str, Any], network: dict[str, Any], path: Path) -> tuple[Member, ...]:
    """The networks: one for all outputs, or one for each."""
    outputs, sensors = data["outputs"], len(data["sensors"])
    single = network["arrangement"] == "single"
    groups = [outputs] if single else [[name] for name in outputs]
    count = len(groups)
    hidden, weights = (
        value if isinstance(value, list) else [value]
        for value in (network["hidden"], network["weights"])
    )
    if len(hidden) == 1:
        hidden = hidden * count
    for key, values in (("hidden", hidden), ("weights", weights)):
        if len(values) != count or (key == "weights" and len(set(values)) < count):
            one = "one for all outputs" if single else "one for each output"
            raise ValueError(
                f"{path}: network.{key}: got {network[key]!r}, expected {count}: "
                f"{network['arrangement']} has {one}"
            )
    if min(hidden) < 0:
        raise ValueError(f"{path}: network.hidden: got {network['hidden']}, expected 0 or more")
    cascade = network["arrangement"] == "cascade"
    return tuple(
        Member(sensors + i * cascade, hidden[i], tuple(groups[i]), path.parent / weights[i])
        for i in range(count)
    )

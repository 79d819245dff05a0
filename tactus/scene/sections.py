"""Checks the sections of a scene, and turns them into the objects that they describe."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from golden.activation.schemes import SCHEMES
from golden.input_error import InputError, naming, suggest
from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.numbers.precision import EXACT, PRECISIONS
from golden.trained.dense import Dense, DenseNetwork, Trained, layers_of, network_of
from golden.trained.function import Function, by_name, functions_of, read_function, table_names
from tactus.core.files import same_file
from tactus.core.schema import written
from tactus.core.table import read_table
from tactus.network_files.network_file import load_network
from tactus.scene.disturbance import Disturbance
from tactus.scene.reference import thesis_figures
from tactus.scene.scale import refuse_other_column, with_units
from tactus.scene.schema import DIGITS_TOLERANCE, FEWEST, INTERVALS
from tactus.sizing.choice import UNDECIDED


@dataclass(frozen=True)
class Training:
    """How a scene's networks are trained; see ``tactus.train``.

    ``earlier_outputs`` selects what a network of a cascade trains on: the outputs of earlier
    networks in floating point (the thesis' cascade A) or bit-true (cascade B). ``split``,
    ``split_by`` and ``block_rows`` are those of ``tactus.train.descent.split``. With ``refit`` the
    chosen network is trained further, on all rows. ``digits`` and ``digits_tolerance`` are those of
    ``tactus.train.descent.few_digits``. ``disturbance`` is the expected disturbance of the readings
    by the sensors. ``layers``, where it is not empty, and ``activation`` are those of
    ``tactus.train.layer_training``. ``functions``, where it is not empty, and ``intervals`` are
    those of ``tactus.train.spline_training``.
    """

    optimiser: str
    hidden: tuple[int, int]
    layers: tuple[int, ...]
    activation: str
    functions: str
    intervals: tuple[int, ...]
    seed: int
    restarts: int
    weight_decay: float
    steps: int
    patience: int
    earlier_outputs: str
    split: str
    split_by: tuple[str, ...]
    block_rows: int
    refit: bool
    digits: int | str
    digits_tolerance: float
    disturbance: Disturbance


@dataclass(frozen=True)
class SceneNetwork:
    """One network of a scene.

    inputs: Number of samples and, in a cascade, of the outputs of earlier networks.
    hidden: Hidden nodes of the only hidden layer. With 0 there are as many nodes, and layers, as in
        the network file, and training searches ``training.hidden``.
    layers: Hidden nodes of each layer, where there are several or a scene has classes; empty where
        there is one, or the file tells. Training for classes then takes no hidden layer.
    activations: Of each hidden layer; empty takes those of the network file.
    nearest: Whether a quantised network may be rounded to what the hardware holds.
    functions: The functions that activations may name.
    function_files: The files from which the points of some of them come.
    labels: The labels that the outputs stand for; empty if outputs are numbers.
    """

    inputs: int
    hidden: int
    outputs: tuple[str, ...]
    weights_path: Path
    layers: tuple[int, ...] = ()
    activations: tuple[str, ...] = ()
    nearest: bool = False
    functions: tuple[Function, ...] = ()
    function_files: tuple[Path, ...] = ()
    labels: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The hidden layers that the scene names, such as "32 relu, 16 relu"."""
        kinds = self.activations or ("tanh",) * len(self.layers)
        return (
            ", ".join(f"{n} {kind}" for n, kind in zip(self.layers, kinds, strict=True)) or "none"
        )

    def load(self) -> Trained:
        """The trained network."""
        hidden = self.layers or (self.hidden,)
        shape = (self.inputs, *hidden, len(self.outputs))
        network = load_network(self.weights_path, shape, by_name(self.functions), self.labels)
        found = tuple(layer.activation for layer in layers_of(network)[:-1])
        if self.activations and found != self.activations:
            raise InputError(
                f"{self.weights_path}: got hidden layers of {', '.join(found)}, expected "
                f"{', '.join(self.activations)}, as network.activations of the scene says"
            )
        if not self.nearest:
            return network
        if not (isinstance(network, DenseNetwork) and network.quantised):
            raise InputError(
                f"{self.weights_path}: got a network without quantisers, expected a quantised one, "
                "because network.quantised of the scene is 'nearest'"
            )
        return network_of([_rounded(layer) for layer in network.layers])


def _rounded(layer: Dense) -> Dense:
    """A layer that may be rounded to what hardware holds."""
    if layer.quantiser is None:
        return layer
    return replace(layer, quantiser=replace(layer.quantiser, nearest=True))


def beside(path: Path, key: str, name: str) -> Path:
    """The file that a scene names relative to its own folder, in a path without ``..``."""
    if not name or not name.isprintable():
        raise InputError(f"{path}: {key}: got {name!r}, expected the name of a file")
    return Path(os.path.normpath(path.parent / name))


def check_data(data: dict[str, Any], path: Path) -> None:
    """Refuse columns, units and a reference that are not possible."""
    both = [name for name in data["outputs"] if name in data["sensors"]]
    if both:
        raise InputError(
            f"{path}: data.outputs: got {both[0]!r}, a sensor, expected columns that data.sensors "
            "does not have"
        )
    for key, known in (("full_scale", data["outputs"]), ("length_mm", list(data["full_scale"]))):
        for name in data[key]:
            if name not in known:
                what = "output" if key == "full_scale" else "output with a full_scale"
                raise InputError(
                    f"{path}: data.{key}: {name!r} is no {what}, expected one of "
                    f"{', '.join(known)}{suggest(name, known)}"
                )
    for name, unit in data["units"].items():
        refuse_other_column("units", name, with_units(data), path)
        if not unit.isprintable():
            raise InputError(f"{path}: data.units.{name}: got {unit!r}, expected text, such as 'g'")
    if data["reference"]:
        thesis_figures(data["reference"], len(data["outputs"]), path)


def training(values: dict[str, Any], path: Path) -> Training:
    """Turn the section ``[training]`` into a ``Training``."""
    kept = {key: values[key] for key in values if key not in ("noise", "drift")}
    read = {
        "hidden": tuple(values["hidden"]),
        "layers": tuple(values.get("layers", ())),
        "intervals": tuple(values.get("intervals", INTERVALS)),
        "split_by": _split_by(values, path),
        "disturbance": Disturbance(values["noise"], **values["drift"]),
    }
    return Training(**(kept | read))


def check_search(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a search for the hidden layers of a network whose layers are fixed otherwise."""
    training, network = values["training"], values["network"]
    layers, place = training.get("layers"), f"{path}: training.layers"
    if layers is None:
        if training["activation"] != "tanh":
            raise InputError(
                f"{path}: training.activation: got {training['activation']!r} without layers, "
                "expected training.layers, or network.hidden and network.activations instead"
            )
        return
    if network["arrangement"] != "single":
        raise InputError(
            f"{place}: got {layers} with arrangement {network['arrangement']!r}, expected 'single'"
        )
    if network["hidden"] != 0:
        raise InputError(
            f"{place}: got {layers} with network.hidden {network['hidden']}, expected "
            "network.hidden 0, because training chooses the nodes of each layer"
        )
    if network["activations"]:
        raise InputError(
            f"{place}: got {layers} with network.activations {network['activations']}, expected "
            "training.activation instead, which is that of every layer"
        )


def check_functions(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse networks of learned functions in a scene that cannot train or keep them."""
    training, network = values["training"], values["network"]
    place = f"{path}: training.functions: got {training['functions']!r}"
    if not training["functions"]:
        if "intervals" in training:
            raise InputError(
                f"{path}: training.intervals: got {training['intervals']} without "
                "training.functions, expected functions = 'spline', or no such key"
            )
        return
    for key in ("layers", "digits"):
        if training.get(key):
            raise InputError(f"{place} with training.{key}, expected one of them")
    if training["optimiser"] == "scg":
        raise InputError(f"{place} with training.optimiser 'scg', expected levenberg-marquardt")
    if network["activations"]:
        raise InputError(f"{place} with network.activations, expected none: functions are learned")
    others = [name for name in _listed(network["weights"]) if not name.endswith(".npz")]
    if others:
        raise InputError(f"{place} with network.weights {others[0]!r}, expected an NPZ file")


def check_digits(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a number of signed digits that no network of the scene can have."""
    digits, tolerance = (values["training"][key] for key in ("digits", "digits_tolerance"))
    place, fewest = f"{path}: training.digits", digits == FEWEST
    if tolerance != DIGITS_TOLERANCE and not fewest:
        raise InputError(
            f"{place}_tolerance: got {tolerance!r} with digits {digits!r}, expected digits 'fewest'"
        )
    if digits == 0:
        return
    precision = values["hardware"]["precision"]
    if PRECISIONS[precision].normalise:
        raise InputError(
            f"{place}: got {digits!r} with precision {precision!r}, which gives normalised weights "
            "digits of their own, expected 'exact'"
        )
    single = values["network"]["arrangement"] == "single"
    outputs = len(values["data"]["outputs"]) if single else 1
    if not fewest and digits <= outputs:
        raise InputError(
            f"{place}: got {digits}, expected at least {outputs + 1}: one for each output of a "
            "network and one for a hidden node"
        )


def _split_by(values: dict[str, Any], path: Path) -> tuple[str, ...]:
    """The columns of ``training.split_by``."""
    names, split = values["split_by"], values["split"]
    if names and split == "random":
        raise InputError(
            f"{path}: training.split_by: got {names!r} with split 'random', expected 'blocks' or "
            "'groups'"
        )
    if split == "groups" and not names:
        raise InputError(
            f"{path}: training.split_by: got none with split 'groups', expected the columns whose "
            "values are held out together"
        )
    return tuple(names)


def check_hardware(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a combination of design, arrangement, interface and surrounding sections."""
    hardware, arrangement = values["hardware"], values["network"]["arrangement"]
    design = DESIGNS.get(hardware["design"])
    if design and arrangement not in design.arrangements:
        raise InputError(
            f"{path}: network.arrangement: got {arrangement!r} with design {design.block!r}, "
            f"expected {' or '.join(design.arrangements)}"
        )
    if design and hardware["precision"] not in design.precisions:
        raise InputError(
            f"{path}: hardware.precision: got {hardware['precision']!r} with design "
            f"{design.block!r}, expected {' or '.join(design.precisions)}"
        )
    framed = hardware["interface"] == "axi_stream"
    around: list[str] = [s for s in ("front_end", "visualisation") if s in values]
    if framed and around:
        raise InputError(
            f"{path}: hardware.interface: got 'axi_stream' with a section [{around[0]}], "
            "expected stream"
        )
    count = len(values["data"]["outputs"])
    if hardware["argmax"] and count < 2:
        raise InputError(
            f"{path}: hardware.argmax: got true for {count} output, expected false: argmax "
            "compares 2 outputs or more"
        )
    check_uart(values, path)
    unloaded = [*(["interface 'axi_stream'"] * framed), *(f"a section [{s}]" for s in around)]
    check_reload(hardware, [] if "uart" in values else unloaded, path)
    if design is None or design.stream == "serial":
        return
    reasons = {
        "front_end": "because the front end sends a stream of samples",
        "visualisation": "because the visualisation takes a stream of outputs",
        "argmax": "because argmax takes the outputs one after the other, or those of a design that "
        "has its own",
    }
    wanted = ["with interface 'axi_stream'"] if framed else []
    wanted += [f"with a section [{section}]" for section in around]
    if hardware["argmax"] and not design.decides_itself:
        around.append("argmax")
        wanted.append("with argmax")
    if wanted:
        serial = " or ".join(
            name
            for name, other in DESIGNS.items()
            if other.stream == "serial" or (other.decides_itself and around == ["argmax"])
        )
        reason = f", {reasons[around[0]]}" if around else ""
        raise InputError(
            f"{path}: hardware.design: got {design.block!r} {wanted[0]}, expected {serial}{reason}"
        )


def check_uart(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a serial line without an instrument for it, and settings that need such a line."""
    lined, drawn = "uart" in values, values.get("visualisation", {})
    if lined and not values.get("front_end", {}).get("converter"):
        raise InputError(
            f"{path}: front_end.converter: got none with a section [uart], expected a part: the "
            "line is that of an instrument with a converter of its own"
        )
    if drawn.get("analogue") and not lined:
        raise InputError(
            f"{path}: visualisation.analogue: got {drawn['analogue']!r} without a section [uart], "
            "expected one: it belongs to the same instrument"
        )


def check_reload(hardware: dict[str, Any], around: list[str], path: Path) -> None:
    """Refuse settings that cannot be combined with an engine that can be reloaded."""
    if hardware["reload"] and around:
        raise InputError(
            f"{path}: hardware.reload: got true with {around[0]}, expected false: only a "
            "section [uart] can load an engine that has something around it"
        )
    for key in ("program_words", "operand_words", "table_blocks"):
        if hardware[key] and not hardware["reload"]:
            raise InputError(
                f"{path}: hardware.{key}: got {hardware[key]} without reload, expected "
                "hardware.reload = true, or no such key"
            )


def design_options(hardware: dict[str, Any], path: Path) -> dict[str, Any]:
    """The design's own options that the scene sets."""
    # Any design may have limits to its clocks.
    limits = {"clocks", "interval"}
    known = sorted({name for other in DESIGNS.values() for name in other.options} - limits)
    if hardware["design"] == UNDECIDED:
        refuse_choices(hardware, known, path)
        return {}
    design = DESIGNS[hardware["design"]]
    for name in known:
        if hardware[name] and name not in design.options:
            fitting = " or ".join(n for n, other in DESIGNS.items() if name in other.options)
            raise InputError(
                f"{path}: hardware.{name}: got {written(hardware[name])} with design "
                f"{design.block!r}, "
                f"expected design {fitting}"
            )
    # That from frame to frame may be given as a rate; see Scene.settings.
    return {n: hardware[n] for n in design.options if hardware[n] and n != "interval"}


def refuse_choices(hardware: dict[str, Any], names: Sequence[str], path: Path) -> None:
    """Refuse options of a design where the design is to be chosen."""
    # In thesis precision the activation is part of what is asked for.
    own = ["activation", "activation_options"] if hardware["precision"] == EXACT.name else []
    for name in (*names, *own):
        if hardware[name]:
            raise InputError(
                f"{path}: hardware.{name}: got {written(hardware[name])} with design "
                f"{UNDECIDED!r}, expected none: it is chosen with the design"
            )


def check_activation(hardware: dict[str, Any], path: Path) -> str:
    """The activation's name; where the scene names none, that of the precision."""
    precision = PRECISIONS[hardware["precision"]]
    # Of the design that is to be chosen, nothing is known yet.
    design = DESIGNS.get(hardware["design"], Design)
    # A design that knows one activation has it without being asked.
    alone = len(design.known_activations) == 1 and precision.name in design.precisions
    usual = design.known_activations if alone else ()
    activation: str = hardware["activation"] or (*usual, precision.activation)[0]
    place = f"{path}: hardware.activation_options"
    scheme = SCHEMES[activation].configured(hardware["activation_options"], place)
    if precision not in scheme.precisions:
        fitting = ", ".join(name for name, s in SCHEMES.items() if precision in s.precisions)
        raise InputError(
            f"{path}: hardware.activation: got {activation!r} with precision {precision.name!r}, "
            f"expected one of {fitting}"
        )
    if design.known_activations and activation not in design.known_activations:
        raise InputError(
            f"{path}: hardware.activation: got {activation!r} with design {design.block!r}, "
            f"expected {' or '.join(design.known_activations)}"
        )
    options = hardware["activation_options"]
    if options and not design.activation_choices:
        raise InputError(
            f"{place}: got {', '.join(options)} with design {design.block!r}, expected none: its "
            f"{activation} has one form"
        )
    if scheme.half_codes and not design.half_codes:
        fitting = ", ".join(
            name
            for name, other in SCHEMES.items()
            if precision in other.precisions and not other.half_codes
        )
        raise InputError(
            f"{path}: hardware.activation: got {activation!r}, whose codes stand for the middle of "
            f"their step, with design {design.block!r}, expected one of {fitting}"
        )
    return activation


def members(
    data: dict[str, Any], network: dict[str, Any], inputs: int, path: Path
) -> tuple[SceneNetwork, ...]:
    """The networks: one for all outputs, or one for each. All of them have ``inputs`` samples."""
    outputs = data["outputs"]
    single = network["arrangement"] == "single"
    groups = [outputs] if single else [[name] for name in outputs]
    count = len(groups)
    hidden, weights = _listed(network["hidden"]), _listed(network["weights"])
    activations = tuple(network["activations"])
    files = {
        name: beside(path, f"network.functions.{name}.points", given["points"])
        for name, given in network["functions"].items()
        if isinstance(given, dict) and set(given) == {"points"}
    }
    functions = _functions(network, hidden, path, files)
    if single and network["hidden"] == [0]:
        raise InputError(
            f"{path}: network.hidden: got [0], expected 1 or more nodes in each layer, or 0 for "
            "those of the network file"
        )
    layers = _layers(hidden, activations, network["arrangement"], path)
    if data["classes"] and not layers and hidden != [0]:
        # Training for classes is that of networks whose layers the scene names.
        layers = tuple(hidden)
    if layers:
        hidden = [0]
    if layers or not isinstance(network["hidden"], list):
        hidden = hidden * count
    for key, values in (("hidden", hidden), ("weights", weights)):
        if len(values) != count:
            wanted = "one: single has one for all outputs"
            if not single:
                wanted = f"a list of {count}: {network['arrangement']} has one for each output"
            raise InputError(
                f"{path}: network.{key}: got {written(network[key])}, expected {wanted}"
            )
    weights_files = [beside(path, "network.weights", name) for name in weights]
    for i, file in enumerate(weights_files):
        for j in range(i):
            if same_file(weights_files[j], file):
                raise InputError(
                    f"{path}: network.weights: got {weights[j]!r} and {weights[i]!r}, which are "
                    "one file, expected a file for each network"
                )
    cascade = network["arrangement"] == "cascade"
    return tuple(
        SceneNetwork(
            inputs + i * cascade,
            hidden[i],
            tuple(groups[i]),
            weights_files[i],
            layers,
            activations,
            network["quantised"] == "nearest",
            functions,
            tuple(files.values()),
            data.get("labels", ()),
        )
        for i in range(count)
    )


def _listed(value: Any) -> list[Any]:
    """The value itself if it is a list, or else a list with this value."""
    return value if isinstance(value, list) else [value]


def _functions(
    network: dict[str, Any], hidden: list[int], path: Path, files: Mapping[str, Path]
) -> tuple[Function, ...]:
    """The functions that a scene defines, some of them by points in files."""
    with naming(path):
        given = network["functions"] | {name: _points(file) for name, file in files.items()}
        found = tuple(read_function(name, given[name]) for name in network["functions"])
    with naming(f"{path}: network.activations"):
        for n, activation in enumerate(network["activations"]):
            names = table_names(activation)
            # Where the network file says how many nodes there are, it is read later.
            nodes = hidden[n] if n < len(hidden) and hidden[n] else len(names)
            functions_of(activation, nodes, by_name(found))
    return found


def _points(file: Path) -> dict[str, list[float]]:
    """The points in a CSV file."""
    x, y = read_table(file, ["x", "y"]).T.tolist()
    return {"x": x, "y": y}


def _layers(
    hidden: list[int], activations: tuple[str, ...], arrangement: str, path: Path
) -> tuple[int, ...]:
    """The hidden nodes of each layer of a network of several; empty for one hidden layer."""
    single = arrangement == "single"
    if activations and not single:
        raise InputError(
            f"{path}: network.activations: got {list(activations)!r} with arrangement "
            f"{arrangement!r}, expected none: a network file names its own"
        )
    if single and len(hidden) > 1 and 0 in hidden:
        raise InputError(
            f"{path}: network.hidden: got {hidden!r}, expected 1 or more nodes in each layer, or 0 "
            "alone for those of the network file"
        )
    if activations and hidden != [0] and len(activations) != len(hidden):
        raise InputError(
            f"{path}: network.activations: got {len(activations)} for {len(hidden)} hidden layers, "
            "expected one for each"
        )
    plain = len(hidden) == 1 and activations in ((), ("tanh",))
    return () if plain or not single else tuple(hidden) * (hidden != [0])

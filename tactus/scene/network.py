"""The section ``[network]`` of a scene: the networks that it describes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from golden.input_error import InputError, naming
from golden.trained.dense import DenseNetwork, network_of
from golden.trained.function import (
    Function,
    by_name,
    functions_of,
    read_function,
    table_names,
)
from tactus.core.files import same_file
from tactus.core.schema import written
from tactus.core.table import read_table
from tactus.network_files.network_file import load_network
from tactus.scene.data import beside


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

    def load(self) -> DenseNetwork:
        hidden = self.layers or (self.hidden,)
        shape = (self.inputs, *hidden, len(self.outputs))
        network = load_network(self.weights_path, shape, by_name(self.functions), self.labels)
        found = tuple(layer.activation for layer in network.layers[:-1])
        if self.activations and found != self.activations:
            raise InputError(
                f"{self.weights_path}: got hidden layers of {', '.join(found)}, expected "
                f"{', '.join(self.activations)}, as network.activations of the scene says"
            )
        if not self.nearest:
            return network
        if not network.quantised:
            raise InputError(
                f"{self.weights_path}: got a network without quantisers, expected a quantised one, "
                "because network.quantised of the scene is 'nearest'"
            )
        layers = [
            replace(layer, quantiser=layer.quantiser and replace(layer.quantiser, nearest=True))
            for layer in network.layers
        ]
        return network_of(layers)


def members(
    data: dict[str, Any], network: dict[str, Any], inputs: int, path: Path
) -> tuple[SceneNetwork, ...]:
    """The networks: one for all outputs, or one for each. All of them have ``inputs`` samples."""
    outputs = data["outputs"]
    single = network["arrangement"] == "single"
    groups = [outputs] if single else [[name] for name in outputs]
    count = len(groups)
    hidden, weights = listed(network["hidden"]), listed(network["weights"])
    in_one = len(weights) == 1 < count and weights[0].endswith(".npz")
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
    for key, values in (("hidden", hidden), ("weights", weights * count if in_one else weights)):
        if len(values) != count:
            wanted = "one: single has one for all outputs"
            if not single:
                wanted = f"a list of {count}: {network['arrangement']} has one for each output"
                wanted = wanted if key == "hidden" else f"an NPZ file for all, or {wanted}"
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
    if in_one:
        weights_files = [Path(f"{weights_files[0]}/{name}") for name in outputs]
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


def listed(value: Any) -> list[Any]:
    """The value itself if it is a list, or else a list with this value."""
    return value if isinstance(value, list) else [value]


def _functions(
    network: dict[str, Any], hidden: list[int], path: Path, files: Mapping[str, Path]
) -> tuple[Function, ...]:
    """The functions that a scene defines, some of them by points in files."""
    with naming(path):
        points = {n: read_table(file, ["x", "y"]).T.tolist() for n, file in files.items()}
        given = network["functions"] | {n: {"x": x, "y": y} for n, (x, y) in points.items()}
        found = tuple(read_function(name, given[name]) for name in network["functions"])
    with naming(f"{path}: network.activations"):
        for n, activation in enumerate(network["activations"]):
            names = table_names(activation)
            # Where the network file says how many nodes there are, it is read later.
            nodes = hidden[n] if n < len(hidden) and hidden[n] else len(names)
            functions_of(activation, nodes, by_name(found))
    return found


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

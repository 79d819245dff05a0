"""The section ``[training]`` of a scene, and what its keys rule out elsewhere."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.numbers.precision import PRECISIONS
from tactus.network_files.parsed import file_of
from tactus.scene.disturbance import Disturbance
from tactus.scene.keys import KEYS
from tactus.scene.network import listed

FEWEST = "fewest"
# The numbers of intervals of splines that a search tries if the scene names none.
INTERVALS = [2, 4]


@dataclass(frozen=True)
class Training:
    """How a scene's networks are trained: see its keys, and ``tactus.train``.

    layers: Empty where training does not search for them.
    disturbance: ``noise`` and ``drift``.
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


def training(scene: dict[str, dict[str, Any]], path: Path) -> Training:
    check_digits(scene, path)
    check_search(scene, path)
    check_functions(scene, path)
    values = scene["training"]
    kept = {key: values[key] for key in values if key not in ("noise", "drift")}
    read = {
        "hidden": tuple(values["hidden"]),
        "layers": tuple(values.get("layers", ())),
        "intervals": tuple(values.get("intervals", INTERVALS)),
        "split_by": _split_by(values, path),
        "disturbance": Disturbance(values["noise"], **values["drift"]),
    }
    return Training(**(kept | read))


def _split_by(values: dict[str, Any], path: Path) -> tuple[str, ...]:
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
    others = [w for w in listed(network["weights"]) if file_of(Path(w)).suffix != ".npz"]
    if others:
        raise InputError(f"{place} with network.weights {others[0]!r}, expected an NPZ file")


def check_digits(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a number of signed digits that no network of the scene can have."""
    digits, tolerance = (values["training"][key] for key in ("digits", "digits_tolerance"))
    place, fewest = f"{path}: training.digits", digits == FEWEST
    if tolerance != KEYS["training"]["digits_tolerance"]["default"] and not fewest:
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

"""The section ``[training]`` of a scene, and what its keys rule out elsewhere."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.network_files.parsed import file_of
from tactus.scene.disturbance import Disturbance
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
    if split == "groups" and not names:
        raise InputError(
            f"{path}: training.split_by: got none with split 'groups', expected the columns whose "
            "values are held out together"
        )
    return tuple(names)


def check_functions(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse networks of learned functions in a scene that cannot train or keep them."""
    given = values["training"]["functions"]
    others = [w for w in listed(values["network"]["weights"]) if file_of(Path(w)).suffix != ".npz"]
    if given and others:
        raise InputError(
            f"{path}: training.functions: got {given!r} with network.weights {others[0]!r}, "
            "expected an NPZ file"
        )


def check_digits(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a number of signed digits that no network of the scene can have."""
    digits = values["training"]["digits"]
    single = values["network"]["arrangement"] == "single"
    outputs = len(values["data"]["outputs"]) if single else 1
    if digits not in (0, FEWEST) and digits <= outputs:
        raise InputError(
            f"{path}: training.digits: got {digits}, expected at least {outputs + 1}: one for each "
            "output of a network and one for a hidden node"
        )

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
    values, network = scene["training"], scene["network"]
    digits, functions = values["digits"], values["functions"]
    outputs = len(scene["data"]["outputs"]) if network["arrangement"] == "single" else 1
    if digits not in (0, FEWEST) and digits <= outputs:
        raise InputError(
            f"{path}: training.digits: got {digits}, expected at least {outputs + 1}: one for each "
            "output of a network and one for a hidden node"
        )
    others = [w for w in listed(network["weights"]) if file_of(Path(w)).suffix != ".npz"]
    if functions and others:
        raise InputError(
            f"{path}: training.functions: got {functions!r} with network.weights {others[0]!r}, "
            "expected an NPZ file"
        )
    if values["split"] == "groups" and not values["split_by"]:
        raise InputError(
            f"{path}: training.split_by: got none with split 'groups', expected the columns whose "
            "values are held out together"
        )
    kept = {key: values[key] for key in values if key not in ("noise", "drift")}
    read = {
        "hidden": tuple(values["hidden"]),
        "layers": tuple(values.get("layers", ())),
        "intervals": tuple(values.get("intervals", INTERVALS)),
        "split_by": tuple(values["split_by"]),
        "disturbance": Disturbance(values["noise"], **values["drift"]),
    }
    return Training(**(kept | read))

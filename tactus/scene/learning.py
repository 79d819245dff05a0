"""The key ``hardware.learning``: an engine that learns in the place of one that does not."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from golden.input_error import InputError
from golden.learning.corrected import Corrected
from golden.learning.gradient import constants
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.networks.network import Network
from golden.numbers.precision import SIGNAL
from tactus.core.schema import written
from tactus.scene.expected_drift import expected_drift
from tactus.scene.past import read_window

if TYPE_CHECKING:
    from tactus.scene.scene import Scene

# What an engine that learns has, for each key of [hardware] that could ask for something else.
ONLY: dict[str, tuple[object, ...]] = {
    "design": (Engine.block,),
    "interface": ("stream",),
    "argmax": (False,),
    "multiplier": ("", "dsp"),
    "pipeline": ("", "short"),
    "reload": (False,),
    "segment_width": (0,),
}


def check_learning(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse what an engine that learns does not have."""
    hardware, network, data = (values[name] for name in ("hardware", "network", "data"))
    if not hardware["learning"]:
        return
    got = f"with learning {hardware['learning']!r}"
    for key, known in ONLY.items():
        if hardware[key] not in known:
            raise InputError(
                f"{path}: hardware.{key}: got {written(hardware[key])} {got}, expected "
                f"{written(known[-1])}"
            )
    alone = network["arrangement"] == "single" and len(data["outputs"]) == 1
    if network["arrangement"] != "cascade" and not alone:
        raise InputError(
            f"{path}: network.arrangement: got {network['arrangement']!r} of "
            f"{len(data['outputs'])} outputs {got}, expected cascade, or one output"
        )
    around = [section for section in ("front_end", "visualisation") if section in values]
    if around and "uart" not in values:
        raise InputError(
            f"{path}: hardware.learning: got {hardware['learning']!r} and a section "
            f"[{around[0]}], expected [uart] too, through which the known outputs come"
        )
    past = [*["window"] * (not read_window(data, path).plain), *["classes"] * bool(data["classes"])]
    if past:
        raise InputError(
            f"{path}: data.{past[0]}: got {written(data[past[0]])} {got}, expected none"
        )


def taught_of(scene: Scene) -> tuple[Corrected, list[list[int]]]:
    """The networks of a scene behind corrected sensors, and the constants of each output."""
    taught = Corrected.of(scene.mlps(), *expected_drift(scene))
    vectors = scene.vectors()
    steps = constants(taught, vectors.codes, SIGNAL.quantise(vectors.targets)[0])
    return taught, steps.tolist()


def with_learning_engine(scene: Scene, network: Network) -> Network:
    """The engine of a scene, if the scene says so one that learns."""
    if not scene.learning:
        return network
    assert isinstance(network, Engine), "no other design is let through"
    return LearningEngine.of(network, *taught_of(scene))

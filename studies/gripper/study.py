"""How well an engine finds force and torque of a soft gripper, beside a linear fit."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from golden.numbers.fixed import Codes
from golden.numbers.real import Real
from studies.beans.study import fetched
from tactus.core.files import replace_file
from tactus.core.table import read_csv_file
from tactus.rig.predict import outputs_of, readings_of
from tactus.scene import Scene, load_scene

FOLDER = Path(__file__).parent
SCENE = FOLDER / "gripper.toml"
DATA, TEST = FOLDER / "gripper.csv", FOLDER / "gripper-test.csv"
ADDRESS = (
    "https://raw.githubusercontent.com/bionicdl-sustech/SoftRoboticTongs/"
    "1edf46b92a9aa07db8adc89a81c88f6588a0aeb2/SupplementaryFile-A-ThreeDataset/baseline/baseline_"
)
OUTPUTS = ["fx", "fy", "fz", "tx", "ty", "tz"]
COLUMNS = [f"m{marker}{axis}" for marker in range(1, 6) for axis in "xyz"] + OUTPUTS
# Of each file: the end of its address with markers and that with forces, each with its digest.
PARTS = {
    DATA: {
        "pose_train.csv": "80e38171fcf9e14dd6c0c33839a324e7f10123838c6a26c0e86bf3cc44abb56c",
        "FT_train.csv": "249bbf779d8aa1ff9cacfa77d5680c3f4b22c9c8f6dd790d155da2ce4796a0a3",
    },
    TEST: {
        "pose_test.csv": "fcfa9f0f48fecb9df2c71461d0fb1f3f2fa17e835fb8e2f0b64309d00b41cafd",
        "FT_test.csv": "74558bbc28fe933b59c4a31793996ac400dda2fbc4e32d8e8935f07f13e273ec",
    },
}


def bring() -> None:
    """Write the rows to train and to test, if they are not there."""
    for path, parts in PARTS.items():
        if not path.is_file():
            halves = [fetched(ADDRESS + end, digest) for end, digest in parts.items()]
            rows = zip(*(half.decode().splitlines() for half in halves), strict=True)
            with replace_file(path) as temporary:
                temporary.write_text("\n".join(map(",".join, [COLUMNS, *rows, []])))


def in_a_row(scene: Scene, samples: Codes) -> Codes:
    """The outputs of an adder graph for each network, where each gets what those before give."""
    graphs = replace(scene, design="adder_graph", activation="bipartite")
    seen = samples
    for network in scene.networks():
        seen = np.concatenate([seen, graphs.build(network).process(seen)], axis=1)
    return seen[:, samples.shape[1] :]


def fits(scene: Scene, x: Real, y: Real, new: Real) -> Iterator[tuple[str, int, Real]]:
    """Each fit with the rows that it saw, and what it gives for new markers."""
    ones = np.ones((len(x), 1))
    weights = np.linalg.lstsq(np.hstack([x, ones]), y, rcond=None)[0]
    yield "linear fit", len(x), np.hstack([new, ones[: len(new)]]) @ weights
    samples = scene.codes_of(new)
    codes = scene.twin().core.process(samples)
    yield "engine, bit by bit", len(x) // 2, outputs_of(scene, codes)
    yield "adder graphs, bit by bit", len(x) // 2, outputs_of(scene, in_a_row(scene, samples))


def rows() -> Iterator[dict[str, str | int | float]]:
    """The mean error of each output on the authors' rows to test, in percent of its range."""
    bring()
    scene = load_scene(str(SCENE))
    train, test = (read_csv_file(path) for path in PARTS)
    y, new_y = (np.column_stack([f.column(o).values for o in OUTPUTS]) for f in (train, test))
    for name, seen, found in fits(scene, readings_of(scene, train), y, readings_of(scene, test)):
        errors = 100 * np.abs(found - new_y).mean(axis=0) / np.ptp(y, axis=0)
        figures = {o: round(float(e), 2) for o, e in zip(OUTPUTS, errors, strict=True)}
        yield {"fit": name, "training rows": seen, **figures}

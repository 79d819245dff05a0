"""What a recalibration with a few known gases gives back of sensors that drifted for months."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from studies.beans.study import fetched
from tactus.core.files import replace_file
from tactus.recalibration.fit import fit
from tactus.recalibration.sensitivity import Placements, Sensitivity, grouped
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance

Row = dict[str, str | int | float | None]

FOLDER = Path(__file__).parent
SCENE, DATA = FOLDER / "drift.toml", FOLDER / "drift.csv"
# A copy of UCI's data set 270 with commas and names of gases in its lines.
ADDRESS = (
    "https://raw.githubusercontent.com/BrechtDewilde1/BDProject/"
    "92224f33465d8f76d82d9f3083027675f23b1c18/data/batch"
)
BATCHES = {
    1: "2ff13bf02d2156ee01d948a6d46202a6a95855709176d91728339fa510221861",
    2: "d6790e1d6344db1cdcbbfecd039b88e98897ae8ad0a5d80a1ac530101f9b0dd1",
    3: "21b8564babf75b8b27ac3e9e03537ed44bc217a066f23dba4524af6f6bac29de",
    4: "30939c81857e501ce98aab0e606e2a720a42765189bf5e577c1255dd0b844b07",
    5: "3e2e4c791d1c4afa4c2092ad55e3cd7cdcf664f9e03187ddea102ccf547f5db3",
    6: "1d9e32f5e501b0f3e33354b469dd1955ca003614309f3b1e43fb137517ca154b",
    8: "1c6b15628bce7ab0ba8601d1c49864a78d2b283b05c060344704335324131014",
    9: "8deaa13dadb0098d96f0443989baa0a6ba7243a92e5f61f9ad1349a3a0ff087a",
}
TRAINED = (1, 2)
TOUCHES, DRAWS = (4, 8, 16), 10
# What is expected of a drift, before any batch is seen: gains by a tenth, offsets by 0.2 decades.
EXPECTED = Disturbance(gain=0.1, offset=0.2)
NOISE = 0.01


def path_of(batch: int) -> Path:
    """The rows of a batch; those to train are together."""
    return DATA if batch in TRAINED else FOLDER / f"drift-{batch}.csv"


def bring() -> None:
    """Write the rows of acetone, if they are not there."""
    texts: dict[Path, str] = {}
    head = ",".join([*(f"s{n}" for n in range(1, 17)), "acetone"])
    for batch, digest in BATCHES.items():
        path = path_of(batch)
        if not path.is_file():
            text = fetched(f"{ADDRESS}{batch}.dat", digest).decode()
            texts[path] = texts.get(path, head + "\n") + converted(text)
    for path, text in texts.items():
        with replace_file(path) as temporary:
            temporary.write_text(text)


def converted(text: str) -> str:
    """The rows of acetone: how much each sensor answers, and the concentration, as logarithms.

    A row holds the gas, ppm, and eight measures of each sensor; the second is the change of
    its resistance as a part of that in air. Subtracting 0.8 brings the logarithms next to 0.
    """
    lines = []
    for gas, ppm, *measures in (line.split(",") for line in text.splitlines()):
        if gas == "Acetone":
            signals = [math.log10(float(one)) - 0.8 for one in measures[1::8]]
            lines.append(",".join(f"{v:.4f}" for v in [*signals, math.log10(float(ppm)) - 2]))
    return "\n".join([*lines, ""])


def errors(scene: Scene, signals: Real, placements: Placements) -> Real:
    """The errors of the engine, bit by bit, in percent of a decade."""
    found = SIGNAL.to_real(scene.twin().core.process(SIGNAL.quantise(signals)[0]))
    return np.asarray(100 * np.abs(found - placements.targets)[:, 0])


def rows() -> Iterator[Row]:
    """Of each later batch: the error as it is, and after a fit to some of its rows, on the others.

    The rows that are touched are drawn at random, some times; the error is the median.
    """
    bring()
    scene = load_scene(str(SCENE))
    recorded = Sensitivity.of(scene, np.full(len(scene.sensors), NOISE), EXPECTED)
    for batch in (one for one in BATCHES if one not in TRAINED):
        vectors = replace(scene, data_paths=(path_of(batch),)).vectors()
        placements, _ = grouped(vectors, None)
        before = errors(scene, placements.inputs, placements)
        levels = len(np.unique(placements.targets))
        figures: Row = {"batch": batch, "rows": len(before), "concentrations": levels}
        figures["as it is"] = round(float(before.mean()), 1)
        for touches in TOUCHES:
            figures[f"after {touches}"] = None
            if 2 * touches > len(before):
                continue
            found = []
            for draw in range(DRAWS):
                order = np.random.default_rng([batch, draw]).permutation(len(before))
                theta = fit(recorded, placements.at(order[:touches])).theta
                others = placements.at(order[touches:])
                moved = recorded.moved(others.inputs, theta)
                found.append(errors(scene, moved, others).mean())
            figures[f"after {touches}"] = round(float(np.median(found)), 1)
        yield figures

"""Which sensors a scene does not need, and how many hidden nodes suit how many sensors."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from golden.numbers.real import Real
from tactus.report.measure.table import Cell, Table
from tactus.rig.sensors_needed import (
    Effort,
    Recording,
    Removal,
    held_out,
    one_after_another,
    recording_of,
    splits_of,
    without_each,
)
from tactus.scene import Scene, load_scene
from tactus.train.descent.split import split_rows

SCENE = "digit"
SPLITS = 4
HIDDEN, STARTS = 8, 6
WORST = "worst"
EACH, IN_ORDER = "one left out", "one after another"

# Section 3.8.3 of the thesis has one network for load and position, and loads of one width. These
# are the sensors of each case, the best number of hidden nodes, and the printed error.
NODES = range(4, 26)
PRINTED = {2: (6, 0.00027), 3: (20, 0.000266), 4: (5, 0.000284)}
ONE_WIDTH = 0.225
THESIS_OUTPUTS = ("load", "position")
THESIS_STARTS, THESIS_SPLITS = 3, 3

NOTES = {
    "sensors_dropped": f"The figures are mean errors of scene {SCENE} on test rows: the mean over "
    f"{SPLITS} splits like those of the scene, with successive seeds, and the least and the "
    "largest error of a split. 'worst' is the output with the largest error. The networks are in "
    "floating point and have the sensors as their only inputs. Each output has a network of its "
    f"own with {HIDDEN} hidden nodes, the best of {STARTS} starts on the validation rows. They are "
    "trained and measured with the noise that the scene declares. In 'one after another' each step "
    "leaves out the sensor without which the worst output has the least error on the validation "
    "rows.",
    "hidden_nodes": "The figures are mean squared errors of load and position as signals from -1 "
    f"to 1: the mean, the least and the largest of {THESIS_SPLITS} random splits in 50, 25 and 25 "
    f"%, with successive seeds. The rows are the 57 rows of {SCENE} whose load is 12.7 mm wide. "
    "One network in floating point has both outputs. It is trained by scaled conjugate gradients "
    f"with early stopping, as in the thesis, and is the best of {THESIS_STARTS} starts on the "
    "validation rows. Its inputs are sensors 1 and 2, then sensor 3 too, then sensor 4 too. The "
    "last column is the least error that section 3.8.3 of the thesis prints for so many sensors, "
    "without a unit. The thesis had 76 rows; those with 13 g are not in its Appendix 2.",
}


def sensors_dropped(seed: int) -> Table:
    """The errors of scene digit without each of its sensors, and with fewer and fewer of them."""
    return dropped(load_scene(SCENE), seed)


def dropped(scene: Scene, seed: int, effort: Effort | None = None, splits: int = SPLITS) -> Table:
    """The errors of a scene without each of its sensors, and with fewer and fewer of them.

    seed: The seed of the first split. Further splits take the next seeds.
    effort: By default the disturbance of the scene, with HIDDEN nodes and STARTS.
    """
    effort = effort or Effort(HIDDEN, STARTS, disturbance=scene.training.disturbance)
    recording = recording_of(scene)
    parts = splits_of(scene, range(seed, seed + splits))
    each = without_each(recording, parts, effort, seed)
    order = one_after_another(recording, parts, effort, seed, each)
    rows: list[list[Cell]] = []
    for way, steps in ((EACH, each), (IN_ORDER, order[1:])):
        rows += [row for step in steps for row in _rows(way, step, recording)]
    return Table(
        "sensors_dropped",
        ["way", "left out", "sensors", "kept", "output", "mean %", "least %", "most %"],
        rows,
        NOTES["sensors_dropped"],
    )


def _rows(way: str, step: Removal, recording: Recording) -> list[list[Cell]]:
    means = step.errors.mean
    columns = {
        **{name: means[:, c] for c, name in enumerate(recording.outputs)},
        WORST: means.max(axis=1),
    }
    return [
        [way, step.dropped or "none", len(step.kept), " ".join(step.kept), name, *_range(found)]
        for name, found in columns.items()
    ]


def _range(found: Real) -> list[Cell]:
    return [float(found.mean()), float(found.min()), float(found.max())]


def hidden_nodes(seed: int) -> Table:
    """The errors of figure 3.13: two, three and four sensors, 4 to 25 hidden nodes."""
    return nodes(seed)


def nodes(
    seed: int,
    counts: Sequence[int] = NODES,
    starts: int = THESIS_STARTS,
    splits: int = THESIS_SPLITS,
) -> Table:
    """The mean squared errors for each number of hidden nodes, beside the least of the thesis.

    seed: The seed of the first split. Further splits take the next seeds.
    counts: The numbers of hidden nodes.
    """
    recording = _thesis_recording()
    parts = [split_rows(len(recording.readings), s) for s in range(seed, seed + splits)]
    rows: list[list[Cell]] = []
    for sensors, (best, printed) in PRINTED.items():
        for hidden in counts:
            effort = Effort(hidden, starts, together=True, optimiser="scg")
            found = held_out(recording, parts, recording.names[:sensors], effort, seed)
            cells = [*_range(_squares(found.validation)), *_range(_squares(found.rms))]
            rows.append([sensors, hidden, *cells, printed if hidden == best else None])
    ends = [f"{part} {end}" for part in ("validation", "test") for end in ("mean", "least", "most")]
    return Table(
        "hidden_nodes",
        ["sensors", "hidden", *ends, "thesis"],
        rows,
        NOTES["hidden_nodes"],
    )


def _squares(rms: Real) -> Real:
    """The mean squared errors of each split, from rms errors in percent."""
    squares: Real = ((rms / 100) ** 2).mean(axis=1)
    return squares


def _thesis_recording() -> Recording:
    """The rows of one width, with errors that are not divided by targets."""
    scene = load_scene(SCENE)
    whole = recording_of(scene)
    rows = np.flatnonzero(whole.targets[:, whole.outputs.index("width")] == ONE_WIDTH)
    columns = [whole.outputs.index(name) for name in THESIS_OUTPUTS]
    targets = whole.targets[rows][:, columns]
    return replace(
        whole,
        readings=whole.readings[rows],
        targets=targets,
        scale=np.ones_like(targets),
        outputs=THESIS_OUTPUTS,
    )

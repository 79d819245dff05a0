"""The digit with four, three and two sensors, trained as its shipped networks are."""

from dataclasses import replace

import numpy as np
from joblib import Parallel, delayed

from golden.numbers.real import Real
from golden.trained.window import Window
from tactus.report.measure.table import Cell, Table
from tactus.scene import load_scene
from tactus.train.descent.search import candidates, measure, signed_errors
from tactus.train.descent.stages import Stages

SCENE = "digit"
# All sensors, and those that are left when table `sensors_dropped` leaves out one after another.
SETS = (
    ("sensor1", "sensor2", "sensor3", "sensor4"),
    ("sensor1", "sensor2", "sensor4"),
    ("sensor1", "sensor2"),
)
SPLITS, RESTARTS = 4, 6
WORST = "worst"

NOTES = {
    "sensors_shipped": f"The figures are mean bit-true errors of networks like those of {SCENE} on "
    f"test rows: the mean over {SPLITS} splits like those of the scene, with successive seeds, and "
    "the least and the largest error of a split. They are trained as those that are shipped: in "
    "cascade, with the numbers of hidden nodes and the noise of the scene, and further on the rows "
    f"that chose them. Each is the best of {RESTARTS} starts for each number of hidden nodes; "
    "the shipped ones had 60 starts. 'worst' is the output with the largest error of a split.",
}


def sensors_shipped(seed: int) -> Table:
    """The held-out errors of scene digit with fewer and fewer sensors."""
    return kept(seed)


def kept(seed: int, splits: int = SPLITS, restarts: int = RESTARTS) -> Table:
    """The held-out errors for each set of sensors.

    seed: The seed of the first split. Further splits take the next seeds.
    """
    jobs = [
        delayed(_held_out)(sensors, seed + n, restarts) for sensors in SETS for n in range(splits)
    ]
    found = np.array(Parallel(n_jobs=-1)(jobs)).reshape(len(SETS), splits, -1)
    outputs = [*load_scene(SCENE).outputs, WORST]
    rows: list[list[Cell]] = []
    for sensors, errors in zip(SETS, found, strict=True):
        every = np.column_stack([errors, errors.max(axis=1)])
        for name, column in zip(outputs, every.T, strict=True):
            ends = [float(end) for end in (column.mean(), column.min(), column.max())]
            rows.append([" ".join(sensors), name, *ends])
    columns = ["kept", "output", "mean %", "least %", "most %"]
    return Table("sensors_shipped", columns, rows, NOTES["sensors_shipped"])


def _held_out(sensors: tuple[str, ...], seed: int, restarts: int) -> Real:
    """The mean error of each output on the test rows of one split."""
    scene = load_scene(SCENE)
    fewer = len(scene.sensors) - len(sensors)
    scene = replace(
        scene,
        sensors=sensors,
        members=tuple(replace(one, inputs=one.inputs - fewer) for one in scene.members),
        window=Window(((0,),) * len(sensors)),
        training=replace(scene.training, seed=seed, restarts=restarts),
    )
    stages = Stages(scene)
    errors = []
    for number in range(len(scene.members)):
        task = stages.task(stages.chosen, number)
        found = [measure(task, hidden, restart) for hidden, restart in candidates(task)]
        best = min(found, key=lambda result: result.rank)
        stages.add(best.hidden, best.restart)
        task = stages.task(stages.tested, number)
        errors.append(np.abs(signed_errors(task, stages.tested[number], task.test)).mean())
    return np.array(errors)

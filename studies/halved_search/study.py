"""What a training loses that compares its candidates on part of the rows first."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

from studies.gripper import study as gripper
from tactus.cli.train import choose, compared, tried
from tactus.report.measure.table import Cell
from tactus.scene import load_scene
from tactus.train.search import Stages
from tactus.train.split import scaled

# All candidates would take nearly twice as long, and no smaller network was the best of any output.
LEAST_NODES = 8


def rows() -> Iterator[dict[str, Cell]]:
    """The best candidate of each output, of all of the scene that go on with more and more rows,
    and of the large ones that are each trained on all rows: root mean squares in percent."""
    gripper.bring()
    scene = scaled(load_scene(str(gripper.SCENE)))
    stages = Stages(scene)
    with tempfile.TemporaryDirectory() as folder:
        for number, output in enumerate(gripper.OUTPUTS):
            task = stages.task(stages.chosen, number)
            large = [one for one in tried(task) if one[0][0] >= LEAST_NODES]
            halved, _ = choose(task, Path(folder) / f"{number}.jsonl", -1)
            every = compared(task, large, Path(folder) / f"{number}-every.jsonl", -1, 0)
            best = min(every, key=lambda one: one.rank)
            yield {
                "output": output,
                "halved": len(tried(task)),
                "choosing": round(halved.validation, 3),
                "held out": round(halved.test, 3),
                "on all rows": len(large),
                "choosing then": round(best.validation, 3),
                "held out then": round(best.test, 3),
            }
            stages.add(*halved.candidate)

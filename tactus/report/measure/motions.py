"""The errors of the networks of the swing on runs on which they were not trained."""

import tomllib

from golden.numbers.precision import SIGNAL
from tactus.core.fingerprint import ROOT
from tactus.physics.swing_data import ANGLES, independent_run
from tactus.report.measure.table import Row, Table
from tactus.scene import Scene, load_scene, thesis_table
from tactus.scene.metrics import displacement_errors
from tactus.scene.reading import scene_path

DATA = ROOT / "scenes" / "data"
FORMS = ("single", "multiple", "cascade")
SCENES = (
    # As the thesis built them, and ours.
    *(f"comparison/swing-{form}-thesis" for form in FORMS),
    "swing-single",
    "swing-multiple",
    "swing-cascade",
    "swing-window",
    "swing-window-cascade",
)
# The last two runs were made after the networks were chosen.
RUNS = tuple(f"swing-test-{n}" for n in range(1, len(ANGLES)))


def shipped(scene: Scene) -> bool:
    """Whether the table contains the scene."""
    return scene.path in map(scene_path, SCENES)


def motions(seed: int) -> Table:
    """Equation 6.6 for each output, with the networks as trained."""
    printed = thesis_table("swing")
    millimetres = tomllib.loads((DATA / "swing.toml").read_text(encoding="utf-8"))["mm_per_unit"]
    rows: list[Row] = []
    for scene in map(load_scene, SCENES):
        design, window = scene.twin().core, scene.window
        for number, run in enumerate(RUNS, 1):
            inputs = window.frames(independent_run(number, scene.sensors))
            actual = independent_run(number, scene.outputs)[window.past :]
            codes, _ = SIGNAL.quantise(inputs, run)
            exact = displacement_errors(SIGNAL.to_real(design.process(codes)), actual)
            real = displacement_errors(scene.process_real(inputs), actual)
            for c, name in enumerate(scene.outputs):
                place = "xyz".index(name)
                rows.append(
                    {
                        "scene": scene.name,
                        "networks": scene.describe(),
                        "run": run,
                        "output": name,
                        "float %": real[c].percent,
                        "bit-true %": exact[c].percent,
                        "bit-true mm": exact[c].mean * millimetres[place],
                        "end to end mm": exact[c].displacement * millimetres[place],
                        "printed %": printed[scene.arrangement]["percent_error"][place],
                    }
                )
    return Table.of(
        "motions",
        rows,
        "The figures are errors by equation 6.6 on independent runs, which were released from "
        "other angles and have noise and a wobble of their own (docs/physics.md). They are divided "
        "by the mean distance from end to end. The printed column is Table 6.2 for the same "
        "arrangement, measured on another rig. Networks with past samples give no outputs before "
        "their past is complete, 0.64 s after the release.",
    )

"""The errors of the shipped networks, and of those that are kept for comparison."""

from tactus.errors.scene_errors import HELD_OUT, held_out_means, scene_errors
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, comparison_names, load_scene, scene_names, thesis_figures
from tactus.scene.metrics import millimetres


def scenes() -> list[Scene]:
    """The shipped scenes, then those for comparison."""
    return [load_scene(name) for name in [*scene_names(), *comparison_names()]]


def networks(seed: int) -> Table:
    """The errors of every output of every scene, with the networks as they were trained."""
    rows: list[list[Cell]] = []
    for scene in scenes():
        if scene.classes:
            # What decides among classes has no errors of outputs.
            continue
        found, means = scene_errors(scene), held_out_means(scene)
        figures: list[float] | list[None] = [None] * len(scene.outputs)
        if scene.reference:
            figures = thesis_figures(scene.reference, len(scene.outputs), scene.path)
        for c, output in enumerate(scene.outputs):
            real, exact = found["float"][c], found["bit-true"][c]
            held = found[HELD_OUT][c] if HELD_OUT in found else None
            length = scene.length_mm.get(output)
            rows.append(
                [
                    scene.name,
                    scene.describe(),
                    output,
                    real.largest_mean,
                    exact.largest_mean,
                    exact.mean,
                    exact.worst,
                    None if means is None else means[c],
                    None if held is None else held.largest_mean,
                    None if length is None else millimetres(exact, length).largest_mean,
                    figures[c],
                ]
            )
    return Table(
        "networks",
        [
            "scene",
            "networks",
            "output",
            "float largest %",
            "bit-true largest %",
            "bit-true mean %",
            "bit-true worst %",
            "held-out mean %",
            "held-out largest %",
            "bit-true largest mm",
            "thesis largest %",
        ],
        rows,
        "The figures are errors by equations 3.15 and 3.16 on the recorded vectors. 'Largest' is "
        "the largest mean over the positions. Held-out rows neither trained nor chose the network. "
        "There are about two of them at a position, so their largest mean is nearly that of single "
        "frames. In digit-a and digit-thesis-a each network is trained on the floating-point "
        "outputs of the networks before it (cascade A), in digit and digit-thesis on the bit-true "
        "ones (cascade B). The column of the thesis is its bit-true simulation.",
    )

"""The 2:6:2 network with each activation of the thesis (section 5.2.2)."""

from tactus.errors.scene_errors import HELD_OUT, scene_errors
from tactus.report.measure.networks import scenes
from tactus.report.measure.table import Cell, Table
from tactus.scene import thesis_figures

# The tables of scenes/data/thesis_numbers.toml with the printed figures, by activation.
PRINTED = "parallel_2_6_2."


def parallel(_: int) -> Table:
    """The errors of the networks in parallel form, beside those of Figure 5.3."""
    rows: list[list[Cell]] = []
    for scene in scenes():
        if not scene.reference.startswith(PRINTED):
            continue
        printed = thesis_figures(scene.reference, len(scene.outputs), scene.path)
        found = scene_errors(scene)
        for c, output in enumerate(scene.outputs):
            real, exact = found["float"][c], found["bit-true"][c]
            held = found[HELD_OUT][c] if HELD_OUT in found else None
            rows.append(
                [
                    scene.activation_text,
                    output,
                    real.largest_mean,
                    exact.largest_mean,
                    printed[c],
                    exact.mean,
                    exact.worst,
                    None if held is None else held.mean,
                ]
            )
    return Table(
        "parallel",
        [
            "activation",
            "output",
            "float largest %",
            "bit-true largest %",
            "printed largest %",
            "bit-true mean %",
            "bit-true worst %",
            "held-out mean %",
        ],
        rows,
        "For each activation one network 2:6:2 was trained for it, with 40 starts. Its inputs are "
        "sensors 1 and 2, its outputs are load and position, and its rows are the 57 rows of the "
        "narrow loads E, F and G. 'Largest' is the largest mean over the positions (equation "
        "3.15), with three rows at each. 'bit-true' is in thesis precision; 'float' is the same "
        "network with the same activation in real arithmetic. The output biases are shifted to "
        "suit the truncating adders, so the error in real arithmetic can be the larger one. The "
        "thesis measured on four loads, of which its Appendix 2 has three.",
    )

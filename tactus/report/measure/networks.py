"""The errors of the shipped networks and of those for comparison; their clocks."""

from golden.networks.network import Network
from tactus.errors import HELD_OUT, held_out_means, scene_errors
from tactus.report.measure.table import Row, Table
from tactus.scene import Scene, comparison_names, load_scene, scene_names, thesis_figures
from tactus.scene.metrics import millimetres
from tactus.synth.budget import is_recorded, read_budget

FAMILY = "xc2v"
COST = ("LUT", "multiplier", "block RAM")


def clocks_per_frame(design: Network) -> int:
    """The clocks from the first sample of a frame, which counts too, to its last output.

    One element of a frame comes in each clock; for a parallel network all come at once. The frame
    of an instrument begins with its scan.
    """
    return design.frame_clocks + design.output_clocks[-1]


def clocks(_: int) -> Table:
    """Every shipped scene and those for comparison, with the networks as they were trained."""
    rows: list[Row] = []
    for scene in scenes():
        design = scene.twin()
        found = scene_errors(scene)["bit-true"]
        worst = max(range(len(found)), key=lambda c: found[c].largest_mean)
        held_out = held_out_means(scene)
        hidden = [network.shape[1:-1] for network in scene.networks()]
        cells = read_budget(scene.path)[FAMILY][design.entity] if is_recorded(scene.path) else {}
        rows.append(
            {
                "scene": scene.name,
                "data": ", ".join(path.stem for path in scene.data_paths),
                "arrangement": scene.arrangement,
                "design": scene.design,
                "activation": scene.activation_text,
                "precision": scene.precision.name,
                "hidden": " ".join(":".join(map(str, nodes)) for nodes in hidden),
                "hidden nodes": sum(map(sum, hidden)),
                "outputs": len(scene.outputs),
                "worst output": scene.outputs[worst],
                "largest %": found[worst].largest_mean,
                "mean %": found[worst].mean,
                "held out %": max(held_out) if held_out else None,
                "clocks a frame": clocks_per_frame(design),
                "clocks after the last sample": design.output_clocks[-1],
                "interval clocks": design.interval,
                **{kind: cells.get(kind) for kind in COST},
            }
        )
    return Table.of(
        "clocks",
        rows,
        "For each scene, the table shows the output with the largest bit-true error on all "
        "recorded vectors: the largest mean over the positions (equation 3.15) and the mean. "
        "Errors on appendix2 are in percent of the target, or of 0.9 for position and width. "
        "Errors on swing-train are in percent of 1.4, the range from end to end, and have no "
        "positions, so the two cannot be compared. 'Held out' is the largest mean error of an "
        "output, on rows that no training had seen. The clocks are those from the first sample and "
        "from the last one to the last output, and from one frame to the next. thesis and "
        "digit-instrument wait for their sensors. The cells are those of Virtex-II, entity by "
        "entity, as make synth recorded them.",
    )


# The tables of scenes/data/thesis_numbers.toml with the printed figures, by activation.
PRINTED = "parallel_2_6_2."


def parallel(_: int) -> Table:
    """The errors of the networks in parallel form, beside those of Figure 5.3."""
    rows: list[Row] = []
    for scene in scenes():
        if not scene.reference.startswith(PRINTED):
            continue
        printed = thesis_figures(scene.reference, len(scene.outputs), scene.path)
        found = scene_errors(scene)
        for c, output in enumerate(scene.outputs):
            real, exact = found["float"][c], found["bit-true"][c]
            held = found[HELD_OUT][c] if HELD_OUT in found else None
            rows.append(
                {
                    "activation": scene.activation_text,
                    "output": output,
                    "float largest %": real.largest_mean,
                    "bit-true largest %": exact.largest_mean,
                    "printed largest %": printed[c],
                    "bit-true mean %": exact.mean,
                    "bit-true worst %": exact.worst,
                    "held-out mean %": None if held is None else held.mean,
                }
            )
    return Table.of(
        "parallel",
        rows,
        "For each activation one network 2:6:2 was trained for it, with 40 starts. Its inputs are "
        "sensors 1 and 2, its outputs are load and position, and its rows are the 57 rows of the "
        "narrow loads E, F and G. 'Largest' is the largest mean over the positions (equation "
        "3.15), with three rows at each. 'bit-true' is in thesis precision; 'float' is the same "
        "network with the same activation in real arithmetic. The output biases are shifted to "
        "suit the truncating adders, so the error in real arithmetic can be the larger one. The "
        "thesis measured on four loads, of which its Appendix 2 has three.",
    )


def scenes() -> list[Scene]:
    """The shipped scenes, then those for comparison."""
    return [load_scene(name) for name in [*scene_names(), *comparison_names()]]


def networks(seed: int) -> Table:
    """The errors of every output of every scene, with the networks as they were trained."""
    rows: list[Row] = []
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
                {
                    "scene": scene.name,
                    "networks": scene.describe(),
                    "output": output,
                    "float largest %": real.largest_mean,
                    "bit-true largest %": exact.largest_mean,
                    "bit-true mean %": exact.mean,
                    "bit-true worst %": exact.worst,
                    "held-out mean %": None if means is None else means[c],
                    "held-out largest %": None if held is None else held.largest_mean,
                    "bit-true largest mm": None
                    if length is None
                    else millimetres(exact, length).largest_mean,
                    "thesis largest %": figures[c],
                }
            )
    return Table.of(
        "networks",
        rows,
        "The figures are errors by equations 3.15 and 3.16 on the recorded vectors. 'Largest' is "
        "the largest mean over the positions. Held-out rows neither trained nor chose the network. "
        "There are about two of them at a position, so their largest mean is nearly that of single "
        "frames. In digit-a and digit-thesis-a each network is trained on the floating-point "
        "outputs of the networks before it (cascade A), in digit and digit-thesis on the bit-true "
        "ones (cascade B). The column of the thesis is its bit-true simulation.",
    )

"""The errors of networks against the clocks that a frame takes."""

from golden.networks.network import Network
from tactus.errors.scene_errors import held_out_means, scene_errors
from tactus.report.measure.networks import scenes
from tactus.report.measure.table import Cell, Table


def clocks_per_frame(design: Network) -> int:
    """The clocks from the first sample of a frame, which counts too, to its last output.

    One element of a frame comes in each clock; for a parallel network all come at once. The frame
    of an instrument begins with its scan.
    """
    return design.frame_clocks + design.output_clocks[-1]


def clocks(_: int) -> Table:
    """Every shipped scene and those for comparison, with the networks as they were trained."""
    rows: list[list[Cell]] = []
    for scene in scenes():
        design = scene.twin()
        found = scene_errors(scene)["bit-true"]
        worst = max(range(len(found)), key=lambda c: found[c].largest_mean)
        held_out = held_out_means(scene)
        hidden = [network.shape[1:-1] for network in scene.networks()]
        rows.append(
            [
                scene.name,
                ", ".join(path.stem for path in scene.data_paths),
                scene.arrangement,
                scene.design,
                scene.activation_text,
                scene.precision.name,
                " ".join(":".join(map(str, nodes)) for nodes in hidden),
                sum(map(sum, hidden)),
                len(scene.outputs),
                scene.outputs[worst],
                found[worst].largest_mean,
                found[worst].mean,
                max(held_out) if held_out else None,
                clocks_per_frame(design),
                design.output_clocks[-1],
                design.interval,
            ]
        )
    return Table(
        "clocks",
        [
            "scene",
            "data",
            "arrangement",
            "design",
            "activation",
            "precision",
            "hidden",
            "hidden nodes",
            "outputs",
            "worst output",
            "largest %",
            "mean %",
            "held out %",
            "clocks a frame",
            "clocks after the last sample",
            "interval clocks",
        ],
        rows,
        "For each scene, the table shows the output with the largest bit-true error on all "
        "recorded vectors: the largest mean over the positions (equation 3.15) and the mean. "
        "Errors on appendix2 are in percent of the target, or of 0.9 for position and width. "
        "Errors on swing-train are in percent of 1.4, the range from end to end, and have no "
        "positions, so the two cannot be compared. 'Held out' is the largest mean error of an "
        "output, on rows that no training had seen. The clocks are those from the first sample and "
        "from the last one to the last output, and from one frame to the next. thesis and "
        "digit-instrument wait for their sensors.",
    )

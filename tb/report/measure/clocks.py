"""Errors of networks against the clocks that they take for a frame."""

from __future__ import annotations

from golden.networks.network import Network
from golden.scene_errors import scene_errors
from tb.report.measure.networks import scenes
from tb.report.measure.table import Cell, Table


def clocks_per_frame(design: Network) -> int:
    """Clocks from a frame's first sample, that clock included, to its last output.

    The elements of a frame come in one a clock, those of a parallel network all at once. An
    instrument's frame begins with its scan.
    """
    return design.frame_clocks + design.output_clocks[-1]


def clocks(_: int) -> Table:
    """Every shipped scene and those for comparison; the seeds are those of their training."""
    rows: list[list[Cell]] = []
    for scene in scenes():
        design = scene.twin()
        found = scene_errors(scene)["bit-true"]
        worst = max(range(len(found)), key=lambda c: found[c].largest_mean)
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
                clocks_per_frame(design),
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
            "clocks a frame",
            "interval clocks",
        ],
        rows,
        "The output with the largest error of each scene, bit-true, on all of its recorded "
        "vectors: the largest mean over the positions (equation 3.15) and the mean. Those of "
        "appendix2 are percent of the target, or of 0.9 for position and width; those of "
        "swing-train percent of 1.4, from end to end, without positions, so the two do not "
        "compare. Clocks from the first sample to the last output, and from one frame to the "
        "next; thesis and digit-instrument wait for their sensors.",
    )

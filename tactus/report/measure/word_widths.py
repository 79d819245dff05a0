"""``python -m tactus.report.measure.word_widths``: what few digits and short words save and cost.

For networks for classes as an ``adder_graph`` it counts the bits of all adders, and the decisions
on recorded rows, for some widths of the words from layer to layer. Beside each shipped scene stands
the scene of an engine whose network has the same shape, and all its digits. Its graph takes long to
find, so the figures are recorded. Table ``word_widths`` of ``make figures`` shows the record.

    python -m tactus.report.measure.word_widths --record
"""

from dataclasses import replace
from pathlib import Path

from golden.networks.adder_graph import AdderGraph
from golden.networks.matrix_network import WORD_WIDTH
from tactus.errors.decisions import decisions_of, held_out_or_all
from tactus.export.repeatable import run_repeatable
from tactus.report.measure.table import Cell, Table, print_or_record, read_csv
from tactus.scene import Scene, load_scene
from tactus.synth.budget import budget_path, read_budget
from tactus.train.descent.few_digits import count_digits

# Each scene without a multiplier, after the one with the same shape and all digits.
SCENES = {"classes/wine-fast": "classes/wine", "classes/digits-fast": "classes/digits"}
WIDTHS = (WORD_WIDTH, 12, 10, 8, 6)
RECORD = Path(__file__).with_suffix(".csv")
KEY = "word_width"
COLUMNS = [
    *("scene", "network", "digits", "bits of a word", "bits of adders", "LUT4", "LUT6"),
    *("rows held out", "wrong of them", "rows", "decided differently"),
]
NOTE = (
    "Digits are the signed digits of all weights together. Bits of adders are those of all "
    "matrices. LUT4 and LUT6 are those of the whole scene with argmax on Virtex-II and Series 7, "
    "as make synth recorded them. Decided differently are all recorded rows whose class is not "
    "that of floating point. The figures were recorded by "
    "python -m tactus.report.measure.word_widths."
)


def of_width(scene: Scene, width: int) -> Scene:
    """The scene with words of so many bits, as a graph of adders whatever its own design is."""
    options = scene.design_options if scene.design == AdderGraph.block else {}
    (activation,) = AdderGraph.known_activations
    return replace(
        scene,
        design=AdderGraph.block,
        activation=activation,
        activation_options={},
        design_options={**options, KEY: width},
    )


def row(name: str, width: int) -> list[Cell]:
    """The row of a shipped scene with words of some width."""
    shipped = load_scene(name)
    scene = of_width(shipped, width)
    design = scene.twin()
    assert isinstance(design, AdderGraph)
    (network,) = scene.networks()
    every = decisions_of(scene)
    held_out, _ = held_out_or_all(scene, every)
    luts: list[Cell] = [None, None]
    if shipped.design == AdderGraph.block and shipped.design_options.get(KEY) == width:
        cells = read_budget(budget_path(shipped.path))
        luts = [cells[family][design.entity]["LUT"] for family in ("xc2v", "xc7")]
    return [
        name,
        ":".join(map(str, network.shape)),
        count_digits(network, scene.precision.coeff_width),
        width,
        sum(matrix.graph.adder_bits for matrix in design.layers),
        *luts,
        len(held_out.actual),
        len(held_out.actual) - held_out.right,
        len(every.actual),
        every.differ,
    ]


def pairs() -> list[tuple[str, int]]:
    """The scene and the width of each row."""
    found: list[tuple[str, int]] = []
    for few, whole in SCENES.items():
        found += [(whole, WORD_WIDTH), *((few, width) for width in WIDTHS)]
    return found


def measured() -> list[list[Cell]]:
    """The rows of the table."""
    return [row(name, width) for name, width in pairs()]


def word_widths(_seed: int) -> Table:
    """The recorded table."""
    return Table("word_widths", *read_csv(RECORD), NOTE)


def main() -> None:
    print_or_record(
        "python -m tactus.report.measure.word_widths",
        __doc__,
        RECORD,
        lambda: Table("word_widths", COLUMNS, measured(), NOTE),
    )


if __name__ == "__main__":
    run_repeatable("tactus.report.measure.word_widths", main)

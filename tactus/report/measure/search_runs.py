"""``python -m tactus.report.measure.search_runs``: bits of adders against the runs of a search.

For the matrices of an ``adder_graph`` it counts the bits of all adders of the graph that so many
runs of the search find, and the processor's time that they take. That is long, so the figures are
recorded. Table ``search_runs`` of ``make figures`` shows the record.

    python -m tactus.report.measure.search_runs --record
"""

from pathlib import Path
from time import process_time

from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.sharing import shared
from golden.networks.adder_graph import AdderGraph
from tactus.export.repeatable import run_repeatable
from tactus.report.measure.table import Cell, Table, print_or_record, read_csv
from tactus.scene import load_scene

# For each scene the numbers of runs, of which 0 stands for those of a scene that does not set them.
SCENES = {"digit-fast": (0, 100, 300, 1000)}
RECORD = Path(__file__).with_suffix(".csv")
COLUMNS = ["scene", "matrix", "runs", "bits of adders", "CPU s"]
NOTE = (
    "Runs is search_runs; 0 stands for a scene that does not set it. The times are those of the "
    "machine that recorded the figures with python -m tactus.report.measure.search_runs, which may "
    "have had other work."
)


def matrices(name: str) -> list[ConstantMatrix]:
    """The matrices of a scene."""
    design = load_scene(name).twin()
    assert isinstance(design, AdderGraph)
    return list(design.layers)


def row(name: str, matrix: ConstantMatrix, runs: int) -> list[Cell]:
    """The row of a matrix for so many runs, which are made and not taken from the store."""
    shared.cache_clear()
    start = process_time()
    graph = shared(
        matrix.wanted, matrix.adders_per_clock, matrix.finish_levels, matrix.adder_operands, runs
    )
    seconds = process_time() - start
    return [name, matrix.variant, runs, graph.adder_bits, round(seconds, 1)]


def measured() -> list[list[Cell]]:
    """The rows of the table."""
    return [
        row(name, matrix, runs)
        for name, numbers in SCENES.items()
        for matrix in matrices(name)
        for runs in numbers
    ]


def search_runs(_seed: int) -> Table:
    """The recorded table.

    No column is timed: its times are recorded, and a report does not measure them.
    """
    return Table("search_runs", *read_csv(RECORD), NOTE)


def main() -> None:
    print_or_record(
        "python -m tactus.report.measure.search_runs",
        __doc__,
        RECORD,
        lambda: Table("search_runs", COLUMNS, measured(), NOTE),
    )


if __name__ == "__main__":
    run_repeatable("tactus.report.measure.search_runs", main)

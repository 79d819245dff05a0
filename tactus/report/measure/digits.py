"""``python -m tactus.report.measure.digits``: what fewer signed digits cost in error and save in
cells.

The network of scene ``digit-single`` gets fewer and fewer digits. Measured are its error on
held-out rows, and the cells of the written network in every design that can build it. The figures
are recorded, because all of them take an hour of processor time. Table ``digits`` of ``make
figures`` shows the record.

    python -m tactus.report.measure.digits --record
    python -m tactus.report.measure.digits 245 230 --record

The second command measures two counts and leaves the others as they were recorded.
"""

import argparse
import tempfile
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np

from golden.numbers.real import Real
from golden.trained.dense import Trained
from tactus.core.cli import stop_if_dry_run
from tactus.core.files import replace_file
from tactus.export.repeatable import run_repeatable
from tactus.network_files.network_file import provenance_path, save_network
from tactus.report.measure.table import Cell, Table, read_csv
from tactus.scene import Scene, load_scene
from tactus.synth.activations import cells
from tactus.train.descent.few_digits import FewDigits, count_digits
from tactus.train.descent.search import signed_errors
from tactus.train.descent.stages import Stages

SCENE = "digit-single"
RECORD = Path(__file__).with_suffix(".csv")
FAMILY = "xc2v"
# Each design with its activation.
FORMS = {
    "engine": "precise",
    "hybrid": "precise",
    "parallel": "precise",
    "adder_graph": "bipartite",
}
# The numbers of digits that are asked for. 0 leaves the network as it was trained.
COUNTS = (0, 400, 320, 280, 260, 245, 230, 215, 200)
# Folded designs hold weights as words, which do not depend on the digits, so two counts suffice.
FOLDED, FOLDED_COUNTS = ("engine", "hybrid"), (0, 245)
NOTE = (
    "The table shows the network 4:16:4 of digit-single with fewer and fewer signed digits in its "
    "weights; the first row is the network as it was trained. The errors are on held-out rows, "
    "divided by those with all digits. They are means over the networks from each start, and "
    "'deviation' is the standard deviation over these and over all outputs. The cells are those of "
    "a Virtex-II (synth_xilinx -family xc2v) for the network that is written. The figures were "
    "recorded by python -m tactus.report.measure.digits."
)


def columns(scene: Scene) -> list[str]:
    """The headings, with their units."""
    designs = [f"{name} LUT" for name in FORMS]
    return ["asked", "digits", *scene.outputs, "deviation", *designs, "parallel multiplier"]


def measured(scene: Scene, stages: Stages, count: int) -> list[Cell]:
    """The row for ``count`` digits, or for the network as it was trained if it is 0."""
    chosen, tested, written = (m[0] for m in (stages.chosen, stages.tested, stages.written))
    mean, deviation = np.ones(len(scene.outputs)), 0.0
    kept: Trained = written
    if count:
        task = stages.task([], 0)
        few = FewDigits(task, chosen)
        split = task.split
        known = np.concatenate([split.training, split.validation])
        ratios = np.array(
            [
                _errors(stages, network) / _errors(stages, tested)
                for network in few.on_more_rows(task, tested, task.known, known, count)
            ]
        )
        mean, deviation = ratios.mean(axis=0), float(ratios.std(axis=0).mean())
        rows = np.arange(len(task.recorded.codes))
        kept = few.on_more_rows(task, written, task.every, rows, count)[0]
    found = {
        name: cells_of(scene, name, kept)
        for name in FORMS
        if name not in FOLDED or count in FOLDED_COUNTS
    }
    return [
        count,
        count_digits(kept, scene.precision.coeff_width),
        *(round(float(value), 3) for value in mean),
        round(deviation, 3),
        *(found[name]["LUT"] if name in found else None for name in FORMS),
        found["parallel"]["multiplier"],
    ]


def _errors(stages: Stages, network: Trained) -> Real:
    """The mean error of each output on the test rows, as recorded."""
    task = stages.task([], 0)
    rows = task.recorded.take(task.split.test)
    errors: Real = np.abs(signed_errors(task, network, rows)).mean(axis=0)
    return errors


def cells_of(scene: Scene, design: str, network: Trained) -> dict[str, int]:
    """The cells of a network in one design."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "few.npz"
        save_network(path, network, {})
        (member,) = scene.members
        built = replace(
            scene,
            design=design,
            activation=FORMS[design],
            members=(replace(member, weights_path=path),),
        )
        return cells(built.twin(), FAMILY)


def digits(_seed: int) -> Table:
    """The recorded table."""
    return Table("digits", *read_csv(RECORD), NOTE)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m tactus.report.measure.digits", description=__doc__
    )
    parser.add_argument("counts", nargs="*", type=int, help="0 for the network as it was trained")
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    scene = load_scene(SCENE)
    story = tomllib.loads(provenance_path(scene.weights_paths[0]).read_text(encoding="utf-8"))
    stop_if_dry_run(f"train the network of scene {scene.name} with fewer and fewer digits")
    stages = Stages(scene)
    stages.add(scene.members[0].hidden, story["best_restart"])
    heads = columns(scene)
    rows = {row[0]: list(row) for row in (digits(0).rows if RECORD.is_file() else [])}
    for count in arguments.counts or COUNTS:
        row = measured(scene, stages, count)
        rows[row[0]] = row
        print(
            ", ".join(f"{head} {cell}" for head, cell in zip(heads, row, strict=True)), flush=True
        )
        if arguments.record:
            # The network as trained comes first, then more and more digits are removed.
            found = Table("digits", heads, [rows[asked] for asked in COUNTS if asked in rows], NOTE)
            with replace_file(RECORD) as temporary:
                found.write_csv(temporary)
    if arguments.record:
        print(f"wrote {RECORD}")


if __name__ == "__main__":
    run_repeatable("tactus.report.measure.digits", main)

"""MLP and RBF on the same rows, and their costs (thesis sections 3.9 to 3.11)."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from golden.networks.operations import mlp_operations, rbf_operations, rbf_operations_drawn
from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, LOAD_G, POSITION_MM
from golden.trained.mlp import Mlp, tanh
from tactus.core.fingerprint import ROOT
from tactus.core.table import read_table, rows_where
from tactus.report.measure.rbf_training import train_rbf
from tactus.report.measure.table import Cell, Table
from tactus.scene import thesis_table
from tactus.scene.metrics import millimetres, percent_errors, summarise
from tactus.train.descent import levenberg_marquardt
from tactus.train.descent.objective import Objective, Rows, pack, unpack
from tactus.train.descent.search import starting_weights
from tactus.train.descent.split import Split, split_rows

DATA = ROOT / "scenes" / "data"
SENSORS = ["sensor1", "sensor2"]
OUTPUTS = ["load", "position"]

# Section 3.8.1 uses loads of 12.7 mm, and codes the heaviest, 13 g, as 0.9. Appendix 2 contains
# three of its loads, E, F and G (11, 9 and 6 g), and codes 23 g as 0.9.
LOAD_WIDTH = 0.225
HEAVIEST_G = 13.0

RESTARTS = 20
STEPS = 600
WEIGHT_DECAY = 1e-6


def printed_figures(network: str) -> dict[str, float]:
    """The printed figures of a network, such as "RBF 2:6:2"."""
    return thesis_table(network.lower().translate(_KEY))


_KEY = str.maketrans(" :", "__")


class EitherNetwork(Protocol):
    """The interface of both classes of networks."""

    def process(self, frames: Real) -> Real: ...


def recorded() -> tuple[Real, Real]:
    """The samples and targets of the narrow loads: 57 rows, with loads coded as in 3.8.1."""
    path = DATA / "appendix2.csv"
    rows = read_table(path, [*SENSORS, *OUTPUTS])[rows_where(path, {"width": LOAD_WIDTH})]
    targets = rows[:, len(SENSORS) :].copy()
    targets[:, 0] *= LOAD_G / HEAVIEST_G
    return rows[:, : len(SENSORS)], targets


def train_mlp(inputs: Real, targets: Real, split: Split, rng: np.random.Generator) -> Mlp:
    """The 2:6:2 network of one start, trained by Levenberg-Marquardt with early stopping."""
    shape = (inputs.shape[1], 6, targets.shape[1])
    training, validation = (
        Rows(inputs[rows], targets[rows], np.ones_like(targets[rows]))
        for rows in (split.training, split.validation)
    )
    # The patience equals the number of steps, because such small networks hardly overfit.
    objective = Objective(shape, tanh, training, validation, WEIGHT_DECAY, patience=STEPS)
    start = pack(starting_weights(shape, rng))
    return unpack(objective.search(levenberg_marquardt.descend, start, STEPS), shape)


def ranked(
    inputs: Real, targets: Real, split: Split, train: Callable[[int], EitherNetwork]
) -> list[EitherNetwork]:
    """The networks of all starts, that with the least squared validation error first."""
    rows = split.validation

    def error(network: EitherNetwork) -> float:
        return float(((network.process(inputs[rows]) - targets[rows]) ** 2).sum())

    return sorted((train(restart) for restart in range(RESTARTS)), key=error)


def classes(seed: int) -> Table:
    """The errors of MLP 2:6:2, RBF 2:6:2 and RBF 2:7:2, beside the printed errors."""
    inputs, targets = recorded()
    split = split_rows(len(inputs), seed)
    x, t = inputs[split.training], targets[split.training]

    def generator(hidden: int, restart: int) -> np.random.Generator:
        return np.random.default_rng([seed, hidden, restart])

    networks = {
        "MLP 2:6:2": ranked(
            inputs, targets, split, lambda r: train_mlp(inputs, targets, split, generator(6, r))
        ),
        "RBF 2:6:2": ranked(inputs, targets, split, lambda r: train_rbf(x, t, 6, generator(6, r))),
        "RBF 2:7:2": ranked(inputs, targets, split, lambda r: train_rbf(x, t, 7, generator(7, r))),
    }
    rows: list[list[Cell]] = []
    for name, starts in networks.items():
        results = starts[0].process(inputs)
        percent = summarise(
            percent_errors(results, targets, OUTPUTS, {"position": FULL_SCALE}), targets[:, 1]
        )
        printed = printed_figures(name)
        for c, output in enumerate(OUTPUTS):
            worst = max(float(np.abs(n.process(inputs) - targets)[:, c].max()) for n in starts)
            miss = np.abs(results[:, c] - targets[:, c])
            length = millimetres(percent[c], POSITION_MM).worst if output == "position" else None
            rows.append(
                [
                    name,
                    output,
                    float(miss.max()),
                    worst,
                    printed[f"{output}_error_max"],
                    float(100 * (miss / targets[:, c]).max()),
                    percent[c].mean,
                    percent[c].largest_mean,
                    percent[c].worst,
                    length,
                ]
            )
    return Table(
        "classes",
        [
            "network",
            "output",
            "largest difference",
            "worst start",
            "printed",
            "of target %",
            "mean %",
            "largest mean %",
            "worst %",
            "worst mm",
        ],
        rows,
        "The networks see sensors 1 and 2 of loads E, F and G, which are 57 rows. The fourth load "
        "of the thesis, 13 g, is not in its Appendix 2; loads are coded so that 13 g is 0.9. The "
        "errors are over all rows. Half of the rows train, and a quarter chooses among "
        f"{RESTARTS} starts. 'Printed' are the largest relative errors of section 3.11.3 and "
        "Figures 3.18 and 3.19. Their size is that of a difference of coded values, and not that "
        "of a part of the target. 'Worst start' is the largest difference of the start that has "
        "the largest one. 'Mean' to 'worst' are equations 3.15 and 3.16, with the position divided "
        "by 0.9. The thesis prints 0.4 for the position of RBF 2:6:2, ten times its own 0.04 with "
        "seven nodes. This is not reproduced; the thesis mentions no restarts.",
    )


def operations(_: int) -> Table:
    """The multiplications and additions of the equations, and as the reference counts them."""
    rows: list[list[Cell]] = []
    for kind, hidden, count, way in (
        ("MLP", 6, mlp_operations, "equation 3.11"),
        ("RBF", 6, rbf_operations, "equations 3.13, 3.14"),
        ("RBF", 6, rbf_operations_drawn, "Figure 3.16"),
        ("RBF", 7, rbf_operations, "equations 3.13, 3.14"),
        ("RBF", 7, rbf_operations_drawn, "Figure 3.16"),
    ):
        name = f"{kind} 2:{hidden}:2"
        found = count((2, hidden, 2))
        printed = printed_figures(name)
        rows.append(
            [
                name,
                way,
                found.multiplications,
                printed["multiplications"],
                found.additions,
                printed["additions"],
            ]
        )
    return Table(
        "operations",
        [
            "network",
            "counted from",
            "multiplications",
            "printed multiplications",
            "additions",
            "printed additions",
        ],
        rows,
        "Activation functions are not counted, and an addition has two operands. Of the 26 "
        "additions that the thesis prints for the MLP, 12 are of layer 1 and 14 of layer 2, where "
        "two sums of six products and a bias take 12. The figures that it prints for the RBF are "
        "those of its block diagram. There the squared distance is multiplied out, which takes 2 N "
        "+ 2 multiplications per node instead of the N + 1 of the equation. The sum of six or "
        "seven products of each output is counted as one addition; for the MLP it is not. If both "
        "are counted alike, RBF 2:6:2 takes 30 multiplications and 30 additions, and the MLP takes "
        "24 and 24. That is a quarter more, and not 2.3 times as many. Besides, the exponentials "
        "of the RBF cost as much as tanh.",
    )

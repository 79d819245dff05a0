"""The printed errors of the thesis' networks for the digit, beside the same errors of ours."""

from dataclasses import dataclass

import numpy as np

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, POSITION_MM, WIDTH_MM
from tactus.errors.scene_errors import disturbed_rows
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, load_scene, thesis_table
from tactus.scene.disturbance import Disturbance
from tactus.scene.metrics import summarise


@dataclass(frozen=True)
class Pair:
    """A network of the thesis, and the scenes that correspond to it.

    name: The name in tables and plots.
    alike: The scene with the arithmetic and the activation of the thesis, or empty.
    today: The scene in ``exact`` precision, or empty.
    hardware: The table of the printed figures of the hardware, or empty if none was built.
    in_float: The table of the printed figures in floating point (section 3.12.1), or empty.
    """

    name: str
    alike: str
    today: str
    hardware: str = ""
    in_float: str = ""


PARALLEL = [
    Pair("2:6:2, gradient", "digit-parallel", "", "parallel_2_6_2.gradient"),
    *(
        Pair(f"2:6:2, {name}", f"comparison/digit-parallel-{name}", "", f"parallel_2_6_2.{name}")
        for name in ("polynomial", "pade", "lut")
    ),
]
SINGLE = Pair(
    "single",
    "digit-single-thesis",
    "comparison/digit-single-half",
    "digit.hybrid",
    "float_networks.single",
)
MULTIPLE = Pair("multiple", "", "comparison/digit-multiple-half", "", "float_networks.multiple")
CASCADE_A = Pair(
    "cascade A",
    "comparison/digit-thesis-a",
    "comparison/digit-a",
    "digit.cascade_a",
    "float_networks.cascade",
)
CASCADE_B = Pair("cascade B", "digit-thesis", "", "digit.cascade_b")
PAIRS = [*PARALLEL, SINGLE, MULTIPLE, CASCADE_A, CASCADE_B]

# The networks of the pictures along the beam: in floating point as in Figures 3.23 to 3.26, and
# bit-true in the arithmetic of the thesis as in Figures 5.16 to 5.19.
ALONG = {
    "floating point": {pair.name: pair.today for pair in (SINGLE, MULTIPLE, CASCADE_A)},
    "bit-true": {pair.name: pair.alike for pair in (SINGLE, CASCADE_A, CASCADE_B)},
}
# The networks of Figure 5.24, and those of today.
WIDTHS = {
    "single": SINGLE.alike,
    "cascade": CASCADE_B.alike,
    "single, exact": SINGLE.today,
    "cascade, exact": CASCADE_A.today,
}


# The levels of noise, in mV, between which the one is interpolated at which a network errs as much
# as the thesis prints.
LEVELS = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0)


def printed(_: int) -> Table:
    """The largest mean errors over the positions, as printed and of our networks."""
    rows: list[list[Cell]] = []
    for pair in PAIRS:
        hardware, real = thesis_table(pair.hardware), thesis_table(pair.in_float)
        theirs = [real.get("better_than"), hardware.get("simulation"), hardware.get("real_time")]
        alike = largest(load_scene(pair.alike)) if pair.alike else [None] * 2
        today = largest(load_scene(pair.today)) if pair.today else [None] * 2
        noise = noise_of(load_scene(pair.alike), theirs[2]) if theirs[2] else None
        figures = [*theirs, alike[1], noise, *today]
        for c, output in enumerate(load_scene(pair.alike or pair.today).outputs):
            rows.append([pair.name, output, *(None if f is None else f[c] for f in figures)])
    return Table(
        "printed",
        [
            "network",
            "output",
            "printed, floating point %",
            "printed, simulation %",
            "printed, real time %",
            "thesis arithmetic, bit-true %",
            "as in real time with noise of mV",
            "floating point %",
            "exact, bit-true %",
        ],
        rows,
        "The figures are largest mean errors over the positions (equations 3.15 and 3.16). The "
        "printed ones are from section 3.12.1, Table 5.4 and section 5.2.2. Ours are on the "
        "recorded readings. We have no rig, so no figure of ours was measured in real time. The "
        "noise is that on every reading with which our network in the arithmetic of the thesis "
        "errs as much as the thesis prints for real time.",
    )


def largest(scene: Scene) -> list[list[float]]:
    """The largest mean errors of every output: in floating point, and bit-true."""
    return [_largest(scene, errors_of(scene, bit_true)) for bit_true in (False, True)]


def noise_of(scene: Scene, errors: list[float]) -> list[float | None]:
    """The noise in mV with which each output errs as much as ``errors``.

    It is None where the output errs more without noise, or less with the largest of ``LEVELS``.
    """
    found = [
        _largest(scene, disturbed_rows(scene, Disturbance(level / 1e3)))
        if level
        else largest(scene)[1]
        for level in LEVELS
    ]
    noises: list[float | None] = []
    for error, means in zip(errors, zip(*found, strict=True), strict=True):
        beyond = next((n for n, mean in enumerate(means) if mean > error), 0)
        if not beyond:
            noises.append(None)
            continue
        ends = means[beyond - 1 : beyond + 1], LEVELS[beyond - 1 : beyond + 1]
        noises.append(float(np.interp(error, *ends)))
    return noises


def _largest(scene: Scene, errors: Real) -> list[float]:
    return [found.largest_mean for found in summarise(errors, scene.vectors().groups)]


def errors_of(scene: Scene, bit_true: bool) -> Real:
    """The errors in percent on the recorded rows, shape (rows, outputs)."""
    return scene.vectors().percent_errors(results_of(scene, bit_true))


def results_of(scene: Scene, bit_true: bool) -> Real:
    """The outputs of the networks or of their hardware for the recorded rows."""
    vectors = scene.vectors()
    if not bit_true:
        return scene.process_real(vectors.inputs)
    return np.asarray(SIGNAL.to_real(scene.twin().core.process(vectors.codes)))


def along_beam(_: int) -> Table:
    """The mean, least and largest error at each position, for networks that the thesis compares."""
    rows: list[list[Cell]] = []
    for kind, names in ALONG.items():
        for network, name in names.items():
            scene = load_scene(name)
            errors, groups = errors_of(scene, kind == "bit-true"), scene.vectors().groups
            for c, output in enumerate(scene.outputs):
                for place in np.unique(groups):
                    here = errors[groups == place, c]
                    tip = float(place) / FULL_SCALE * POSITION_MM
                    spread = map(float, (here.mean(), here.min(), here.max()))
                    rows.append([kind, network, scene.name, output, tip, len(here), *spread])
    return Table(
        "along_beam",
        [
            *("arithmetic", "network", "scene", "output", "mm from the tip", "rows"),
            *("mean %", "least %", "largest %"),
        ],
        rows,
        "The figures are errors (equation 3.16) of the recorded rows at each position. Those in "
        "floating point compare networks as Figures 3.23 to 3.26 do. The bit-true ones are in the "
        "arithmetic of the thesis, as in Figures 5.16 to 5.19.",
    )


def widths(_: int) -> Table:
    """The mean error of the width for loads of each width, in percent of this width."""
    rows: list[list[Cell]] = []
    for network, name in WIDTHS.items():
        scene = load_scene(name)
        c, vectors = scene.outputs.index("width"), scene.vectors()
        targets = vectors.targets[:, c]
        found = np.abs(results_of(scene, True)[:, c] - targets)
        for width in np.unique(targets):
            here = found[targets == width]
            mm = WIDTH_MM / FULL_SCALE
            rows.append(
                [
                    network,
                    scene.name,
                    float(width) * mm,
                    len(here),
                    float(here.mean()) * mm,
                    float(100 * here.mean() / width),
                    float(100 * here.max() / width),
                ]
            )
    return Table(
        "widths",
        ["network", "scene", "width mm", "rows", "mean mm", "mean %", "largest %"],
        rows,
        "The figures are bit-true errors of the width, in percent of the actual width as in Figure "
        "5.24. Everywhere else they are in percent of the full scale of the beam.",
    )

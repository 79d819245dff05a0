"""Finds the best places for gauges on a beam that the TOML file of ``make sensors`` describes.

The best places make the bound of their errors small. Prior knowledge is included: load, position
and width lie within their ranges, which counts as a reading of each with the standard deviation of
its range. So a bound is never larger than the error of a guess, and means can be computed even over
placements whose width no gauge measures.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.files import named_file
from tactus.core.schema import load_keys, read_checked, written
from tactus.physics.beam import Beam, Loads, strain

FOLDER = Path(__file__).parent / "rigs"
OUTPUTS = ("load", "position", "width")
SHAPES = {"rectangle": False, "triangle": True}
RIG = load_keys(Path(__file__).with_suffix(".toml"), outputs=OUTPUTS, shapes=tuple(SHAPES))

# Number of positions along the range of the load, for each width, shape and load.
POSITIONS = 25

# The mean magnitude of a normally distributed error, as a part of its standard deviation.
MEAN_PER_DEVIATION = math.sqrt(2 / math.pi)

# The distance of the places that are tried, since nobody can glue a gauge more precisely.
STEP = 1e-3  # m
MOST_PLACES = 500

# The least improvement, as a part of the objective. Less is only rounding, which depends on the
# machine.
LEAST_GAIN = 1e-9


@dataclass(frozen=True)
class GaugeRig:
    """The question that is put to ``make sensors``, and the bounds for any places of its gauges.

    Places are in m from the root, and voltages in V; see the file.

    count, span, apart: How many gauges, where they may be, and the least distance of two.
    compare: Places to compare with; may be empty.
    cell_noise: Noise of a sensor that reads only the load, as a part of its reading for the
        heaviest load; infinite where there is no such sensor.
    masses: The least and the largest mass in kg.
    placements: All placements over which errors are computed.
    known: Whether load, position and width are known beforehand, which holds for a range of one
        value.
    spreads, shape (3,): Standard deviations of mass, position and half-width over the placements,
        in SI units.
    percent, shape (placements, 3): Error in percent for one SI unit of mass, position and
        half-width.
    outputs, objective: The outputs whose errors count, and which of them: "mean" or "worst".
    """

    name: str
    beam: Beam
    count: int
    span: tuple[float, float]
    apart: float
    full_scale: float
    noise: float
    noise_strain: float
    compare: tuple[float, ...]
    cell_noise: float
    masses: tuple[float, float]
    placements: Loads
    known: tuple[bool, ...]
    spreads: Real
    percent: Real
    outputs: tuple[str, ...]
    objective: str

    @cached_property
    def places(self) -> Real:
        """The places in m where a gauge may be."""
        low, high = self.span
        count = min(int((high - low) / STEP + 1e-6) + 1, MOST_PLACES)
        return np.linspace(low, high if count == MOST_PLACES else low + STEP * (count - 1), count)

    def information(self, place: float) -> Real:
        """Information of a gauge about mass, position and half-width at each placement, (n, 3, 3).

        Its amplifier is set so that the largest moment reads full scale.
        """
        strains, slopes = strain(self.beam, place, self.placements)
        largest = float(np.abs(strains).max())
        if not largest:
            return np.zeros((len(self.percent), 3, 3))
        gain = self.full_scale / largest
        deviation = np.hypot(self.noise, gain * self.noise_strain)
        slopes = slopes * (gain / deviation)
        return slopes[:, :, np.newaxis] * slopes[:, np.newaxis]

    @cached_property
    def _all(self) -> Real:
        return np.stack([self.information(float(place)) for place in self.places])

    @cached_property
    def _beforehand(self) -> Real:
        """The information without any gauge."""
        known = np.array(self.known)
        spreads = np.where(known, 1.0, self.spreads)
        found: Real = np.diag(1 / spreads**2)
        found[0, 0] += (1 / (self.masses[1] * self.cell_noise)) ** 2
        return found

    def errors_of(self, information: Real) -> Real:
        """Bounds from the information of the gauges, (..., n, 3): mean errors in percent.

        A known quantity has no error.
        """
        unknown = np.flatnonzero(~np.array(self.known))
        total = (information + self._beforehand)[..., unknown[:, np.newaxis], unknown]
        # All units are scaled to the same size, so that the inverse is accurate.
        unit = self.spreads[unknown]
        inverse = np.linalg.inv(total * unit[:, np.newaxis] * unit)
        variances = np.diagonal(inverse, axis1=-2, axis2=-1)
        found = np.zeros((*information.shape[:-2], 3))
        deviations = np.sqrt(variances) * unit
        found[..., unknown] = MEAN_PER_DEVIATION * deviations * self.percent[:, unknown]
        return found

    def errors(self, places: Sequence[float]) -> Real:
        """Bounds at each placement for gauges at the given places, (n, 3)."""
        return self.errors_of(sum((self.information(p) for p in places), np.zeros((1, 3, 3))))

    def score(self, errors: Real) -> Real:
        """The number to minimise: mean or worst error over placements and outputs that count."""
        counted = errors[..., [OUTPUTS.index(name) for name in self.outputs]]
        flat = counted.reshape(*counted.shape[:-2], -1)
        return flat.mean(axis=-1) if self.objective == "mean" else flat.max(axis=-1)

    def best(self) -> list[float]:
        """The best places that were found; they are the same in every run.

        From several starts, each gauge in turn moves to its best place among the others, until none
        moves any more. The starts are: one gauge after another where it helps most; evenly spread
        gauges; and the places for comparison.
        """
        count = self.count
        even = np.linspace(0, len(self.places) - 1, count).round().astype(int).tolist()
        compared = [int(np.abs(self.places - place).argmin()) for place in self.compare]
        starts = [[], *(s for s in (even, compared) if len(s) == count and self._apart(s))]
        ends = [self._descended(start) for start in starts]
        score, chosen = min(ends, key=lambda end: end[0])
        if not np.isfinite(score):
            raise InputError(
                f"gauges.apart_mm: got {1e3 * self.apart:g}, expected room for {count} gauges"
            )
        return [float(self.places[k]) for k in sorted(chosen)]

    def _apart(self, chosen: list[int]) -> bool:
        return bool((np.diff(self.places[sorted(chosen)]) >= self.apart - STEP / 1e3).all())

    def _descended(self, start: list[int]) -> tuple[float, list[int]]:
        chosen, score = list(start), np.inf
        while len(chosen) < self.count:
            score, k = self._best_beside(chosen)
            if not np.isfinite(score):
                return score, chosen
            chosen.append(k)
        while True:
            before = score
            for n in range(len(chosen)):
                others = [k for i, k in enumerate(chosen) if i != n]
                found, k = self._best_beside(others)
                if found < score * (1 - LEAST_GAIN):
                    chosen[n], score = k, found
            if not score < before * (1 - LEAST_GAIN):
                return float(score), chosen

    def _best_beside(self, others: list[int]) -> tuple[float, int]:
        """The best score with one more gauge, and its place; infinite if there is no room."""
        known = self._all[others].sum(axis=0)
        free = np.ones(len(self.places), dtype=bool)
        for k in others:
            free &= np.abs(self.places - self.places[k]) >= self.apart - STEP / 1e3
        at = np.flatnonzero(free)
        if not len(at):
            return np.inf, 0
        # The places are evaluated in groups, because the arrays for all together would be too
        # large.
        parts = np.array_split(at, min(len(at), 16))
        scores = np.concatenate(
            [self.score(self.errors_of(known + self._all[part])) for part in parts]
        )
        # Of places with equal scores, the one nearest to the root is taken.
        best = int((scores <= scores.min() * (1 + LEAST_GAIN)).argmax())
        return float(scores[best]), int(at[best])


def load_rig(name: str) -> GaugeRig:
    """Read a rig by its name, or by a path that ends in ``.toml``."""
    known = {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
    path = named_file("rig", name, known, list(known))
    return _rig(read_checked(path, RIG), path)


def _rig(values: dict[str, dict[str, Any]], path: Path) -> GaugeRig:
    beam, gauges, loads, errors = (values[s] for s in ("beam", "gauges", "loads", "errors"))
    for name in errors["outputs"]:
        if name != "load" and name not in errors["length_mm"]:
            raise InputError(
                f"{path}: errors.length_mm.{name}: missing, expected what 100 % of {name} is"
            )
    length = beam["length_mm"]
    low, high = loads["position_mm"]
    widths = loads["width_mm"]
    for key, fault, expected in (
        (
            "gauges.to_mm",
            gauges["from_mm"] + (gauges["count"] - 1) * gauges["apart_mm"]
            > min(gauges["to_mm"], length),
            f"room for {gauges['count']} gauges {gauges['apart_mm']:g} mm apart from "
            f"{gauges['from_mm']:g} on, on a beam of {length:g} mm",
        ),
        (
            "gauges.noise_v",
            not gauges["noise_v"] and not gauges["noise_strain"],
            "above 0, or noise_strain above 0",
        ),
        (
            "gauges.compare_mm",
            any(not 0 <= place <= length for place in gauges["compare_mm"]),
            f"places on the beam, 0 to {length:g}",
        ),
        (
            "loads.position_mm",
            low - max(widths) / 2 < 0
            or low > length - loads["edge_mm"] - max(widths) / 2
            or high > length - loads["edge_mm"] - min(widths) / 2 + 1e-6,
            f"loads {min(widths):g} to {max(widths):g} mm wide that lie between root and tip",
        ),
        ("loads.width_mm", min(widths) <= 0, "widths above 0"),
        ("loads.load_g", loads["load_g"][0] <= 0, "loads above 0"),
    ):
        if fault:
            section, name = key.split(".")
            got = written(values[section][name], read=True)
            raise InputError(f"{path}: {key}: got {got}, expected {expected}")
    placements = _placements(loads, length)
    ranges = np.array([np.ptp(loads["load_g"]) / 1e3, (high - low) / 1e3, np.ptp(widths) / 2e3])
    full = [errors["length_mm"].get(name, 0.0) / 1e3 for name in OUTPUTS[1:]]
    scale = np.stack(
        [placements.mass, *(np.full(len(placements.mass), f or np.inf) for f in full)], axis=-1
    )
    cell = values.get("load_cell")
    return GaugeRig(
        name=path.stem,
        beam=Beam(
            length / 1e3,
            beam["width_mm"] / 1e3,
            beam["thickness_mm"] / 1e3,
            beam["elastic_modulus_gpa"] * 1e9,
        ),
        count=gauges["count"],
        span=(gauges["from_mm"] / 1e3, min(gauges["to_mm"], length) / 1e3),
        apart=gauges["apart_mm"] / 1e3,
        full_scale=gauges["full_scale_v"],
        noise=gauges["noise_v"],
        noise_strain=gauges["noise_strain"],
        compare=tuple(sorted(place / 1e3 for place in gauges["compare_mm"])),
        cell_noise=cell["noise_v"] / cell["full_scale_v"] if cell else math.inf,
        masses=(loads["load_g"][0] / 1e3, loads["load_g"][1] / 1e3),
        placements=placements,
        known=tuple(not size for size in ranges),
        spreads=ranges / math.sqrt(12),
        percent=100 / scale * np.array([1, 1, 2]),
        outputs=tuple(errors["outputs"]),
        objective=errors["objective"],
    )


def _placements(loads: dict[str, Any], length: float) -> Loads:
    """The least and the largest load, with all widths and shapes, along the free beam."""
    low, high = loads["position_mm"]
    rows = [
        (mass / 1e3, place / 1e3, width / 2e3, SHAPES[shape])
        for mass in dict.fromkeys(loads["load_g"])
        for width in loads["width_mm"]
        for shape in loads["shapes"]
        for place in np.linspace(low, high, POSITIONS if high > low else 1)
        if place <= length - loads["edge_mm"] - width / 2
    ]
    return Loads(*np.array(rows, dtype=np.float64).T)

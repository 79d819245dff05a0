"""Tests of tables, and of the figures that pages show."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from pages import ROUNDING, cells, section, shows
from scipy.signal import find_peaks

from golden.numbers.precision import SIGNAL
from studies.physics.digit_sensors import (
    COLUMNS,
    RECORDED,
    SENSORS,
    fit_sensors,
    loads_from_codes,
    read_sensors,
)
from studies.physics.swing_data import independent_run
from tactus.core.table import read_table
from tactus.errors import scene_errors
from tactus.physics.beam import Beam
from tactus.physics.gauges import Placing, load_rig
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.table import Table
from tactus.scene import load_scene, thesis_table

FORMS = ("single", "multiple", "cascade")


def test_the_sensors_of_the_page_are_those_fitted() -> None:
    page = section("physics", "Do the recorded sensors follow theory?")
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    readings, beam = table[:, : len(SENSORS)], Beam()
    sensors = fit_sensors(table, beam)
    left = read_sensors(sensors, loads_from_codes(table[:, len(SENSORS) :], beam)) - readings
    percent = 100 * np.sqrt((left**2).mean(axis=0)) / np.ptp(readings, axis=0)
    for n, (sensor, rms) in enumerate(zip(sensors, percent, strict=True), 1):
        place, *shown = cells(page, str(n))
        assert shows(place, 1e3 * sensor.position, ROUNDING) if n < 4 else place == "outside"
        for text, figure in zip(shown, (sensor.gain, float(rms)), strict=True):
            assert shows(text, figure, ROUNDING), n


def displacement_errors(results: np.ndarray, actual: np.ndarray) -> list[float]:
    """Equation 6.6: mean errors in percent of the mean way from end to end of a swing.

    The thesis calls the divisor "actual total displacement", without an equation. Here it is the
    mean of the motion's peaks minus that of its troughs.
    """
    ends = [[x[find_peaks(sign * x)[0]].mean() for sign in (1, -1)] for x in actual.T]
    return list(100 * np.abs(results - actual).mean(axis=0) / [high - low for high, low in ends])


def errors_of_motions(name: str, runs: tuple[int, ...]) -> dict[str, float]:
    """Equation 6.6 for each output of a shipped scene, bit-true, in the worst of the runs."""
    scene = load_scene(name)
    found = []
    for run in runs:
        inputs = scene.window.frames(independent_run(run, scene.sensors))
        actual = independent_run(run, scene.outputs)[scene.window.past :]
        codes = scene.twin().core.process(SIGNAL.quantise(inputs)[0])
        exact = displacement_errors(SIGNAL.to_real(codes), actual)
        real = displacement_errors(scene.process_real(inputs), actual)
        # In the thesis' 14 bits the activation is trained with, and differs from floating point.
        pairs = zip(exact, real, strict=True)
        assert name.endswith("-thesis") or all(abs(a - b) < 0.03 for a, b in pairs)
        found.append(exact)
    return dict(zip(scene.outputs, np.max(found, axis=0).tolist(), strict=True))


@pytest.mark.all_only
def test_the_motions_of_the_page_are_those_measured() -> None:
    """The page shows the worse of two bit-true runs beside the thesis, and the demanded error."""
    page = section("physics", "Networks for the swing")
    for n, name in enumerate(("swing-window", "swing-window-cascade")):
        # The last two runs were made after the networks were chosen.
        for m, runs in enumerate(((1, 2), (3, 4))):
            found = errors_of_motions(name, runs)
            for output, asked in zip("xyz", (1.5, 0.2, 1.0), strict=True):
                shown = cells(page, f"{output}, with a past")
                assert shows(shown[2 * n + m], found[output], ROUNDING), (name, output)
                assert found[output] <= asked
    for n, form in enumerate(FORMS):
        printed = thesis_table("swing")[form]["percent_error"]
        for scene, row in (
            (f"swing-{form}", "{}"),
            (f"comparison/swing-{form}-thesis", "{}, 14 bits"),
        ):
            found = errors_of_motions(scene, (1, 2))
            for c, output in enumerate("xyz"):
                shown = cells(page, row.format(output))
                assert shows(shown[2 * n], found[output], ROUNDING), (scene, output)
                assert float(shown[2 * n + 1]) == printed[c]


def test_a_table_as_text() -> None:
    table = Table("t", ["name", "value"], [["long name", 1.23456], ["x", None], ["y", 12]], "Why.")
    body = ["name       value", "long name  1.235", "x              -", "y             12"]
    assert table.lines() == ["t", "", *body, "", "Why."]


def test_a_page_rounds_a_column_alike_unless_it_has_several_units() -> None:
    rows = [[0.4061, 116.7, 248, 0.9999], [1.018, 3.42, 3.875, 0.5]]
    assert Table("t", ["%", "MHz", "all", "part"], rows, "").shown == [
        ["0.41", "116.7", "248", "0.9999"],
        ["1.02", "3.4", "3.88", "0.5000"],
    ]


def test_the_gauges_of_the_page_are_those_found() -> None:
    page = section("limits", "Where gauges should sit")
    rig = load_rig("digit")
    cases = [("thesis", rig, list(rig.compare))]
    cases += [("best found", replace(rig, count=count), []) for count in (3, 4, 6)]
    cases.append(("best found", replace(rig, count=4, cell_noise=math.inf), []))
    for label, case, known in cases:
        placing = Placing(case)
        places = known or placing.best()
        cell = "yes" if math.isfinite(case.cell_noise) else "no"
        mm = ", ".join(f"{1e3 * place:.4g}" for place in places)
        means = placing.errors(places).mean(axis=0)
        for text, mean in zip(cells(page, label, str(len(places)), cell, mm), means, strict=True):
            assert shows(text, float(mean), ROUNDING)


def test_an_instrument_waits_for_its_sensors() -> None:
    design = load_scene("digit-instrument").twin()
    scan = design.scan_sequencer
    alone = clocks_per_frame(load_scene("digit").twin())
    assert clocks_per_frame(design) > scan.sample_clocks[-1] > 10 * alone
    assert design.interval == scan.scan_clocks


def test_a_cascade_pays_clocks_for_accuracy() -> None:
    """No part of the error is promised in advance. The figures of the page are those measured.

    The networks of the thesis have the hidden nodes that it prints, so a cascade wins less there.
    """

    def largest(name: str) -> float:
        return max(error.largest_mean for error in scene_errors(load_scene(name))["bit-true"])

    def frame(name: str) -> str:
        return str(clocks_per_frame(load_scene(name).twin()))

    page = " ".join(section("thesis", "Clocks for accuracy").split())
    pairs = {"digit-hybrid": "digit-single", "digit-thesis": "digit-single-thesis"}
    for cascade, single in pairs.items():
        form = rf"`{cascade}` takes (\d+) clocks .*?by ([\d.]+) times .*?`{single}`.*? (\d+)"
        (shown,) = re.findall(form, page)
        part = largest(cascade) / largest(single)
        assert shown == (frame(cascade), f"{part:.2f}", frame(single))
        assert part < 1
    assert largest("digit-a") > largest("digit-hybrid")
    assert largest("digit-thesis-a") > largest("digit-thesis")

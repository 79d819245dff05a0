"""Compares docs/thesis.md and its tables with printed figures and other computations."""

import math
import re
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest
from pages import same_picture

from golden.numbers.precision import EXACT, THESIS, normalisation
from golden.numbers.real import Real
from tactus.core.fingerprint import ROOT
from tactus.errors.scene_errors import disturbed_rows, scene_errors
from tactus.physics import GRAVITY
from tactus.physics.beam import Beam
from tactus.physics.conditioning import LOW_PASS, SCAN_RATE
from tactus.report.draw import along, profiles, rigs
from tactus.report.draw.convergence import convergence_plot
from tactus.report.measure import printed, table_records
from tactus.report.measure.camera import camera
from tactus.report.measure.low_pass import low_pass
from tactus.report.measure.table import Cell, Table
from tactus.report.page import thesis
from tactus.scene import load_scene, thesis_table
from tactus.scene.disturbance import Disturbance
from tactus.scene.metrics import summarise
from tactus.synth.budget import budget_path, read_budget

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

DOCS = ROOT / "docs"
SVG = "{http://www.w3.org/2000/svg}"


def rows(table: Table, **where: Cell) -> list[dict[str, Cell]]:
    """The rows with these values, as mappings."""
    found = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    return [row for row in found if all(row[key] == value for key, value in where.items())]


@pytest.fixture(scope="module")
def errors() -> Table:
    return printed.printed(1)


@pytest.fixture(scope="module")
def beam() -> Table:
    return printed.along_beam(1)


@pytest.fixture(scope="module")
def widths() -> Table:
    return printed.widths(1)


@pytest.fixture(scope="module")
def convergence() -> Table:
    return table_records.read("convergence")


def test_the_pages_hold_what_is_measured() -> None:
    for page, text in thesis.pages().items():
        written = page.read_text(encoding="utf-8")
        same = same_picture(written, text) if page.suffix == ".svg" else written == text
        assert same, f"{page}: run: {thesis.COMMAND}"


def test_every_picture_is_shown_with_its_sentence_below() -> None:
    shown = {}
    for name in ("thesis-tables", *set(thesis.ELSEWHERE.values())):
        page = (DOCS / f"{name}.md").read_text(encoding="utf-8")
        form = r"!\[[^\]]+\]\(thesis/(\w+)\.svg\)\n\n<!-- (\w+), from here"
        shown |= dict(re.findall(form, page))
    assert shown == {name: name for name in shown}
    assert set(shown) == {path.stem for path in thesis.PICTURES.glob("*.svg")}


@pytest.mark.parametrize("path", sorted(thesis.PICTURES.glob("*.svg")), ids=lambda p: p.stem)
def test_a_picture_is_one_svg_without_scripts(path) -> None:
    text = path.read_text(encoding="utf-8")
    root = ElementTree.fromstring(text)
    assert root.tag == f"{SVG}svg"
    assert "<script" not in text
    assert "nan" not in text.lower()


def test_the_printed_columns_are_those_of_the_thesis(errors: Table) -> None:
    """They are the last column of Table 5.4, and the multiple network of section 3.12.1."""
    (cascade, multiple) = (rows(errors, network=name) for name in ("cascade B", "multiple"))
    assert [row["printed, real time %"] for row in cascade] == [6.38, 2.32, 2.78, 3.77]
    assert [row["printed, simulation %"] for row in cascade] == [3.67, 2.60, 2.49, 2.9]
    assert [row["printed, floating point %"] for row in multiple] == [0.58, 1.02, 3.54, 2.95]
    assert all(row["printed, simulation %"] is None for row in multiple)
    (lut,) = rows(errors, network="2:6:2, lut", output="position")
    assert (lut["printed, simulation %"], lut["printed, real time %"]) == (2.58, 3.28)


def test_our_columns_are_the_errors_of_the_scenes(errors: Table) -> None:
    """They equal those of make figures, computed elsewhere."""
    for pair in printed.PAIRS:
        for name, column in ((pair.alike, "thesis arithmetic"), (pair.today, "exact")):
            if not name:
                continue
            scene = load_scene(name)
            assert scene.precision is (THESIS if name == pair.alike else EXACT)
            for output, error in zip(scene.outputs, scene_errors(scene)["bit-true"], strict=True):
                (row,) = rows(errors, network=pair.name, output=output)
                assert row[f"{column}, bit-true %"] == error.largest_mean


def test_with_the_noise_of_the_table_a_network_errs_as_in_real_time(errors: Table) -> None:
    """The noise is interpolated, so the errors agree within 2 %."""
    scene = load_scene(printed.CASCADE_B.alike)
    groups = scene.vectors().groups
    for n, row in enumerate(rows(errors, network="cascade B")):
        noise = row["as in real time with noise of mV"]
        found = summarise(disturbed_rows(scene, Disturbance(noise / 1e3)), groups)
        assert found[n].largest_mean == pytest.approx(row["printed, real time %"], rel=0.02)
    # No noise makes a network err less than it does without.
    assert printed.noise_of(scene, [0.1] * 4) == [None] * 4


def test_a_folded_network_has_three_multipliers_a_node_and_one_for_its_factor() -> None:
    """For the printed nodes these are the printed shares of its device, within one multiplier."""
    pairs = thesis.folded()
    assert len(pairs) == 5
    for pair in pairs:
        key, name, _ = thesis.RESOURCES[pair.name]
        mlps = load_scene(name).mlps()
        factors = [normalisation(mlp.w2, mlp.b2) for mlp in mlps]
        # A single factor that is a power of two is a shift.
        shifts = sum(len(found) == 1 and found[0] & (found[0] - 1) == 0 for found in factors)
        nodes = sum(mlp.shape[1] for mlp in mlps)
        assert pair.count == 3 * nodes + len(mlps) - shifts
        assert pair.ruled == 100 * (3 * nodes + len(mlps)) / 96
        assert abs(pair.ruled - pair.printed) <= 100 / 96
        # The page says this about the LUTs.
        assert thesis._shares(name)[2] < thesis_table(key)["luts_percent"] / 2


def test_the_power_folding_unit_draws_the_loads_that_were_placed() -> None:
    found = profiles.unit()
    assert [one.load for one in found] == ["C", "B", "A", "H"]
    for one in found:
        # The bound of the unit, in units of 2^-13; the rest is the error of the networks.
        assert one.largest < 1.81
        middle = np.abs(one.x - profiles.POSITION) < 0.03
        assert np.abs(one.y[middle] - np.interp(one.x, one.fine, one.target)[middle]).max() < 0.02
        assert one.y[0] == pytest.approx(one.target[0], abs=1e-6)


def test_no_network_beside_the_printed_ones_has_seen_all_rows() -> None:
    """They have the printed hidden nodes, and the split of the rows of the thesis."""
    for pair in printed.PAIRS:
        for scene in map(load_scene, filter(None, (pair.alike, pair.today))):
            assert (scene.training.split, scene.training.refit) == ("random", False)
            hidden = thesis_table(pair.in_float or pair.hardware)["hidden"]
            assert [mlp.shape[1] for mlp in scene.mlps()] == hidden, scene.name


def test_the_worst_place_along_the_beam_is_the_printed_kind_of_figure(
    errors: Table, beam: Table
) -> None:
    """The largest mean in one table is the figure in the other, and lies within the spread."""
    columns = {"bit-true": "thesis arithmetic, bit-true %", "floating point": "floating point %"}
    for arithmetic, names in printed.ALONG.items():
        for network, scene in names.items():
            pair = next(p for p in printed.PAIRS if scene in (p.alike, p.today))
            for output in load_scene(scene).outputs:
                found = rows(beam, arithmetic=arithmetic, network=network, output=output)
                (row,) = rows(errors, network=pair.name, output=output)
                means = [place["mean %"] for place in found]
                assert max(means) == pytest.approx(row[columns[arithmetic]], rel=1e-12)
                assert sum(place["rows"] for place in found) == 143
                for place in found:
                    assert place["least %"] <= place["mean %"] <= place["largest %"]


def test_the_bands_reach_from_the_least_to_the_largest(beam: Table) -> None:
    """Ten positions from the tip are within the working range of 127 mm, at 6.35 mm steps."""
    places = sorted({row["mm from the tip"] for row in rows(beam)})
    assert np.allclose(np.diff(places), 6.35)
    assert places[-1] == pytest.approx(127)
    text = along.along_beam(beam, "bit-true")
    for name in printed.ALONG["bit-true"]:
        assert f">{name}<" in text
    assert text == along.along_beam(beam, "bit-true")
    for arithmetic in printed.ALONG:
        told = along.along_sentence(beam, arithmetic)
        most = max(row["largest %"] for row in rows(beam, arithmetic=arithmetic, output="width"))
        assert f"{most:.1f} % of width" in told


def test_the_width_counts_against_itself(widths: Table) -> None:
    """Over all loads, the lengths are those of the local error, which is relative to 50.8 mm."""
    for network, name in printed.WIDTHS.items():
        scene = load_scene(name)
        found = rows(widths, network=network)
        assert [round(row["width mm"], 1) for row in found] == [12.7, 25.4, 38.1, 50.8]
        total = sum(row["mean mm"] * row["rows"] for row in found) / 143
        local = scene_errors(scene)["bit-true"][scene.outputs.index("width")].mean
        assert total == pytest.approx(50.8 * local / 100, rel=1e-12)
        for row in found:
            assert row["mean %"] == pytest.approx(100 * row["mean mm"] / row["width mm"])
    sentence = along.widths_plot(widths).sentence
    assert f"single {rows(widths, network='single')[0]['mean %']:.1f} % of 12.7 mm" in sentence


def test_the_training_error_falls_and_the_validation_error_does_not_always(
    convergence: Table,
) -> None:
    for network in ("2:6:2", "4:16:4"):
        found = rows(convergence, network=network)
        looks = [row["evaluations"] for row in found]
        assert looks == sorted(set(looks))
        assert all(b["training %"] <= a["training %"] for a, b in pairwise(found))
        assert any(b["validation %"] > a["validation %"] for a, b in pairwise(found))
        assert found[-1]["training %"] < found[0]["training %"] / 10
    assert len(convergence_plot(convergence).groups) == 4


def test_the_low_pass_of_the_table_is_the_printed_one() -> None:
    assert thesis_table("beam")["low_pass_hz"] == LOW_PASS
    assert thesis_table("board")["scan_rate_khz"] * 1e3 == SCAN_RATE
    table = low_pass(1)
    (ten,) = rows(table, **{"left of a step": "10 %"})
    assert ten["ms"] == pytest.approx(1e3 * math.log(10) / (2 * math.pi * 25))
    (last,) = rows(table, **{"left of a step": "half a code"})
    # 0.9 of full scale are 7373 codes of 2^-13.
    assert last["ms"] == pytest.approx(ten["ms"] * math.log(2 * 0.9 * 8192) / math.log(10))


def test_the_cameras_stand_beside_the_motions() -> None:
    found = {row["output"]: row for row in rows(camera(1))}
    assert list(found) == ["x", "y", "z"]
    assert {row["cameras mm"] for row in found.values()} == {0.585}
    assert found["y"]["printed single mm"] == 8.6
    assert found["x"]["printed multiple mm"] == 0.1
    for row in found.values():
        # A single frame cannot undo the DC remover, but past samples can.
        assert row["swing-window mm"] < row["cameras mm"]
        assert row["swing-window mm"] < row["swing-single mm"]
    # In Table 6.2 this is the error divided by the way, up to rounding.
    printed_swing = thesis_table("swing")
    for name in ("single", "multiple", "cascade"):
        figures = printed_swing[name]
        for mm, way, percent in zip(
            figures["mean_error_mm"],
            figures["mean_displacement_mm"],
            figures["percent_error"],
            strict=True,
        ):
            assert abs(mm - percent * way / 100) <= 0.05 + 0.05 * way / 100


def test_the_deflections_are_those_of_closed_forms() -> None:
    found = rigs.deflections()
    rig = Beam()
    assert list(found.beams) == [10, 13, 23]
    for grams, line in found.beams.items():
        # Equation 3.2 gives the deflection at the tip.
        tip = -grams / 1e3 * GRAVITY * rig.length**3 / (3 * rig.stiffness)
        assert line[-1] == pytest.approx(1e3 * tip)
        assert line[0] == 0
    assert found.loads.tolist() == list(range(11))
    for line in found.plate.values():
        assert np.allclose(line, found.loads * line[1])
    middle, gauge = (line[-1] for line in found.plate.values())
    assert 0 < gauge < middle


def test_the_forces_of_both_sides_are_what_the_bearing_carries() -> None:
    found = rigs.forces()
    peaks: Real = found.horizontal[found.time < 1.0]
    assert peaks.max() == pytest.approx(found.horizontal.max(), rel=1e-3)
    # Without damping F_y is D a_g (3 cos phi - 2 cos phi_initial) cos phi.
    weight = 10 * GRAVITY
    assert found.downward.max() == pytest.approx(weight * (3 - 2 * math.cos(math.pi / 6)), rel=1e-3)
    assert found.downward.min() == pytest.approx(weight * math.cos(math.pi / 6) ** 2, rel=1e-3)
    # Both sides together equal the vertical force of the bearing, even if one is below 0.
    assert found.feet.sum(axis=0).min() > 0.7 * weight
    text = rigs.forces_drawn(found)
    assert text == rigs.forces_drawn(found)
    for name in ("F_x", "F_y", "N_y1", "N_y2"):
        assert name in text


def test_the_gauges_show_the_recorded_readings() -> None:
    text = rigs.gauges()
    for label in ("6 g, 12.7 mm wide", "23 g, 50.8 mm wide", "sensor 4"):
        assert label in text
    assert text == rigs.gauges()
    assert "143 rows" in rigs.gauges_sentence()


def test_slices_are_half_of_what_takes_more() -> None:
    """digit-parallel has 923 LUTs and 1544 flip-flops, which need at least 772 of 14336 slices."""
    scene = load_scene("digit-parallel")
    top = read_budget(budget_path(scene.path))["xc2v"][scene.twin().entity]
    (line,) = [x for x in thesis.resources().splitlines() if x.startswith("| 2:6:2, gradient")]
    shown = [cell.strip() for cell in line.split("|")]
    least = max(top["LUT"], top["flip-flop"]) / 2 / 14336
    assert shown[1:6] == ["2:6:2, gradient", "20", "13", "76", "353,000"]
    assert shown[6] == "digit-parallel"
    assert float(shown[7]) == pytest.approx(100 * least, abs=0.06)


def test_every_activation_stands_beside_the_printed_gates() -> None:
    found = {}
    for line in thesis.cells().splitlines()[2:]:
        name, gates, luts, _, multipliers, *_ = (
            cell.strip() for cell in line.strip("| ").split("|")
        )
        found[name] = (gates, int(luts), int(multipliers))
    gates = {"gradient": "44,000", "lut": "74,000", "pade": "33,000", "polynomial": "28,000"}
    assert {name: row[0] for name, row in found.items()} == gates
    # The page says this about them.
    assert found["gradient"][2] == found["lut"][2] == 1
    assert found["pade"][2] == max(row[2] for row in found.values())
    assert found["lut"][1] < found["pade"][1]


def test_a_record_does_not_hang_on_printed_figures(monkeypatch, tmp_path) -> None:
    """Nothing is trained on printed figures, but training data do count."""
    before = table_records.state("convergence")
    other = tmp_path / "thesis_numbers.toml"
    other.write_text("")
    monkeypatch.setattr(table_records, "NUMBERS", other)
    assert table_records.state("convergence") != before

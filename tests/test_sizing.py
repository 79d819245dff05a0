"""Estimated cells, the smallest design that suffices, and what hardware leaves out."""

import json
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from refused import call

from golden.common.block import walk
from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork
from tactus.export.exporter import MANIFEST, export
from tactus.report.page.summary import built
from tactus.rig.check import everything
from tactus.scene import Scene, load_scene, scene_names
from tactus.scene.building import compared
from tactus.sizing.candidates import CANDIDATES, Sized, kind_of
from tactus.sizing.features import block_rams, features_of, multipliers, table_luts
from tactus.sizing.model import Held, clock_of, held_out, placed, recorded
from tactus.synth.sizing import EXTRAS, networks, row_of
from tactus.synth.timing import read_timing
from tactus.verify.benches.written import write_scene
from tb.common.case_library import CASE
from tb.common.cases import FRONT_END, VISUALISATION, random_mlp

# What an estimate may be off, in per cent, on networks that it was not fitted to.
MOST_LUTS, MOST_FLIP_FLOPS = 15.0, 10.0


@pytest.fixture(scope="module")
def found() -> tuple[Scene, list[Sized]]:
    """The designs of a scene that every design takes, except that of learned functions."""
    scene = load_scene("digit-single")
    rows, refused = compared(scene)
    assert {one.candidate.design for one in refused} == {"table_graph"}
    return scene, rows


def auto(folder: Path, lines: str, *networks: DenseNetwork) -> Scene:
    """A small scene whose design is to be chosen."""
    networks = networks or [random_mlp((2, 3, 3), 1.0, 4)]
    path = write_scene(folder, "small", "exact", networks, design="auto", hardware=lines)
    kept = [line for line in path.read_text().splitlines() if not line.startswith("activation")]
    path.write_text("\n".join(kept))
    return load_scene(str(path))


def test_multipliers_and_block_rams_are_those_of_every_recorded_synthesis() -> None:
    entities = placed = 0
    for name, scene, core, cells in networks():
        # A block without a model, or whose products nobody counts, is refused; see below.
        for block in walk(core):
            with suppress(InputError):
                features_of(block)
                counts = multipliers(block), block_rams(block, "xc2v")
                entity = cells["xc2v"][block.entity]
                assert counts == (entity["multiplier"], entity["block RAM"]), (name, block.entity)
                entities += 1
        if scene.twin() == core and not scene.argmax:
            with suppress(InputError):
                features_of(core)
                counts = multipliers(core), block_rams(core, "ecp5")
                timing = read_timing(scene.path)[0]
                assert counts == (timing.multipliers, timing.block_rams), name
                placed += 1
    assert entities > 300
    assert placed > 20


def test_the_cells_that_are_fitted_are_those_of_the_budgets() -> None:
    kept = {row.network: row for row in recorded()}
    assert len(kept) == len(recorded())
    for name, scene, core, cells in networks():
        if name in kept:
            assert row_of(name, scene, core, cells) == kept.pop(name), name
    for extra in EXTRAS:
        assert features_of(extra.built()[1]) == kept.pop(extra.name).features, extra.name
    assert not kept


@pytest.mark.parametrize("one", held_out(), ids=lambda one: one.recorded.network)
def test_estimates_of_networks_that_were_held_out(one: Held) -> None:
    assert abs(one.percent) <= MOST_LUTS, one
    flip_flops = one.recorded.size.flip_flops
    assert one.estimated.flip_flops == pytest.approx(flip_flops, rel=MOST_FLIP_FLOPS / 100), one


def test_every_design_that_is_compared_was_placed_and_routed() -> None:
    ternary = kind_of("adder_graph", {"adder_operands": 3})
    assert all(map(placed, [ternary, *(one.design for one in CANDIDATES)]))


@pytest.mark.parametrize(
    ("luts", "inputs", "function"),
    [
        ([1], 4, lambda a, b, c, d: a ^ b ^ c ^ d),
        ([], 4, lambda a, b, c, d: 1),
        ([2], 5, lambda a, b, c, d, e: a ^ b ^ c ^ d ^ e),
        # Where the highest bit is 0, this is constant.
        ([1], 5, lambda a, b, c, d, e: a & (b ^ e)),
        # Two of the four functions of the last four bits are the same.
        ([3], 6, lambda a, b, c, d, e, f: (c & d, d, e | f, d)[2 * a + b]),
    ],
)
def test_luts_of_a_table_are_counted_from_its_bits(
    luts: list[int], inputs: int, function: Callable[..., int]
) -> None:
    """The bits of an address count from the highest one."""
    words = [function(*bits) for bits in product((0, 1), repeat=inputs)]
    assert table_luts(words, 1) == luts


def test_the_comparison_is_that_of_the_built_networks(found: tuple[Scene, list[Sized]]) -> None:
    scene, rows = found
    by_name = {row.candidate.name: row for row in rows}
    hybrid, codes = by_name["hybrid"], scene.vectors().codes
    assert (hybrid.clocks, hybrid.interval) == (
        scene.twin().clocks_after_samples,
        scene.twin().interval,
    )
    real = np.clip(scene.process_real(SIGNAL.to_real(codes)), -1, 1 - 2**-13) * 2**13
    apart = np.abs(scene.twin().process(codes) - real)
    assert hybrid.worst == pytest.approx(apart.max())
    assert hybrid.mean == pytest.approx(apart.mean())
    assert (rows[0].candidate.name, rows[0].multipliers) == ("engine, lanes 1", 1)


def test_a_clock_is_estimated_between_recorded_ones_alone() -> None:
    rows = placed("adder_graph")
    met = [row.routed.clock_mhz for row in rows]
    clocks = [clock_of(rows, path) for path in range(1, 6)]
    assert clocks == sorted(clocks, reverse=True)
    assert min(met) < clocks[-1] < clocks[0] < 1.01 * max(met)
    assert clock_of(rows, 6) is None
    one = [row for row in rows if row.network == "digit-fast"]
    assert clock_of(one, 5) == pytest.approx(one[0].routed.clock_mhz)
    assert clock_of(one, 1) is None


def test_auto_takes_the_cheapest_that_is_fast_enough(tmp_path: Path) -> None:
    scene = auto(tmp_path, "")
    rows, _ = compared(scene)
    prices = {row.candidate.name: scene.device.price(row) for row in rows}
    for row in rows:
        limited = auto(tmp_path, f"clocks = {row.clocks}\ninterval = {row.interval}")
        known, _ = compared(limited)
        assert {one.candidate.name for one in rows} <= {one.candidate.name for one in known}
        prices |= {one.candidate.name: scene.device.price(one) for one in known}
        fit = [o for o in known if o.clocks <= row.clocks and o.interval <= row.interval]
        assert (
            limited.choice.row.candidate.name
            == min((prices[one.candidate.name], one.clocks, one.candidate.name) for one in fit)[-1]
        )
        assert limited.twin().clocks_after_samples <= row.clocks
        assert limited.twin().interval <= row.interval


def test_auto_says_what_it_chose_and_what_is_beside_it(tmp_path: Path) -> None:
    fast = min(compared(auto(tmp_path, ""))[0], key=lambda row: row.clocks)
    scene = auto(tmp_path, f"clocks = {fast.clocks}")
    chosen, smaller, faster = scene.choice.lines()
    assert chosen.startswith(f"chosen: {fast.candidate.name}: {fast.clocks} clocks, a frame every")
    assert f"{scene.choice.smaller.clocks - fast.clocks} too many" in smaller
    assert faster == "next faster: none, no other design is faster"
    text = "\n".join(map(str, everything(scene, tmp_path / "build")))
    assert all(f"hardware.design auto: {line}" in text for line in (chosen, smaller, faster))
    (first, *_, said, _, _) = built(scene, scene.twin())
    assert f", {fast.candidate.design}, activation" in first
    assert said.startswith("Chosen: ")


def test_a_rate_is_an_interval_at_the_clock(tmp_path: Path) -> None:
    scene = auto(tmp_path, "clock_mhz = 10\nframes_a_second = 1000000")
    assert scene.demand.interval == 10
    assert scene.twin().interval <= 10


def test_the_price_is_the_sum_of_shares_of_the_device(tmp_path: Path) -> None:
    choice = auto(tmp_path, 'device = "LFE5U-25F"').choice
    cells = choice.row.cells("ecp5")
    share = 100 * (cells.luts / 24288 + cells.multipliers / 28 + cells.block_rams / 56)
    assert choice.lines()[0].endswith(f", {share:.3g} % of LFE5U-25F")
    small = replace(choice, device=replace(choice.device, block_rams=1))
    assert small.lines()[0].endswith("% of LFE5U-25F, in which it does not fit")


def auto_tables(folder: Path, lines: str) -> Scene:
    """A small scene of learned functions whose design is to be chosen."""
    return auto(folder, lines, *CASE["rails-tables"].networks())


def test_small_tables_are_compared_for_learned_functions(tmp_path: Path) -> None:
    rows, refused = compared(auto_tables(tmp_path, ""))
    assert {one.candidate.design for one in refused} == {
        *("engine", "hybrid", "parallel", "adder_graph")
    }
    engines = [one.candidate.options for one in refused if one.candidate.design == "engine"]
    assert all(options["lanes"] > 1 for options in engines)
    tables = {row.candidate.name: row for row in rows if row.candidate.design == "table_graph"}
    assert list(tables) == [f"table_graph, adders_per_clock {count}" for count in (5, 2, 1)]
    for row in tables.values():
        cells = row.cells("xc2v")
        assert (cells.multipliers, cells.block_rams, row.interval) == (0, 0, 1)
        assert row.clocks == row.network.clocks_after_samples
        assert row.worst > max(one.worst for one in rows if one.candidate.design == "engine")
    luts, flip_flops, clocks = zip(
        *((row.size.luts, row.size.flip_flops, row.clocks) for row in tables.values()), strict=True
    )
    assert list(flip_flops) == sorted(flip_flops)
    assert list(clocks) == sorted(clocks)
    assert max(luts) < 1.1 * min(luts)


def test_a_design_that_no_placed_network_has_is_not_estimated(tmp_path: Path, capsys) -> None:
    networks, hardware = CASE["rails-tables"].networks(), "adder_operands = 3"
    path = write_scene(
        tmp_path,
        "mine",
        "exact",
        networks,
        "single",
        "precise",
        design="table_graph",
        hardware=hardware,
    )
    call("designs", path, "--family", "ecp5")
    said = capsys.readouterr().out
    assert "table_graph: not possible: no network with these options was placed" in said
    assert said.count("table_graph") == 1


def test_auto_takes_small_tables_where_nothing_else_is_fast_enough(tmp_path: Path) -> None:
    fast = auto_tables(tmp_path, "interval = 1")
    row = fast.choice.row
    assert row.candidate.design == "table_graph"
    assert fast.choice.lines()[0].endswith(f"errors of 2^-13 times {row.mean:.3g} on average")
    assert fast.twin().interval == 1
    # They are cheaper than an engine with its block RAMs, and still not chosen.
    scene = auto_tables(tmp_path, "")
    assert scene.choice.row.candidate.design == "engine"
    chosen, smaller, _ = scene.choice.lines()
    assert "errors of" not in chosen
    assert smaller.startswith(f"next smaller: {scene.choice.smaller.candidate.name} at ")
    assert "is further from the networks: errors of 2^-13 times" in smaller


def test_auto_names_the_nearest_design_where_none_is_fast_enough(tmp_path: Path) -> None:
    fastest = "expected .* or more, which the nearest design, .*, takes from the last sample"
    with pytest.raises(InputError, match=rf"small\.toml: hardware.clocks: got 1, {fastest}"):
        auto(tmp_path, "clocks = 1").twin()


def exported(scene: Scene, folder: Path) -> tuple[set[str], str]:
    """The names of the blocks, and the text of all VHDL of a scene."""
    folder = folder / scene.name
    export(scene, "vhdl", folder)
    blocks = {entry["block"] for entry in json.loads((folder / MANIFEST).read_text())}
    return blocks, "\n".join(p.read_text() for p in sorted(folder.glob("*.vhd")))


def same_results(scene: Scene) -> None:
    whole, lean = scene.twin(lean=False), scene.twin()
    rng = np.random.default_rng(3)
    frames = rng.integers(SIGNAL.low, SIGNAL.high + 1, (3000, lean.inputs))
    assert (whole.process(frames) == lean.process(frames)).all()


def with_zeros() -> DenseNetwork:
    """A network in which no output uses node 2, and some other weights are 0."""
    mlp = random_mlp((3, 4, 2), 1.0, 3)
    first, second = mlp.layers
    first.weights[0, 1] = first.weights[3, 0] = 0
    second.weights[:, 2] = second.weights[0, 1] = 0
    return mlp


@pytest.mark.parametrize("name", scene_names())
def test_results_are_those_of_the_whole(name: str) -> None:
    same_results(load_scene(name))


def test_segments_that_no_neuron_reaches(tmp_path: Path) -> None:
    path = write_scene(tmp_path, "few", "exact", [random_mlp((2, 2, 1), 0.2, 1)])
    scene = load_scene(str(path))
    same_results(scene)
    whole, lean = scene.twin(lean=False).activations[0], scene.twin().activations[0]
    saved = lean.parts_left_out()["comparators of segments no neuron reaches"]
    assert saved == len(whole.table.thresholds) - len(lean.table.thresholds) > 0
    _, text = exported(scene, tmp_path)
    assert len(re.findall(r"signed\(resize\(in_mag|in_mag > ", text)) < len(whole.table.thresholds)


@pytest.mark.parametrize("name", ["hybrid", "parallel"])
def test_hidden_nodes_and_multipliers_that_no_output_uses(tmp_path: Path, name: str) -> None:
    path = write_scene(tmp_path, "idle", "exact", [with_zeros()], design=name)
    scene = load_scene(str(path))
    same_results(scene)
    design = scene.twin()
    assert len(design.activations) == 3
    assert "1 hidden nodes whose weights to the outputs are 0" in design.left_out()
    _, text = exported(scene, tmp_path)
    node = r"u_input_node_\d+: entity" if name == "hybrid" else r"entity neuron_q\w+ is"
    assert len(re.findall(node, text)) == 3
    if name == "parallel":
        assert "3 multipliers of weights that are 0" in design.left_out()
        weights = [w for n in (*design.hidden_neurons, *design.output_neurons) for w in n.weights]
        assert weights.count(0) == 3
        assert len(re.findall(r"weigh\d+_product <= ", text)) == len(weights) - 3


def test_front_end_and_profile_that_the_scene_does_not_name(tmp_path: Path) -> None:
    mlp = random_mlp((2, 3, 4), 1.0, 1)
    found = {}
    for name, sections in (("bare", ""), ("full", VISUALISATION + FRONT_END)):
        path = write_scene(tmp_path, name, "exact", [mlp], sections=sections)
        scene = load_scene(str(path))
        found[name] = exported(scene, tmp_path)[0], scene.twin().process(np.full((1, 2), 99))
    bare, full = found["bare"][0], found["full"][0]
    assert full - bare == {
        *("instrument", "readout", "scan_sequencer", "load_profile", "ramp", "divider"),
        *("power_fold", "exp_memory", "exp_interpolator"),
    }
    assert (found["bare"][1] == found["full"][1]).all()


@pytest.mark.all_only
@pytest.mark.usefixtures("yosys")
def test_the_savings_are_those_of_two_builds(tmp_path: Path, capsys) -> None:
    path = write_scene(tmp_path, "idle", "exact", [with_zeros()], activation="precise")
    call("lean", path)
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[-3:]]
    whole, found, saved = ([int(n) for n in row[-5:]] for row in rows)
    assert [a - b for a, b in zip(whole, found, strict=True)] == saved
    # These are the cells of the node and its activation. Yosys itself removes its products of 0.
    assert saved[3] == 2

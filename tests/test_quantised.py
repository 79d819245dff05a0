"""Quantised networks: read from ONNX, and the same on the engine to the last bit.

The judge evaluates the graph node by node: ONNX's reference implementation, to which stands here
what the operators of QONNX are.
"""

import re
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import onnx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator
from onnx.reference.op_run import OpRun
from test_engine import frames_of
from test_network_files import QONNX, graph

from golden.engine.neurons import graph_of
from golden.engine.quantise import integer_networks
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.networks.oracle import exact
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork
from tactus.network_files.network_file import load_network, write_network
from tactus.report.page.summary import built
from tactus.scene import Scene, load_scene
from tactus.scene.codes import file_codes, quantised_lines
from tactus.scene.scale import Scale, on_signals
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_network


def quant(taken: str, parameters: str, given: str, **attributes):
    """A Quant, of whose parameters the names begin with ``parameters``."""
    names = [taken, *(f"{parameters}_{key}" for key in ("scale", "zero", "bits"))]
    settings = {"signed": 1, "narrow": 0, "rounding_mode": "ROUND"} | attributes
    return helper.make_node("Quant", names, [given], f"my_{given}", domain=QONNX, **settings)


class Quant(OpRun):
    """The operator as QONNX defines it."""

    op_domain = QONNX

    def _run(self, x, scale, zero, bits, signed=1, narrow=0, rounding_mode="ROUND"):
        low = narrow - 2 ** (bits - 1) if signed else 0
        high = 2 ** (bits - 1) - 1 if signed else 2**bits - 1 - narrow
        rounded = {
            "ROUND": np.round,
            "FLOOR": np.floor,
            "HALF_UP": lambda v: np.sign(v) * np.floor(np.abs(v) + 0.5),
        }[rounding_mode](x / scale + zero)
        return ((np.clip(rounded, low, high) - zero) * scale,)


class BipolarQuant(OpRun):
    op_domain = QONNX

    def _run(self, x, scale):
        return (np.where(x >= 0, scale, -scale),)


def node_by_node(path: Path, x: np.ndarray) -> np.ndarray:
    """What a graph with operators of QONNX gives, as their definitions say."""
    (found,) = ReferenceEvaluator(str(path), new_ops=[Quant, BipolarQuant]).run(None, {"x": x})
    return found


@dataclass(frozen=True)
class Plan:
    """A random network of QONNX: bits of what stands behind each hidden layer, and how."""

    shape: tuple[int, ...] = (2, 3, 3, 2)
    bits: int = 4
    signed: tuple[bool, ...] = (False, False)
    relu: tuple[bool, ...] = (True, True)
    zeros: tuple[int, ...] = (0, 0)
    scales: tuple[int, ...] = (3, 3)
    weight_bits: int = 4
    rounding: str = "ROUND"
    of_samples: bool = False
    seed: int = 1
    # The unit of the samples, and by what the scale of each layer's weights is no power of two.
    unit: float = 1.0
    odds: tuple[int, ...] = ()
    # BipolarQuant behind each hidden layer, and for the samples where they have a quantiser.
    bipolar: bool = False

    @property
    def units(self) -> list[float]:
        """The units of the samples and of each layer's sums, but for powers of two."""
        odds = self.odds or (1,) * (len(self.shape) - 1)
        return [self.unit * float(np.prod(odds[:n])) for n in range(len(odds) + 1)]

    def save(self, folder: Path) -> Path:
        rng = np.random.default_rng(self.seed)
        nodes, constants, value = [], {}, "x"

        def parameters(name, scale, zero, bits):
            constants.update(
                {f"{name}_scale": scale, f"{name}_zero": float(zero), f"{name}_bits": float(bits)}
            )

        if self.of_samples and self.bipolar:
            constants["s_scale"] = self.unit / 2
            nodes.append(helper.make_node("BipolarQuant", ["x", "s_scale"], ["xq"], domain=QONNX))
            value = "xq"
        elif self.of_samples:
            parameters("s", self.unit * 2.0 ** (1 - self.bits), 0, self.bits)
            nodes.append(quant("x", "s", "xq", rounding_mode=self.rounding))
            value = "xq"
        for n, (inputs, outputs) in enumerate(pairwise(self.shape), start=1):
            odd, unit = self.units[n] / self.units[n - 1], self.units[n]
            constants[f"w{n}"] = rng.normal(0, 0.7, (inputs, outputs)) * odd
            constants[f"b{n}"] = rng.normal(0, 0.5, outputs) * unit
            # A scale for each node.
            scale = 2.0 ** -rng.integers(self.weight_bits - 2, self.weight_bits, (1, outputs))
            parameters(f"w{n}", scale * round(odd), 0, self.weight_bits)
            parameters(f"b{n}", 2.0**-9 * unit, 0, 12)
            nodes += [
                quant(f"w{n}", f"w{n}", f"wq{n}", narrow=1),
                quant(f"b{n}", f"b{n}", f"bq{n}"),
                helper.make_node("MatMul", [value, f"wq{n}"], [f"m{n}"]),
                helper.make_node("Add", [f"m{n}", f"bq{n}"], [f"a{n}"]),
            ]
            value = f"a{n}"
            if n == len(self.shape) - 1:
                nodes[-1].output[0] = "y"
                break
            if self.bipolar:
                constants[f"q{n}_scale"] = unit * 2.0 ** -self.scales[n - 1]
                signs = [value, f"q{n}_scale"]
                nodes.append(helper.make_node("BipolarQuant", signs, [f"q{n}"], domain=QONNX))
                value = f"q{n}"
                continue
            signed, relu = self.signed[n - 1], self.relu[n - 1]
            if relu:
                nodes.append(helper.make_node("Relu", [value], [f"r{n}"]))
                value = f"r{n}"
            # Of a ReLU half of the signed codes are met.
            bits = self.bits + (relu and signed)
            scale = unit * 2.0 ** -self.scales[n - 1]
            parameters(f"q{n}", scale, self.zeros[n - 1] * (not relu), bits)
            nodes.append(
                quant(value, f"q{n}", f"q{n}", signed=int(signed), rounding_mode=self.rounding)
            )
            value = f"q{n}"
        return graph(folder, nodes, constants, self.shape[0])


@st.composite
def plans(draw: st.DrawFn) -> Plan:
    hidden = draw(st.integers(1, 3))
    bits = draw(st.integers(2, 8))
    several = {"min_size": hidden, "max_size": hidden}
    rounding = draw(st.sampled_from(["ROUND", "FLOOR", "HALF_UP"]))
    booleans = st.lists(st.booleans(), **several)
    signed, relu = tuple(draw(booleans)), tuple(draw(booleans))
    if rounding == "HALF_UP":
        # Halves away from 0 are halves up where nothing is below it.
        relu = tuple(one or other for one, other in zip(relu, signed, strict=True))
    return Plan(
        tuple(draw(st.lists(st.integers(1, 5), min_size=hidden + 2, max_size=hidden + 2))),
        bits,
        signed,
        relu,
        tuple(draw(st.lists(st.integers(0, 3), **several))),
        tuple(draw(st.lists(st.integers(bits - 2, bits + 1), **several))),
        draw(st.integers(2, 8)),
        rounding,
        draw(st.booleans()) and rounding != "HALF_UP",
        draw(st.integers(0, 999)),
        draw(st.sampled_from([1.0, 3.0, float(np.float32(0.1)), float(np.float32(0.7))])),
        tuple(draw(st.lists(st.sampled_from([1, 3, 5]), min_size=hidden + 1, max_size=hidden + 1))),
        draw(st.booleans()),
    )


def as_output(values: np.ndarray) -> np.ndarray:
    """Codes of the outputs: rounded half up and saturated, once."""
    return np.clip(np.floor(values * 2**SIGNAL.frac + 0.5), SIGNAL.low, SIGNAL.high)


def hidden_codes(network: DenseNetwork, codes: np.ndarray) -> list[np.ndarray]:
    """The codes of each hidden layer in whole numbers."""
    (whole,) = integer_networks("single", [network])
    return whole.hidden_codes(codes)


@settings(max_examples=30)
@given(plan=plans())
def test_a_network_of_qonnx_is_exact_on_the_engine(tmp_path_factory, plan: Plan) -> None:
    path = plan.save(tmp_path_factory.mktemp("qonnx"))
    codes = frames_of(plan.shape[0])
    samples = SIGNAL.to_real(codes)
    expected = node_by_node(path, samples * plan.unit)
    held = load_network(path, (plan.shape[0], 0, plan.shape[-1]))
    assert np.array_equal(held.process(samples * plan.unit), expected)
    # In units of the samples and of the outputs, all ratios of scales are powers of two.
    units = [Scale(factor=plan.unit)] * plan.shape[0], [Scale(factor=plan.units[-1])]
    network, expected = on_signals(held, *units), expected / plan.units[-1]
    for ours, theirs in zip(
        hidden_codes(network, codes), file_codes(held, samples * plan.unit), strict=True
    ):
        assert np.array_equal(ours, theirs)
    engine = Engine.of([network])
    found = engine.process(codes)
    assert np.array_equal(found, as_output(expected))
    assert np.array_equal(found, exact(engine, codes))


def linear(name: str, value: str, codes: np.ndarray, scale: float, constants) -> list:
    """Weights as bytes with a zero point, and the product with them."""
    constants |= {f"{name}_c": codes, f"{name}_s": np.float32(scale), f"{name}_z": np.int8(3)}
    return [
        helper.make_node(
            "DequantizeLinear", [f"{name}_c", f"{name}_s", f"{name}_z"], [f"{name}_d"]
        ),
        helper.make_node("MatMul", [value, f"{name}_d"], [f"{name}_m"]),
    ]


def behind(name: str, value: str, scale: float, zero, constants) -> list:
    """QuantizeLinear and DequantizeLinear behind a layer."""
    constants |= {f"{name}_qs": np.float32(scale), f"{name}_qz": zero}
    names = [f"{name}_qs", f"{name}_qz"]
    return [
        helper.make_node("QuantizeLinear", [value, *names], [f"{name}_q"], f"my_{name}"),
        helper.make_node("DequantizeLinear", [f"{name}_q", *names], [f"{name}_y"]),
    ]


@pytest.mark.parametrize("zero", [np.uint8(0), np.uint8(128), np.int8(0), np.int8(-128)])
@pytest.mark.parametrize("seed", range(4))
def test_a_network_of_bytes_is_exact_on_the_engine(tmp_path: Path, zero, seed: int) -> None:
    """QuantizeLinear and DequantizeLinear, behind the outputs too, judged by ONNX in floats."""
    rng = np.random.default_rng(seed)
    constants: dict[str, np.ndarray] = {"b": np.float32(rng.integers(-99, 99, 4) / 2**8)}
    nodes = [
        *behind("x", "x", 2**-7, np.int8(0), constants),
        *linear("w1", "x_y", rng.integers(-90, 90, (3, 4), np.int8), 2**-6, constants),
        helper.make_node("Add", ["w1_m", "b"], ["a"]),
        *behind("h", "a", 2**-5, zero, constants),
        *linear("w2", "h_y", rng.integers(-50, 90, (4, 2), np.int8), 2**-8, constants),
        *behind("o", "w2_m", 2**-6, zero, constants),
    ]
    nodes[-1].output[0] = "y"
    path = graph(tmp_path, nodes, constants, 3, TensorProto.FLOAT)
    codes = frames_of(3, 300)
    samples = SIGNAL.to_real(codes).astype(np.float32)
    (expected,) = ReferenceEvaluator(str(path)).run(None, {"x": samples})
    network = load_network(path, (3, 0, 2))
    assert network.shape == (3, 3, 4, 2, 2)
    engine = Engine.of([network])
    assert np.array_equal(engine.process(codes), as_output(expected))
    assert len(np.unique(expected)) > 5


def changed(path: Path, name: str, value) -> Path:
    """Another constant in a graph."""
    model = onnx.load(str(path))
    for constant in model.graph.initializer:
        if constant.name == name:
            constant.CopyFrom(numpy_helper.from_array(np.asarray(value), name))
    onnx.save(model, str(path))
    return path


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("q1_scale", 0.3, "layer 1: 6 of 6 weights would be rounded, such as .* of the smallest"),
        ("q2_zero", 1.0, r"layer 2: got 15 codes, 1 to 15, expected a power of two, 2 to 65536"),
        ("q2_bits", 5.0, "quantisers: got layers of 4 bits, halves to even and of 5 bits, halves"),
        (
            "w2_scale",
            0.3,
            r"layer 2: \d of 9 weights would be rounded, .* step; expected scales of",
        ),
        ("b2_scale", 2.0**-40, "layer 2: 3 of 3 biases would be rounded, such as .* step; exp"),
        ("q1_scale", 2.0**20, r"layer 1: got the scale 1.04858e\+06, expected 8192 at most"),
        ("q1_scale", [0.5, 0.25, 0.5], r"operator Quant \('my_q1'\): got a scale .* one for all"),
        ("q1_scale", -1.0, r"behind layer 1: operator Quant .*: scale: got -1.0, expected a num"),
        ("q1_bits", 0.5, "operator Quant .*: got 0.5 bits, expected a whole number from 1 to 32"),
        ("q1_zero", 0.5, "operator Quant .*: got the zero point 0.5, expected a whole number"),
        ("w1_scale", 0.0, r"operator Quant \('my_wq1'\): got a scale that is not above 0"),
        ("w1_zero", 0.5, r"operator Quant \('my_wq1'\): got the zero point 0.5, expected a whole"),
    ],
)
def test_a_quantiser_is_refused_by_layer_and_node(tmp_path: Path, name, value, message) -> None:
    path = changed(Plan().save(tmp_path), name, value)
    if name == "b2_scale":
        changed(path, "b2_bits", 32.0)
        changed(path, "b2", [2.0**-40] * 3)
    with pytest.raises(InputError, match=message):
        graph_of(integer_networks("single", [load_network(path, (2, 0, 2))]))


@pytest.mark.parametrize("name", ["my_wq1", "my_q1"])
def test_a_rounding_that_no_quantiser_has_is_refused(tmp_path: Path, name: str) -> None:
    path = Plan().save(tmp_path)
    model = onnx.load(str(path))
    (node,) = (one for one in model.graph.node if one.name == name)
    (mode,) = (one for one in node.attribute if one.name == "rounding_mode")
    mode.s = b"CEIL"
    onnx.save(model, str(path))
    with pytest.raises(InputError, match=rf"\('{name}'\): got the rounding mode CEIL, expected"):
        load_network(path, (2, 0, 2))


def test_quantisers_are_kept_in_an_npz_alone(tmp_path: Path) -> None:
    network = load_network(Plan(of_samples=True).save(tmp_path), (2, 0, 2))
    write_network(tmp_path / "other.npz", network)
    found = load_network(tmp_path / "other.npz", (2, 0, 2))
    assert [x.quantiser for x in found.layers] == [x.quantiser for x in network.layers]
    assert found.quantised
    for form, words in (("onnx", "quantised network"), ("mat", "network with hidden layers")):
        with pytest.raises(InputError, match=f"other.{form}: got a {words}"):
            write_network(tmp_path / f"other.{form}", network)
    with np.load(tmp_path / "other.npz") as archive:
        arrays = {name: archive[name] for name in archive.files}
    for rows, message in (
        (arrays["quantisers"][:-1], r"got shape \(2, 6\), expected \(3, 6\)"),
        (arrays["quantisers"] * 0.5, "expected a scale, whole numbers for the zero point"),
        (-arrays["quantisers"] * [1, 0, 0, 0, 0, 0], "scale: got -0.125, expected"),
    ):
        np.savez(tmp_path / "other.npz", **(arrays | {"quantisers": rows}))
        with pytest.raises(InputError, match=f"other.npz: quantisers: .*{message}"):
            load_network(tmp_path / "other.npz", (2, 0, 2))


def scene_of(tmp_path: Path) -> Path:
    """A scene with the network in net.onnx, readings of -4 to 4 and outputs of -8 to 8."""
    network = random_network((2, 3, 3, 2), ("relu", "relu"), 1.0, 1)
    path = write_scene(tmp_path, "exact", "exact", [network], activation="precise", design="engine")
    text = path.read_text().replace('"exact.npz"', '"net.onnx"')
    scale = ", ".join(
        f"{n} = {{ factor = {4 if n < 'y' else 8} }}" for n in ("x0", "x1", "y0", "y1")
    )
    path.write_text(text.replace("[network]", f"scale = {{ {scale} }}\n[network]"))
    return path


@pytest.mark.parametrize("of_samples", [False, True])
def test_a_quantised_network_in_a_scene(tmp_path: Path, of_samples: bool) -> None:
    """Every scale is a power of two. Readings are those of the file, before they become samples."""
    path = scene_of(tmp_path)
    Plan(of_samples=of_samples).save(tmp_path)
    path.write_text(re.sub("(?m)^(hidden = ).*", r"\g<1>0", path.read_text()))
    scene = load_scene(str(path))
    (held,) = scene.networks()
    assert held.quantised
    codes = frames_of(2)
    expected = node_by_node(tmp_path / "net.onnx", 4 * SIGNAL.to_real(codes)) / 8
    assert np.array_equal(scene.twin().process(codes), as_output(expected))
    (line,) = quantised_lines(scene)
    vectors = scene.vectors()
    frames, inputs = len(vectors.codes), vectors.inputs
    before, after = (
        np.concatenate(list(file_codes(scene.members[0].load(), 4 * x)), axis=1)
        for x in (inputs, SIGNAL.to_real(vectors.codes))
    )
    assert line == (
        f"net.onnx: 0 of {before.size} codes of {frames} recorded frames differ from those of the "
        f"file; readings are rounded to 14 bits before, which changes {(before != after).sum()} of "
        "them"
    )
    assert f"{line}." in built(scene, scene.twin()), "the name of a file keeps its letters"
    path.write_text(path.read_text().replace("factor = 4", "factor = 4.1"))
    with pytest.raises(InputError, match=r"exact.toml: layer 1: \d of \d weights .* powers of two"):
        load_scene(str(path)).twin()


def test_the_nearest_network_and_how_many_codes_differ(tmp_path: Path, monkeypatch) -> None:
    """What is refused is accepted if the scene says so, and what it costs is counted."""
    path = scene_of(tmp_path)
    Plan(bits=8).save(tmp_path)
    changed(changed(tmp_path / "net.onnx", "q1_scale", 0.0123), "q2_scale", 0.0456)
    with pytest.raises(InputError, match=r'layer 1: .* would be rounded.*quantised = "nearest"$'):
        load_scene(str(path)).twin()
    path.write_text(path.read_text().replace("[network]", '[network]\nquantised = "nearest"'))
    scene = load_scene(str(path))
    codes = frames_of(2, 2000)
    vectors = SimpleNamespace(codes=codes, inputs=SIGNAL.to_real(codes))
    monkeypatch.setattr(Scene, "vectors", lambda self: vectors)
    (network,), (held,) = scene.networks(), [member.load() for member in scene.members]
    found = np.concatenate(hidden_codes(network, codes), axis=1)
    expected = np.concatenate(list(file_codes(held, 4 * SIGNAL.to_real(codes))), axis=1)
    differ = (found != expected).sum()
    assert 0 < differ < 0.02 * found.size
    assert np.abs(found - expected).max() == 1
    (line,) = quantised_lines(scene)
    assert line.startswith(f"net.onnx: {differ} of {found.size} codes of {len(codes)} recorded")
    assert "by 1 at most: " in line
    # The outputs of the engine are what the last layer makes of these very codes.
    last = network.layers[-1]
    values = found[:, 3:] * 0.0456 @ last.weights.T + last.biases
    engine = Engine.of([network])
    assert np.abs(engine.process(codes) - as_output(values)).max() <= 1
    assert np.array_equal(engine.process(codes[::50]), exact(engine, codes[::50]))


@pytest.mark.parametrize(
    "change", [{"scale": 0.3}, {"zero": 3, "before_zero": True}, {"rounding": "away"}]
)
def test_what_only_the_nearest_network_can_hold(tmp_path: Path, change: dict) -> None:
    """Other roundings of halves, too."""
    path = Plan(shape=(2, 3, 2), signed=(True,), relu=(False,), zeros=(2,)).save(tmp_path)
    first, last = load_network(path, (2, 0, 2)).layers
    first = replace(first, quantiser=replace(first.quantiser, **change))
    network = DenseNetwork((first, last))
    nearest = replace(first, quantiser=replace(first.quantiser, nearest=True))
    found = hidden_codes(DenseNetwork((nearest, last)), frames_of(2))
    expected = list(file_codes(network, SIGNAL.to_real(frames_of(2))))
    assert np.abs(found[0] - expected[0]).max() <= 1
    assert len(np.unique(found[0])) > 5
    with pytest.raises(InputError, match=r'layer 1: .* or network.quantised = "nearest"$'):
        Engine.of([network])

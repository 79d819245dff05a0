"""Networks as ONNX graphs: a chain of dense layers, with an activation behind each but the last.

Operators that scale each value by itself (samples, hidden nodes or outputs), BatchNormalization
too, are folded into the layer that follows, or into the one before. Behind the last layer, the end
of a classifier may stand.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator

from golden.input_error import InputError, naming
from golden.numbers.real import Real
from golden.trained.dense import LEAK, DenseNetwork, Quantiser, shifted
from golden.trained.function import TABLE, Function
from tactus.core.files import reading
from tactus.network_files import classifier, quantisers
from tactus.network_files.parsed import ParsedLayer, ParsedNetwork, real_numbers

# For each operator its expression, with its attributes in brackets.
EXPRESSIONS = {
    "Celu": "max(x, 0) + min(0, ({alpha}) * (exp(x / ({alpha})) - 1))",
    "Cos": "cos(x)",
    "Elu": "x if x > 0 else ({alpha}) * (exp(x) - 1)",
    "Erf": "erf(x)",
    "Gelu": "0.5 * x * (1 + erf(x / sqrt(2)))",
    "HardSigmoid": "max(0, min(1, ({alpha}) * x + ({beta})))",
    "HardSwish": "x * max(0, min(1, x / 6 + 0.5))",
    "Mish": "x * tanh(max(x, 0) + log(1 + exp(-abs(x))))",
    "Selu": "({gamma}) * (x if x > 0 else ({alpha}) * (exp(x) - 1))",
    "Sin": "sin(x)",
    "Softplus": "max(x, 0) + log(1 + exp(-abs(x)))",
    "Softsign": "x / (1 + abs(x))",
}
# What stands for an attribute that a file leaves out.
DEFAULTS = {
    "Celu": {"alpha": 1.0},
    "Elu": {"alpha": 1.0},
    "HardSigmoid": {"alpha": 0.2, "beta": 0.5},
    "Selu": {"alpha": 1.6732631921768188, "gamma": 1.0507010221481323},
}
# Gelu with the attribute approximate = "tanh".
GELU_OF_TANH = "0.5 * x * (1 + tanh(sqrt(2 / pi) * (x + 0.044715 * x ** 3)))"

# Whatever their order in the file, weights are described with nodes in rows.
TRANSPOSED = False
LINEAR = ("Gemm", "MatMul")
ELEMENTWISE = ("Add", "Sub", "Mul", "Div", "Scaler", "BatchNormalization")
# For each operator, the name of its activation in tactus.
ACTIVATIONS = {
    "Tanh": "tanh",
    "Sigmoid": "sigmoid",
    "Relu": "relu",
    "LeakyRelu": "leaky_relu",
    "PRelu": "leaky_relu",
    "Clip": "hard_tanh",
}
# For each operator, the numbers of inputs that it may have.
OPERATORS: dict[str, tuple[int, ...]] = {
    **dict.fromkeys((*LINEAR, *ELEMENTWISE, "Reshape"), (2,)),
    **dict.fromkeys((*ACTIVATIONS, *EXPRESSIONS, "Cast", "Identity", "Flatten"), (1,)),
    "Gemm": (2, 3),
    "Scaler": (1,),
    "BatchNormalization": (5,),
    "PRelu": (2,),
    "Clip": (1, 2, 3),
}
# The reasons why some other operators are not supported.
CONVOLUTION = "tactus is for dense networks and has no convolution"
RECURRENT = "tactus is for dense networks and has none that keep a state"
RANDOM = "a network must be the same whenever its file is read"
REASONS = {
    **dict.fromkeys(("Conv", "ConvTranspose", "MaxPool", "AveragePool"), CONVOLUTION),
    **dict.fromkeys(("LSTM", "GRU", "RNN", "Loop", "Scan"), RECURRENT),
    **dict.fromkeys(("RandomNormal", "RandomNormalLike", "RandomUniform"), RANDOM),
    **dict.fromkeys(("RandomUniformLike", "Bernoulli", "Multinomial"), RANDOM),
}
# For each attribute the type that it must have.
ATTRIBUTES: dict[str, type] = {
    **dict.fromkeys(("alpha", "beta", "gamma", "epsilon", "min", "max"), float),
    **dict.fromkeys(("transA", "transB", "training_mode", "axis", "to"), int),
    **dict.fromkeys(("offset", "scale"), list),
    "approximate": str,
}
# An operator may make so many constants, far more than any hardware has weights.
MOST_NUMBERS = 10**7
# What a Cast may make of numbers.
FLOATS = ("FLOAT", "DOUBLE", "FLOAT16", "BFLOAT16")
# These are old enough for every runtime in use, and new enough for every operator used here.
OPSET, IR_VERSION = 13, 7


class _Chain:
    """The layers found so far, from the graph's input onwards."""

    def __init__(self, path: Path):
        self.path = path
        # The operator that is read.
        self.node: Any = None
        # What follows may still change the last of them.
        self.layers: list[ParsedLayer] = []
        # Whether the last one has its activation.
        self.activated = False
        # The values before the next layer are factor * x + shift, each by itself.
        self.factor, self.shift = np.ones(1), np.zeros(1)
        # Of the samples, whose number a layer tells, with the factor and the shift in front.
        self.first: tuple[Quantiser, Real, Real] | None = None
        # Whether what comes next are codes, until a DequantizeLinear.
        self.coded: Quantiser | None = None
        # The functions of activations that are tables, by name.
        self.functions: dict[str, Function] = {}

    def refuse(self, reason: str, node: Any = None) -> InputError:
        """The error about an operator, which is the one that is read if no other is given."""
        node = self.node if node is None else node
        place = f"behind layer {len(self.layers)}: " if self.layers else ""
        return InputError(f"{self.path}: {place}operator {node.op_type} ({node.name!r}): {reason}")

    def width(self) -> int:
        if not self.layers:
            raise self.refuse("stands in front of every layer, expected it behind the last")
        return len(self.layers[-1].biases)

    def linear(self, weights: Real, bias: Real) -> None:
        """Add a layer, into which the scaling before it is folded."""
        width = weights.shape[1]
        if self.layers and width != self.width():
            given = self.width()
            hint = "; they are transposed" if len(weights) == given else ""
            raise self.refuse(
                f"got weights of {width} values, expected {given}, as many as come{hint}"
            )
        if self.first:
            quantiser, factor, shift = self.first
            self.first = None
            behind, (self.factor, self.shift) = (self.factor, self.shift), (factor, shift)
            self.linear(np.eye(width), np.zeros(width))
            self.quantise(quantiser)
            self.factor, self.shift = behind
        factor, shift = (self.wide(v, width) for v in (self.factor, self.shift))
        self.factor, self.shift = np.ones(1), np.zeros(1)
        self.layers.append(ParsedLayer(weights * factor, shifted(bias, weights, shift)))
        self.activated = False

    def activate(self, activation: str, leak: float) -> None:
        if not self.layers or self.activated:
            where = "behind another activation" if self.layers else "in front of every layer"
            raise self.refuse(f"stands {where}, expected it behind a Gemm or MatMul")
        if not 0 <= leak <= 1:
            raise self.refuse(f"got the slope {leak:g} below 0, expected 0 to 1")
        self.layers[-1].activation, self.layers[-1].leak = activation, leak
        self.activated = True

    def look_up(self, function: Function) -> None:
        if self.functions.get(function.name, function) != function:
            # The same operator with other attributes.
            function = replace(function, name=f"{function.name}_{len(self.layers)}")
        self.functions[function.name] = function
        self.activate(TABLE + function.name, LEAK)

    def quantise(self, quantiser: Quantiser) -> None:
        """The quantiser behind the last layer; of samples it becomes a layer of its own."""
        if self.first or (self.layers and self.layers[-1].quantiser):
            raise self.refuse("stands behind another quantiser, expected a layer between")
        if not self.layers:
            self.first = quantiser, self.factor, self.shift
            self.factor, self.shift = np.ones(1), np.zeros(1)
            return
        self.layers[-1].quantiser = quantiser
        self.activated = True

    def elementwise(self, factor: Real, shift: Real) -> None:
        """Multiply each value by its factor, and add its shift."""
        if self.layers and not self.activated:
            layer = self.layers[-1]
            factor, shift = (self.wide(v, len(layer.biases)) for v in (factor, shift))
            layer.weights = layer.weights * factor[:, np.newaxis]
            layer.biases = layer.biases * factor + shift
        else:
            width = max(len(v) for v in (self.factor, self.shift, factor, shift))
            old, before = (self.wide(v, width) for v in (self.factor, self.shift))
            factor, shift = (self.wide(v, width) for v in (factor, shift))
            self.factor, self.shift = old * factor, before * factor + shift

    def finish(self) -> None:
        """Behind an activation at the end, a linear layer of what scales its values."""
        last = self.layers[-1] if self.layers else None
        if last and (last.activation != "linear" or last.quantiser):
            nodes = len(last.biases)
            self.linear(np.eye(nodes), np.zeros(nodes))

    def wide(self, values: Real, width: int) -> Real:
        """One value for each of ``width`` inputs or outputs."""
        if len(values) not in (1, width):
            raise self.refuse(f"got {len(values)} values, expected 1 or {width}")
        return np.broadcast_to(values, width)


def read(path: Path) -> ParsedNetwork:
    """The layers of a network that PyTorch, Keras or scikit-learn has exported.

    The graph must be layers of ``LINEAR``, each but the last followed by one of ``ACTIVATIONS``, by
    one of ``EXPRESSIONS``, which become tables, or by none. Between these there may be others of
    ``OPERATORS`` that change each value by itself or nothing, and quantisers. At the end there may
    be what makes a class of the values; see ``tactus.network_files.classifier``.
    """
    with reading(path, "an ONNX file"):
        model = onnx.load(str(path))
    graph = model.graph
    constants = {c.name: _array(path, c) for c in graph.initializer}
    inputs = [i.name for i in graph.input if i.name not in constants]
    counted = f"{path}: got {len(inputs)} inputs and {len(graph.output)} outputs, expected a graph "
    if len(inputs) != 1 or not graph.output:
        raise InputError(f"{counted}with one of each")
    (taken,) = [i for i in graph.input if i.name == inputs[0]]
    # Some exporters write -1 for any number of frames.
    shape = [dim.dim_value for dim in taken.type.tensor_type.shape.dim]
    _check_sizes(path, f"input {taken.name!r}", shape, shape[1:])
    chain, output = _Chain(path), graph.output[0].name
    current, ending = inputs[0], None
    # Named before what is unusual because of them, such as an Unsqueeze of the samples.
    for chain.node in graph.node:
        if chain.node.op_type in REASONS:
            raise chain.refuse(f"not supported: {REASONS[chain.node.op_type]}")
    versions = {opset.domain: opset.version for opset in model.opset_import}
    for place, node in enumerate(graph.node):
        chain.node = node
        if node.op_type == "Constant":
            value = next((a for a in node.attribute if a.name == "value"), None)
            if value is None:
                raise chain.refuse("expected a tensor as its value")
            constants.update(dict.fromkeys(node.output, _array(path, value.t)))
            continue
        if node.op_type in quantisers.OPERATORS and node.input and node.input[0] in constants:
            made = quantisers.folded(node, constants[node.input[0]], constants, chain.refuse)
            constants.update(dict.fromkeys(node.output, made))
            continue
        if node.input and all(name in constants for name in node.input if name):
            constants |= _folded(chain, constants, versions)
            continue
        if classifier.begins(node, graph.node[place + 1 :]) and not chain.coded:
            behind, names = graph.node[place:], [one.name for one in graph.output]
            ending = classifier.followed(
                behind, current, names, constants, chain.width(), chain.refuse
            )
            break
        _step(chain, current, output, constants)
        current = node.output[0]
    if ending is None and len(graph.output) != 1:
        raise InputError(f"{counted}with one of each, or of a classifier")
    if ending is None and current != output:
        raise InputError(f"{path}: the output is {output!r}, expected {current!r}")
    chain.finish()
    if not chain.layers:
        raise InputError(
            f"{path}: got no linear layer, expected one or more, {' or '.join(LINEAR)}"
        )
    return ParsedNetwork(tuple(chain.layers), tuple(chain.functions.values()), ending)


def _folded(chain: _Chain, constants: dict[str, Any], versions: dict[str, int]) -> dict[str, Any]:
    """Apply an operator to constants, as ONNX defines it in these versions of its domains."""
    node = chain.node
    taken = {name: constants[name] for name in node.input if name}
    if node.op_type == "Dropout" and any(np.any(taken[name]) for name in node.input[2:] if name):
        raise chain.refuse(f"not supported: {RANDOM}")
    if node.op_type in ("ConstantOfShape", "Expand", "Tile"):
        # The last input has the sizes, or by what they are multiplied.
        *_, (name, sizes) = taken.items()
        size = math.prod(real_numbers(chain.path, name, sizes).ravel().tolist())
        if size > MOST_NUMBERS:
            raise chain.refuse(f"makes {size:g} numbers, expected {MOST_NUMBERS:g} at most")
    try:
        results: Any = ReferenceEvaluator(node, opsets=versions).run(None, taken)
        return dict(zip(node.output, results, strict=True))
    except Exception as error:
        raise chain.refuse(f"cannot be applied to its constants: {error}") from None


def _array(path: Path, tensor: Any) -> Any:
    _check_sizes(path, f"tensor {tensor.name!r}", tensor.dims, tensor.dims)
    with reading(path, f"an ONNX file whose tensor {tensor.name!r} holds numbers"):
        array = numpy_helper.to_array(tensor)
        # numpy sees short floats as records.
        return array.astype(np.float32) if array.dtype.kind == "V" else array


def _check_sizes(path: Path, what: str, shape: Sequence[int], sizes: Sequence[int]) -> None:
    """Refuse a shape with sizes below 0, which numpy would take for what is left."""
    if min(sizes, default=0) < 0:
        raise InputError(f"{path}: {what}: got the shape {list(shape)}, expected sizes above 0")


def _step(chain: _Chain, current: str, output: str, constants: dict[str, Any]) -> None:
    """Take the operator at which the chain is into it."""
    node = chain.node
    if node.op_type in quantisers.OPERATORS and node.domain in quantisers.DOMAINS:
        _quantise(chain, current, constants)
        return
    if chain.coded:
        raise chain.refuse("takes the codes of a QuantizeLinear, expected DequantizeLinear")
    domains = ("ai.onnx.ml",) if node.op_type == "Scaler" else ("", "ai.onnx")
    if node.op_type not in OPERATORS or node.domain not in domains:
        raise chain.refuse(f"not supported, expected one of {', '.join(OPERATORS)}")
    used = [name for name in node.input if name]
    if len(used) not in OPERATORS[node.op_type] or len(node.output) != 1:
        expected = " or ".join(str(count) for count in OPERATORS[node.op_type])
        raise chain.refuse(
            f"got {len(used)} inputs and {len(node.output)} outputs, expected {expected} and 1",
        )
    if current not in used:
        raise chain.refuse(f"does not read {current!r}; expected a chain without branches")
    others = [name for name in used if name != current]
    missing = [name for name in others if name not in constants]
    if missing or used.count(current) != 1:
        raise chain.refuse(f"reads {missing or current!r}, expected constants beside {current!r}")
    values = [real_numbers(chain.path, name, constants[name]) for name in others]
    attributes = quantisers.attributes_of(node)
    for name, value in attributes.items():
        if name in ATTRIBUTES and not isinstance(value, ATTRIBUTES[name]):
            raise chain.refuse(f"got {name} of another type, expected numbers")
    if node.op_type in LINEAR:
        if node.input[0] != current or values[0].ndim != 2:
            raise chain.refuse("expected the data first and a matrix of weights second")
        if attributes.get("transA", 0):
            raise chain.refuse("transA=1, expected 0")
        weights = values[0] * attributes.get("alpha", 1.0)
        weights = weights if attributes.get("transB", 0) else weights.T
        bias = _row(chain, values[1]) if len(values) > 1 else np.zeros(1)
        bias = chain.wide(bias * attributes.get("beta", 1.0), len(weights))
        chain.linear(weights, bias)
    elif node.op_type in ELEMENTWISE:
        chain.elementwise(*_factor_and_shift(chain, current, values, attributes))
    elif node.op_type in ACTIVATIONS:
        if node.op_type == "Clip":
            names = [*node.input[1:], "", ""]
            named = [
                constants[n] if n else attributes.get(k)
                for n, k in zip(names, ("min", "max"), strict=False)
            ]
            low, high = (None if v is None else np.ravel(v).tolist() for v in named)
            if (low, high) != ([-1.0], [1.0]):
                raise chain.refuse(f"got the ends {low} and {high}, expected -1 and 1: a hard tanh")
        leak = attributes.get("alpha", LEAK)
        if node.op_type == "PRelu":
            slopes = np.unique(values[0])
            if slopes.size != 1:
                raise chain.refuse(f"got {slopes.size} slopes, expected one for all nodes")
            leak = float(slopes[0])
        chain.activate(ACTIVATIONS[node.op_type], leak)
    elif node.op_type in EXPRESSIONS:
        expression, usual = EXPRESSIONS[node.op_type], DEFAULTS.get(node.op_type, {})
        if node.op_type == "Gelu" and attributes.get("approximate") == "tanh":
            expression = GELU_OF_TANH
        own = {name: attributes.get(name, value) for name, value in usual.items()}
        with naming(f"{chain.path}: operator {node.op_type} ({node.name!r})"):
            function = Function(node.op_type.lower(), expression.format(**own))
        chain.look_up(function)
    elif node.op_type == "Cast":
        kinds = {number: name for name, number in TensorProto.DataType.items()}
        kind = kinds.get(attributes.get("to"), "nothing")
        if kind not in FLOATS:
            raise chain.refuse(f"to {kind}, expected one of {', '.join(FLOATS)}")
    elif node.op_type == "Flatten":
        if attributes.get("axis", 1) not in (1, -1):
            raise chain.refuse(f"got axis {attributes['axis']}, expected 1")
    elif node.op_type == "Reshape":
        # skl2onnx ends with a column of all results, whatever the number of outputs. The values and
        # their order stay the same.
        width = len(chain.layers[-1].biases) if chain.layers else None
        shapes = [[-1, width]] + ([[-1, 1]] if node.output[0] == output else [])
        shape = np.asarray(constants[others[0]]).tolist()
        if shape not in shapes:
            raise chain.refuse(f"to {shape}, expected one of {shapes}")


def _quantise(chain: _Chain, current: str, constants: dict[str, Any]) -> None:
    """Take a quantiser into the chain; a DequantizeLinear only undoes the one before it."""
    node = chain.node
    if node.input[:1] != [current]:
        raise chain.refuse(f"does not read {current!r}; expected a chain without branches")
    if node.op_type == quantisers.BIPOLAR:
        two, half = quantisers.bipolar(node, constants, chain.refuse)
        chain.quantise(two)
        chain.elementwise(np.ones(1), np.array([half]))
        return
    if node.op_type != quantisers.DEQUANTIZE:
        quantiser = quantisers.quantiser_of(node, constants, chain.refuse)
        chain.quantise(quantiser)
        chain.coded = quantiser if node.op_type == quantisers.QUANTIZE else None
        return
    before, chain.coded = chain.coded, None
    scale, zero, *_ = [*quantisers.parameters(node, constants, chain.refuse), None]
    place = 0 if zero is None else zero
    if (
        before is None
        or not (np.all(scale == np.float32(before.scale)) or np.all(scale == before.scale))
        or not np.all(place == before.zero)
    ):
        raise chain.refuse("expected the scale and zero point of a QuantizeLinear before it")


def _factor_and_shift(
    chain: _Chain, current: str, values: list[Real], attributes: dict[str, Any]
) -> tuple[Real, Real]:
    """The factor and the shift by which an operator changes each value by itself."""
    node = chain.node
    if node.op_type == "Scaler":
        offset, scale = (np.array(attributes.get(key, [])) for key in ("offset", "scale"))
        if not offset.size or not scale.size:
            raise chain.refuse("expected the attributes offset and scale")
        return scale, -offset * scale
    if node.op_type == "BatchNormalization":
        if attributes.get("training_mode", 0) or node.input[0] != current:
            raise chain.refuse("expected it as it is after training, with the data first")
        gain, offset, mean, variance = (_row(chain, v) for v in values)
        factor = gain / np.sqrt(variance + attributes.get("epsilon", 1e-5))
        return factor, offset - mean * factor
    value = _row(chain, values[0])
    first = node.input[0] == current
    if node.op_type == "Add":
        return np.ones(1), value
    if node.op_type == "Sub":
        return np.array([1.0 if first else -1.0]), -value if first else value
    if node.op_type == "Mul":
        return value, np.zeros(1)
    if not first or not value.all():
        raise chain.refuse("expected the data first, divided by numbers other than 0")
    return 1 / value, np.zeros(1)


def _row(chain: _Chain, values: Real) -> Real:
    """A constant that holds one number for each value of a frame, or one number for all."""
    if values.size != 1 and values.shape[-1] != values.size:
        raise chain.refuse(f"got a constant of shape {values.shape}, expected one row")
    return values.ravel()


def write(path: Path, network: DenseNetwork) -> None:
    """Write the network as a Gemm for each layer and its activation, in double precision."""
    tables = [layer.activation for layer in network.layers if layer.functions]
    if tables:
        raise InputError(
            f"got an activation {tables[0]!r}, expected one that ONNX has an operator for; .npz "
            "names any"
        )
    if network.quantised:
        raise InputError(
            "got a quantised network, expected one in floating point: quantisers are only read of "
            "this form; .npz holds them"
        )
    arrays: dict[str, Real] = {}
    nodes, value = [], "x"
    layers = network.layers
    for n, layer in enumerate(layers, start=1):
        arrays |= {f"w{n}": layer.weights, f"b{n}": layer.biases}
        given = "y" if n == len(layers) else f"q{n}"
        nodes.append(
            helper.make_node("Gemm", [value, f"w{n}", f"b{n}"], [given], f"layer{n}", transB=1)
        )
        value = given
        if layer.activation == "linear":
            continue
        operator = next(kind for kind, name in ACTIVATIONS.items() if name == layer.activation)
        taken, more = [value], dict[str, Any]()
        if operator == "Clip":
            arrays |= {"least": np.array(-1.0), "most": np.array(1.0)}
            taken += ["least", "most"]
        elif operator == "LeakyRelu":
            more["alpha"] = layer.leak
        value = f"r{n}"
        nodes.append(helper.make_node(operator, taken, [value], f"activation{n}", **more))
    inputs, *_, outputs = network.shape
    graph = helper.make_graph(
        nodes,
        "tactus",
        [helper.make_tensor_value_info("x", TensorProto.DOUBLE, ["frames", inputs])],
        [helper.make_tensor_value_info("y", TensorProto.DOUBLE, ["frames", outputs])],
        [numpy_helper.from_array(array, name) for name, array in arrays.items()],
    )
    model = helper.make_model(
        graph,
        producer_name="tactus",
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
    )
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString())

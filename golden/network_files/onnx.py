"""Networks as ONNX graphs: a chain of two linear layers with tanh between them.

Operators that scale each value by itself (samples, hidden nodes or outputs) are folded into the
layer that follows, or into the one before.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import AttributeProto, TensorProto, helper, numpy_helper

from golden.files import reading
from golden.input_error import InputError
from golden.mlp import Mlp, shifted
from golden.network_files.numbers import real_numbers
from golden.real import Real

# Whatever their order in the file, weights are described with nodes in rows.
TRANSPOSED = ()
LINEAR = ("Gemm", "MatMul")
ELEMENTWISE = ("Add", "Sub", "Mul", "Div", "Scaler")
# For each operator, the numbers of inputs that it may have.
OPERATORS = {
    "Gemm": (2, 3),
    "MatMul": (2,),
    "Add": (2,),
    "Sub": (2,),
    "Mul": (2,),
    "Div": (2,),
    "Scaler": (1,),
    "Tanh": (1,),
    "Cast": (1,),
    "Identity": (1,),
    "Reshape": (2,),
}
# For each attribute, the field that holds its value, and the type that it must have.
ATTRIBUTES = {
    "alpha": ("f", AttributeProto.FLOAT),
    "beta": ("f", AttributeProto.FLOAT),
    "transA": ("i", AttributeProto.INT),
    "transB": ("i", AttributeProto.INT),
    "offset": ("floats", AttributeProto.FLOATS),
    "scale": ("floats", AttributeProto.FLOATS),
}
# These are old enough for every runtime in use, and new enough for every operator used here.
OPSET, IR_VERSION = 13, 7


class _Chain:
    """The layers found so far, from the graph's input onwards."""

    def __init__(self, path: Path, output: str):
        self.path = path
        self.output = output
        self.layers: list[dict[str, Real]] = []
        self.tanh_after: list[int] = []
        # The values before the next layer are factor * x + shift, each by itself.
        self.factor, self.shift = np.ones(1), np.zeros(1)

    def refuse(self, node: Any, reason: str) -> InputError:
        return InputError(f"{self.path}: operator {node.op_type} ({node.name!r}): {reason}")

    def linear(self, node: Any, weights: Real, bias: Real) -> None:
        """Add a layer, into which the scaling before it is folded."""
        width = weights.shape[1]
        factor, shift = (self.wide(node, v, width) for v in (self.factor, self.shift))
        self.factor, self.shift = np.ones(1), np.zeros(1)
        self.layers.append({"w": weights * factor, "b": shifted(bias, weights, shift)})

    def elementwise(self, node: Any, factor: Real, shift: Real) -> None:
        """Multiply each value by its factor, and add its shift."""
        if self.layers and len(self.layers) not in self.tanh_after:
            layer = self.layers[-1]
            factor, shift = (self.wide(node, v, len(layer["b"])) for v in (factor, shift))
            layer["w"] = layer["w"] * factor[:, np.newaxis]
            layer["b"] = layer["b"] * factor + shift
        else:
            width = max(len(v) for v in (self.factor, self.shift, factor, shift))
            old, before = (self.wide(node, v, width) for v in (self.factor, self.shift))
            factor, shift = (self.wide(node, v, width) for v in (factor, shift))
            self.factor, self.shift = old * factor, before * factor + shift

    def wide(self, node: Any, values: Real, width: int) -> Real:
        """One value for each of ``width`` inputs or outputs."""
        if len(values) not in (1, width):
            raise self.refuse(node, f"got {len(values)} values, expected 1 or {width}")
        return np.broadcast_to(values, width)


def read(path: Path) -> dict[str, Real]:
    """The arrays of a network that PyTorch, Keras or scikit-learn has exported.

    The graph must be Gemm or MatMul, then Tanh, then Gemm or MatMul. Before and after each of these
    there may be Add, Sub, Mul, Div and Scaler with constants, Cast, Identity, and a Reshape that
    changes nothing.

    Raises
    ------
    InputError
        When the file is no ONNX graph, or has another operator or order. The message names the
        operator.
    """
    with reading(path, "an ONNX file"):
        model = onnx.load(str(path))
    graph = model.graph
    constants = {c.name: _array(path, c) for c in graph.initializer}
    inputs = [i.name for i in graph.input if i.name not in constants]
    if len(inputs) != 1 or len(graph.output) != 1:
        raise InputError(
            f"{path}: got {len(inputs)} inputs and {len(graph.output)} outputs, expected a graph "
            "with one of each"
        )
    chain = _Chain(path, graph.output[0].name)
    current = inputs[0]
    for node in graph.node:
        if node.op_type == "Constant":
            value = next((a for a in node.attribute if a.name == "value"), None)
            if value is None:
                raise chain.refuse(node, "expected a tensor as its value")
            constants.update(dict.fromkeys(node.output, _array(path, value.t)))
            continue
        _step(chain, node, current, constants)
        current = node.output[0]
    if current != chain.output:
        raise InputError(f"{path}: the output is {chain.output!r}, expected {current!r}")
    if len(chain.layers) != 2 or chain.tanh_after != [1]:
        raise InputError(
            f"{path}: got {len(chain.layers)} linear layers with Tanh after layers "
            f"{chain.tanh_after}, expected 2 with Tanh after the first"
        )
    first, second = chain.layers
    return {"w1": first["w"], "b1": first["b"], "w2": second["w"], "b2": second["b"]}


def _array(path: Path, tensor: Any) -> Any:
    """The value of a constant in the graph."""
    with reading(path, f"an ONNX file whose tensor {tensor.name!r} holds numbers"):
        array = numpy_helper.to_array(tensor)
        # numpy sees short floats as records.
        return array.astype(np.float32) if array.dtype.kind == "V" else array


def _step(chain: _Chain, node: Any, current: str, constants: dict[str, Any]) -> None:
    """Add one operator to the chain."""
    domains = ("ai.onnx.ml",) if node.op_type == "Scaler" else ("", "ai.onnx")
    if node.op_type not in OPERATORS or node.domain not in domains:
        raise chain.refuse(node, f"not supported, expected one of {', '.join(OPERATORS)}")
    used = [name for name in node.input if name]
    if len(used) not in OPERATORS[node.op_type] or len(node.output) != 1:
        expected = " or ".join(str(count) for count in OPERATORS[node.op_type])
        raise chain.refuse(
            node,
            f"got {len(used)} inputs and {len(node.output)} outputs, expected {expected} and 1",
        )
    if current not in used:
        raise chain.refuse(node, f"does not read {current!r}; expected a chain without branches")
    others = [name for name in used if name != current]
    missing = [name for name in others if name not in constants]
    if missing or used.count(current) != 1:
        raise chain.refuse(
            node, f"reads {missing or current!r}, expected constants beside {current!r}"
        )
    values = [real_numbers(chain.path, name, constants[name]) for name in others]
    attributes = {}
    for attribute in node.attribute:
        if attribute.name in ATTRIBUTES:
            field, kind = ATTRIBUTES[attribute.name]
            if attribute.type != kind:
                raise chain.refuse(node, f"got another {attribute.name}, expected numbers")
            attributes[attribute.name] = getattr(attribute, field)
    if node.op_type in LINEAR:
        if node.input[0] != current or values[0].ndim != 2:
            raise chain.refuse(node, "expected the data first and a matrix of weights second")
        if attributes.get("transA", 0):
            raise chain.refuse(node, "transA=1, expected 0")
        weights = values[0] * attributes.get("alpha", 1.0)
        weights = weights if attributes.get("transB", 0) else weights.T
        bias = _row(chain, node, values[1]) if len(values) > 1 else np.zeros(1)
        bias = chain.wide(node, bias * attributes.get("beta", 1.0), len(weights))
        chain.linear(node, weights, bias)
    elif node.op_type in ELEMENTWISE:
        chain.elementwise(node, *_factor_and_shift(chain, node, current, values, attributes))
    elif node.op_type == "Tanh":
        chain.tanh_after.append(len(chain.layers))
    elif node.op_type == "Reshape":
        # skl2onnx ends with a column of all results, whatever the number of outputs. The values and
        # their order stay the same.
        width = len(chain.layers[-1]["w"]) if chain.layers else None
        shapes = [[-1, width]] + ([[-1, 1]] if node.output[0] == chain.output else [])
        shape = np.asarray(constants[others[0]]).tolist()
        if shape not in shapes:
            raise chain.refuse(node, f"to {shape}, expected one of {shapes}")


def _factor_and_shift(
    chain: _Chain, node: Any, current: str, values: list[Real], attributes: dict[str, Any]
) -> tuple[Real, Real]:
    """The factor and the shift by which an operator changes each value by itself."""
    if node.op_type == "Scaler":
        offset, scale = (np.array(attributes.get(key, [])) for key in ("offset", "scale"))
        if not offset.size or not scale.size:
            raise chain.refuse(node, "expected the attributes offset and scale")
        return scale, -offset * scale
    value = _row(chain, node, values[0])
    first = node.input[0] == current
    if node.op_type == "Add":
        return np.ones(1), value
    if node.op_type == "Sub":
        return np.array([1.0 if first else -1.0]), -value if first else value
    if node.op_type == "Mul":
        return value, np.zeros(1)
    if not first or not value.all():
        raise chain.refuse(node, "expected the data first, divided by numbers other than 0")
    return 1 / value, np.zeros(1)


def _row(chain: _Chain, node: Any, values: Real) -> Real:
    """A constant that holds one number for each value of a frame, or one number for all."""
    if values.size != 1 and values.shape[-1] != values.size:
        raise chain.refuse(node, f"got a constant of shape {values.shape}, expected one row")
    row: Real = values.ravel()
    return row


def write(path: Path, mlp: Mlp) -> None:
    """Write the network as Gemm, Tanh, Gemm with numbers of double precision."""
    inputs, _, outputs = mlp.shape
    nodes = [
        helper.make_node("Gemm", ["x", "w1", "b1"], ["q"], name="layer1", transB=1),
        helper.make_node("Tanh", ["q"], ["r"], name="activation"),
        helper.make_node("Gemm", ["r", "w2", "b2"], ["y"], name="layer2", transB=1),
    ]
    graph = helper.make_graph(
        nodes,
        "tactus",
        [helper.make_tensor_value_info("x", TensorProto.DOUBLE, ["frames", inputs])],
        [helper.make_tensor_value_info("y", TensorProto.DOUBLE, ["frames", outputs])],
        [numpy_helper.from_array(getattr(mlp, n), n) for n in ("w1", "b1", "w2", "b2")],
    )
    model = helper.make_model(
        graph,
        producer_name="tactus",
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
    )
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString())

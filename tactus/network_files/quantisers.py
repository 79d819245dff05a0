"""Operators of quantised ONNX graphs: Quant and BipolarQuant of QONNX, and those of ONNX itself.

If the input of such an operator is a constant, its output is a constant too. Otherwise it stands in
the chain of layers and is the quantiser behind an activation.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from onnx import helper

from golden.input_error import InputError
from golden.trained.dense import Quantiser

QUANT, QUANTIZE, DEQUANTIZE = "Quant", "QuantizeLinear", "DequantizeLinear"
BIPOLAR = "BipolarQuant"
OPERATORS = (QUANT, BIPOLAR, QUANTIZE, DEQUANTIZE)
# The least and the largest number of inputs behind the data.
INPUTS = {QUANT: (3, 3), BIPOLAR: (1, 1), QUANTIZE: (1, 2), DEQUANTIZE: (1, 2)}
DOMAINS = ("", "ai.onnx", "qonnx.custom_op.general", "onnx.brevitas", "finn.custom_op.general")
ROUNDINGS = {"ROUND": "even", "HALF_EVEN": "even", "HALF_UP": "away", "FLOOR": "floor"}

Refuse = Callable[[str], InputError]


def attributes_of(node: Any) -> dict[str, Any]:
    """The attributes of a node by name, with texts decoded."""
    found = {a.name: helper.get_attribute_value(a) for a in node.attribute}
    return {k: v.decode() if isinstance(v, bytes) else v for k, v in found.items()}


def parameters(node: Any, constants: dict[str, Any], refuse: Refuse) -> list[Any]:
    """The scale, the zero point and all further inputs behind the data, which must be constants."""
    names = list(node.input[1:])
    missing = [name for name in names if name and name not in constants]
    if missing or not INPUTS[node.op_type][0] <= len(names) <= INPUTS[node.op_type][1]:
        raise refuse(f"got {len(names)} inputs behind the data, expected constants")
    return [np.asarray(constants[name]) if name else None for name in names]


def quantiser_of(node: Any, constants: dict[str, Any], refuse: Refuse) -> Quantiser:
    """The quantiser of a Quant or a QuantizeLinear in the chain of layers."""
    scale, zero, *more = parameters(node, constants, refuse)
    if any(np.size(value) != 1 for value in (scale, zero, *more) if value is not None):
        raise refuse("got a scale or a zero point for each value, expected one for all")
    low, high = _ends(node, zero, more, refuse)
    rounding, place = _rounding(node, refuse), _whole(node, zero, refuse).item()
    try:
        return Quantiser(
            float(scale.item()), int(place), low, high, rounding, node.op_type != QUANT
        )
    except InputError as error:
        raise refuse(str(error)) from None


def bipolar(node: Any, constants: dict[str, Any], refuse: Refuse) -> tuple[Quantiser, float]:
    """The quantiser of a BipolarQuant, and what is added behind it.

    Its values are the scale and its negative. They are half a step above the codes 0 and -1 of a
    step of twice the scale.
    """
    (scale,) = parameters(node, constants, refuse)
    if np.size(scale) != 1:
        raise refuse("got a scale for each value, expected one for all")
    half = float(scale.item())
    try:
        return Quantiser(2 * half, 0, -1, 0, "floor"), half
    except InputError as error:
        raise refuse(str(error)) from None


def _rounding(node: Any, refuse: Refuse) -> str:
    mode = attributes_of(node).get("rounding_mode", "ROUND").upper()
    if mode not in ROUNDINGS:
        raise refuse(f"got the rounding mode {mode}, expected one of {', '.join(ROUNDINGS)}")
    return ROUNDINGS[mode]


def _whole(node: Any, zero: Any, refuse: Refuse) -> Any:
    """Zero points, which must be whole numbers; 0 where there is none."""
    places = np.asarray(0 if zero is None else zero, dtype=np.float64)
    wrong = places[places % 1 != 0]
    if wrong.size:
        raise refuse(f"got the zero point {wrong[0]}, expected a whole number")
    return places


def _ends(node: Any, zero: Any, more: list[Any], refuse: Refuse) -> tuple[int, int]:
    if node.op_type == QUANTIZE:
        # Without a zero point the codes are unsigned bytes.
        kind = np.uint8 if zero is None else zero.dtype
        if kind.kind not in "iu" if isinstance(kind, np.dtype) else False:
            raise refuse(f"got a zero point of {kind}, expected whole numbers")
        ends = np.iinfo(kind)
        return int(ends.min), int(ends.max)
    attributes = attributes_of(node)
    signed, narrow = (int(attributes.get(key, 0)) for key in ("signed", "narrow"))
    width = more[0].item()
    if width != int(width) or not 1 <= width <= 32:
        raise refuse(f"got {width} bits, expected a whole number from 1 to 32")
    half = 1 << (int(width) - 1)
    return (narrow - half, half - 1) if signed else (0, 2 * half - 1 - narrow)


def folded(node: Any, data: Any, constants: dict[str, Any], refuse: Refuse) -> Any:
    """Apply such an operator to a constant; the result of QuantizeLinear is codes."""
    scale, zero, *more = [*parameters(node, constants, refuse), None]
    values = np.asarray(data)
    factor, place = (_along(node, v, values) for v in (scale, _whole(node, zero, refuse)))
    if node.op_type == DEQUANTIZE:
        return (values.astype(np.float64) - place) * factor
    if not (np.isfinite(factor).all() and (factor > 0).all()):
        raise refuse("got a scale that is not above 0")
    if node.op_type == BIPOLAR:
        return np.where(values >= 0, factor, -factor)
    low, high = _ends(node, zero, more, refuse)
    if node.op_type == QUANTIZE:
        codes = np.clip(np.rint(values / factor) + place, low, high)
        return codes.astype(np.uint8 if zero is None else zero.dtype)
    rounding = _rounding(node, refuse)
    found = [
        Quantiser(float(f), int(z), low, high, rounding).process(np.asarray(v, dtype=np.float64))
        for v, f, z in np.broadcast(values, factor, place)
    ]
    return np.reshape(found, values.shape)


def _along(node: Any, value: Any, values: Any) -> Any:
    """Scales or zero points, shaped so that they apply along their axis."""
    array = np.asarray(value, dtype=np.float64)
    if node.op_type in (QUANT, BIPOLAR) or array.ndim != 1 or array.size == 1 or values.ndim < 2:
        return array if array.size != 1 else array.reshape(())
    axis = attributes_of(node).get("axis", 1)
    return array.reshape([-1 if n == axis % values.ndim else 1 for n in range(values.ndim)])

"""Operators of ONNX whose function an engine looks up in a table, as expressions of x."""

from collections.abc import Mapping
from typing import Any

from golden.trained.function import Function

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


def function_of(operator: str, attributes: Mapping[str, Any]) -> Function:
    """The function of an operator with these attributes, under the operator's name."""
    expression = EXPRESSIONS[operator]
    if operator == "Gelu" and attributes.get("approximate") == b"tanh":
        expression = GELU_OF_TANH
    values = DEFAULTS.get(operator, {})
    values = {name: attributes.get(name, value) for name, value in values.items()}
    return Function(operator.lower(), expression.format(**values))

"""From real weights to the constants of a bit-true network."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from golden.activation.schemes import SCHEMES
from golden.layers.input_integral import InputIntegral
from golden.layers.input_node import InputNode
from golden.layers.output_integral import OutputIntegral
from golden.networks.hybrid import Hybrid
from golden.networks.mlp import Mlp
from golden.precision import SIGNAL, Precision, normalisation


def build_hybrid(
    mlp: Mlp,
    precision: Precision,
    activation: str,
    options: Mapping[str, object] | None = None,
    variant: str = "",
) -> Hybrid:
    """The bit-true folded network of ``mlp``.

    Parameters
    ----------
    mlp : Mlp
    precision : Precision
    activation : str
        A name of ``SCHEMES``.
    options : mapping, optional
        What is chosen of the activation's options.
    variant : str
        Tells it from other networks of the same design.

    Raises
    ------
    ValueError
        When weights do not fit their format, or when in ``thesis`` precision a normalised sum
        could leave its 14 bits: the thesis' adders wrap, and a wrapped sum is a wrong sum.
    """
    _, hidden, outputs = mlp.shape
    ones = np.ones(hidden, dtype=np.int64), np.ones(outputs, dtype=np.int64)
    q_factors, y_factors = (
        (normalisation(mlp.w1, mlp.b1), normalisation(mlp.w2, mlp.b2))
        if precision.normalise
        else ones
    )
    w1, b1, fmt1 = precision.coefficients(
        mlp.w1 / q_factors[:, np.newaxis], mlp.b1 / q_factors, "layer 1 weights"
    )
    w2, b2, fmt2 = precision.coefficients(
        mlp.w2 / y_factors[:, np.newaxis], mlp.b2 / y_factors, "layer 2 weights"
    )
    prefix = f"{variant}_" if variant else ""
    nodes = tuple(
        InputNode(
            SIGNAL,
            fmt1,
            precision.hidden_fmt,
            precision.product_shift,
            tuple(int(w) for w in w1[j]),
            int(b1[j]),
            variant=f"{prefix}{j}",
        )
        for j in range(hidden)
    )
    output = OutputIntegral(
        SIGNAL,
        fmt2,
        SIGNAL,
        precision.product_shift,
        tuple(tuple(int(w) for w in row) for row in w2),
        tuple(int(b) for b in b2),
        tuple(int(y) for y in y_factors) if precision.normalise else None,
        variant=variant,
    )
    if precision.normalise:
        for name, width in [(f"hidden node {j}", n.acc_width) for j, n in enumerate(nodes)] + [
            ("output layer", output.acc_width)
        ]:
            if width > SIGNAL.width:
                raise ValueError(
                    f"{name}: its normalised sum needs {width} bits and would wrap in "
                    f"{SIGNAL.width}; weights that are nearly whole numbers do this, retrain or "
                    "use the precise precision"
                )
    scheme = SCHEMES[activation].configured(options or {})
    activations = tuple(
        scheme.build(precision, int(q), node.reach)
        for q, node in zip(q_factors, nodes, strict=True)
    )
    return Hybrid(InputIntegral(nodes, variant=variant), activations, output, variant=variant)

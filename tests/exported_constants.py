"""Prints digests of all constants of the hardware, which show where two machines differ.

``python tests/exported_constants.py`` prints a line for every block of every shipped scene, and for
every activation with some other factors. With ``--defined-only``, those functions of numpy and math
raise whose rounding differs between machines.
"""

import hashlib
import sys
import warnings
from collections.abc import Iterator
from functools import cached_property

import numpy as np

from golden.input_error import InputError

# The normalisations of activations that are not part of a scene.
FACTORS = (1, 2, 3, 5, 7, 11, 16, 30, 100, 500)

# Functions whose result IEEE 754 defines to the last bit for a single number, functions that only
# compare or move bits, and fsum, which rounds the exact sum once.
DEFINED = set(
    """absolute add bitwise_and bitwise_count bitwise_or bitwise_xor ceil copysign divide equal fabs
    floor floor_divide fmax fmin fmod frexp gcd greater greater_equal invert isfinite isinf isnan
    lcm ldexp left_shift less less_equal logical_and logical_not logical_or logical_xor maximum
    minimum modf multiply negative not_equal positive remainder right_shift rint sign signbit sqrt
    square subtract trunc
    comb factorial fsum isclose isqrt nextafter perm ulp""".split()  # noqa: SIM905
)
# Functions that sum products in an order of their own. All of numpy.linalg belongs to them.
REDUCTIONS = set(
    """average convolve correlate corrcoef cov dot einsum inner interp matvec mean nanmean nanstd
    nanvar outer polyfit polyval std tensordot trapezoid var vdot vecdot vecmat""".split()  # noqa: SIM905
)


def refuse_undefined() -> None:
    """Make all functions raise that are not ``DEFINED``. The operators ``**`` and ``@`` stay."""
    # When they are imported, these modules compute constants with some of the functions.
    import math
    import random  # noqa: F401
    import tempfile  # noqa: F401

    def replace(module: object, name: str) -> None:
        def refuse(*arguments: object, **options: object) -> None:
            raise AssertionError(f"{name} is not defined to the last bit")

        setattr(module, name, refuse)

    for name, value in list(vars(np).items()):
        if (isinstance(value, np.ufunc) and value.__name__ not in DEFINED) or name in REDUCTIONS:
            replace(np, name)
    for module in (math, np.linalg):
        for name, value in list(vars(module).items()):
            if callable(value) and not isinstance(value, type) and name not in DEFINED:
                replace(module, name)


def exported() -> Iterator[tuple[str, object]]:
    """Every block, and the codes that the test bench of a scene plays, each with a unique name."""
    from golden.activation.schemes import forms
    from golden.common.block import walk
    from tactus.scene import comparison_names, load_scene, scene_names

    for name in [*scene_names(), *comparison_names()]:
        scene = load_scene(name)
        # The scale of logits comes from a product of matrices.
        if scene.classes:
            continue
        design = scene.twin()
        for block in walk(design):
            yield f"{scene.name} {block.entity}", block
        codes = np.concatenate(scene.vectors().recordings)
        yield f"{scene.name} recorded", (codes.tolist(), design.process(codes).tolist())
    for name, scheme in forms().items():
        for precision in scheme.precisions:
            for factor in FACTORS if precision.normalise else (1,):
                reach = precision.hidden_fmt.high
                yield f"{precision.name} {name} {factor}", scheme.build(precision, factor, reach)


def constants(block: object) -> str:
    """A digest of all that a block states: its fields and its properties."""
    kind = type(block)
    kinds = (property, cached_property)
    derived = [name for name in dir(kind) if isinstance(getattr(kind, name), kinds)]
    return repr((block, [(name, derived_value(block, name)) for name in derived]))


def derived_value(block: object, name: str) -> object:
    """The value of a property, or its error if the block has no such property in its form."""
    try:
        return getattr(block, name)
    except (NotImplementedError, InputError) as error:
        return str(error)


def lines() -> list[str]:
    """``name: digest`` for everything of ``exported``."""
    from golden.layers import sharing

    # The search for shared terms knows whole numbers alone. One run of each kind stands for all,
    # which would take three quarters of the time.
    sharing.RUNS = len(sharing.SPREADS)
    return [
        f"{name}: {hashlib.sha256(constants(block).encode()).hexdigest()}"
        for name, block in exported()
    ]


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    if "--defined-only" in sys.argv:
        refuse_undefined()
    print("\n".join(lines()))

"""MyHDL's size of a large literal, by counting bits.

MyHDL 0.11 takes the ceiling of a logarithm for it. Of a word of ones alone that logarithm is whole
but for its last bit, and the ceiling what the machine makes of that bit.
"""

from __future__ import annotations

from types import SimpleNamespace

from myhdl.conversion import _toVerilog, _toVHDL


def _log(value: int, base: int) -> int:
    """The ceiling of a logarithm to the base 2."""
    if base != 2:
        raise ValueError(f"base: got {base}, expected 2, the only one that MyHDL 0.11 asks for")
    return (value - 1).bit_length()


def install() -> None:
    """Replace the module ``math`` where MyHDL writes literals."""
    for module in (_toVerilog, _toVHDL):
        module.math = SimpleNamespace(ceil=int, log=_log)

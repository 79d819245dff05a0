"""Gives MyHDL the size of a large literal by counting its bits.

MyHDL 0.11 takes the ceiling of a logarithm instead. For a word of ones that logarithm is within a
rounding error of a whole number, so the ceiling depends on how the machine rounds.
"""

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

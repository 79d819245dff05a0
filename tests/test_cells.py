"""What Yosys counts of the activations."""

from __future__ import annotations

import pytest
from conftest import tiered

from golden.activation.schemes import forms
from golden.precision import EXACT
from hdl.synth.activations import cells
from hdl.synth.cells import FAMILIES


def count(name: str, family: str) -> dict[str, int]:
    return cells(forms()[name].build(EXACT, 1, EXACT.hidden_fmt.high), family)


@pytest.mark.parametrize("family", tiered(["xc2v"], [f for f in FAMILIES if f != "xc2v"]))
def test_precise_takes_fewer_luts_than_gradient(family: str) -> None:
    gradient, logic = count("gradient", family), count("precise", family)
    block_ram = count("precise block_ram", family)
    assert block_ram["LUT"] < logic["LUT"] < gradient["LUT"]
    assert [c["multiplier"] for c in (gradient, logic, block_ram)] == [1, 1, 1]
    assert [c["block RAM"] for c in (gradient, logic, block_ram)] == [0, 0, 1]

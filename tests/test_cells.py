"""Tests the cells that Yosys counts for the activations."""

import pytest
from conftest import tiered

from golden.activation.bipartite import bipartite_for
from golden.activation.bipartite_pair import pair_for
from golden.activation.schemes import forms
from golden.precision import EXACT
from hdl.synth.activations import cells
from hdl.synth.cells import FAMILIES


def count(name: str, family: str) -> dict[str, int]:
    return cells(forms()[name].build(EXACT, 1, EXACT.hidden_fmt.high), family)


@pytest.mark.parametrize("family", tiered([], FAMILIES))
def test_precise_takes_fewer_luts_than_gradient(family: str) -> None:
    gradient, logic = count("gradient", family), count("precise", family)
    block_ram = count("precise block_ram", family)
    assert block_ram["LUT"] < logic["LUT"] < gradient["LUT"]
    assert [c["multiplier"] for c in (gradient, logic, block_ram)] == [1, 1, 1]
    assert [c["block RAM"] for c in (gradient, logic, block_ram)] == [0, 0, 1]


@pytest.mark.parametrize("family", tiered([], FAMILIES))
def test_a_pair_of_bipartite_nodes_shares_two_block_rams(family: str) -> None:
    one = bipartite_for(EXACT, 1, EXACT.hidden_fmt.high)
    found, single = cells(pair_for(one), family), cells(one, family)
    assert found["block RAM"] == single["block RAM"] == 2
    assert found["multiplier"] == 0
    assert found["LUT"] <= 2 * single["LUT"] < 80

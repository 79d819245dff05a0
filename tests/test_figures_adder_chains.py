"""Tests table adder_chains: the content of the record, and what its chains compute."""

import subprocess
from itertools import product
from pathlib import Path

from golden.layers.constant_matrix import ConstantMatrix
from golden.networks.adder_graph import AdderGraph
from golden.numbers.signed_digits import signed_digits
from tactus.report.measure import adder_chains
from tactus.report.measure.table import Table
from tactus.scene import load_scene


def column(table: Table, heading: str) -> list:
    at = list(table.columns).index(heading)
    return [row[at] for row in table.rows]


def least_levels(matrix: ConstantMatrix) -> int:
    """The least number of adders in a chain for the row with the most digits.

    A sum has no more signed digits than its operands together. The constant adds one digit.
    """
    rows = [sum(len(list(signed_digits(weight))) for weight in row) for row in matrix.weights]
    return max(rows).bit_length()


def test_networks_have_as_few_clocks_as_the_digits_of_their_weights_let_them() -> None:
    count = 2
    table = adder_chains.adder_chains(1)
    assert list(table.columns) == adder_chains.COLUMNS
    counts = column(table, "adders")
    assert counts == list(adder_chains.ADDERS)
    clocks = column(table, "clocks of the network")[counts.index(count)]
    scene = load_scene(adder_chains.SCENE)
    design = adder_chains.with_adders(scene, count).twin()
    assert isinstance(design, AdderGraph)
    first = -(-least_levels(design.layers[0]) // count)
    # The saturation adds one clock.
    second = -(-(least_levels(design.layers[-1]) + 1) // count)
    assert clocks == design.latency == first + design.activations[0][0].latency + second


def test_each_adder_more_takes_time_and_a_faster_grade_less() -> None:
    table = adder_chains.adder_chains(1)
    for kind in ("alone", "and saturation"):
        grades = [column(table, f"{kind}, grade {g}, MHz") for g in adder_chains.GRADES]
        for clocks in grades:
            assert clocks == sorted(clocks, reverse=True)
        for by_grade in zip(*grades, strict=True):
            assert list(by_grade) == sorted(by_grade)
    for grade in adder_chains.GRADES:
        chains, networks = (
            column(table, f"{kind}, grade {grade}, MHz") for kind in ("alone", "network")
        )
        assert all(n is None or n < c for c, n in zip(chains, networks, strict=True))


def test_a_chain_adds_and_saturates(tmp_path: Path) -> None:
    """Tests every sum of three numbers of four bits, saturated to three bits."""
    bench = """
module bench;
  reg clk = 0;
  integer a, b, c;
  chain u(.clk(clk), .bit(1'b0), .sent());
  initial for (a = -8; a < 8; a = a + 1) for (b = -8; b < 8; b = b + 1)
    for (c = -8; c < 8; c = c + 1) begin
      u.a0 = a; u.a1 = b; u.a2 = c;
      #1 clk = 1;
      #1 $display("%0d", u.found);
      clk = 0;
    end
endmodule
"""
    source = tmp_path / "chain.v"
    source.write_text(adder_chains.chain("chain", 2, 4, 3) + bench, encoding="utf-8")
    program = tmp_path / "chain"
    subprocess.run(["iverilog", "-o", program, source], check=True, capture_output=True)
    said = subprocess.run(["vvp", "-n", program], check=True, capture_output=True, text=True)
    values = range(-8, 8)
    # Sums of four bits wrap here. Those of a network never do.
    sums = ((a + b + c + 8) % 16 - 8 for a, b, c in product(values, values, values))
    assert list(map(int, said.stdout.split())) == [min(max(s, -4), 3) for s in sums]

"""Tests that a design with more ports than the device has pins is placed as part of another."""

from pathlib import Path
from typing import Any

import pytest

from tactus.synth import timing

# One register between many inputs and one output.
WIDE = """
module wide(input clk, input [{last}:0] a, output reg y);
  always @(posedge clk) y <= ^a;
endmodule
"""


@pytest.mark.parametrize(("inputs", "without"), [(363, False), (364, True)])
def test_ports_without_pins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inputs: int, without: bool
) -> None:
    """A clock, an output and 363 inputs take all 365 pins."""
    devices: list[list[str]] = []

    def place(folder: Path, aim: int, placer: str, *, device: list[str]) -> dict[str, Any]:
        devices.append(list(device))
        (folder / f"{placer}.json").write_text("{}")
        ends = [{"from": {"cell": "a"}, "to": {"cell": "b"}}]
        return {
            "fmax": {"clk": {"achieved": 100.0}},
            "critical_paths": [{"from": "clk", "to": "clk", "path": ends}],
            "utilization": {
                kind: {"used": 1} for kind in ("TRELLIS_COMB", "TRELLIS_FF", "MULT18X18D", "DP16KD")
            },
        }

    monkeypatch.setattr(timing, "place", place)
    monkeypatch.setattr(timing, "_verilog", lambda folder, top: "")
    (tmp_path / "wide.v").write_text(WIDE.format(last=inputs - 1))
    assert timing.route(tmp_path, "wide").clock_mhz == 100.0
    assert [(timing.WITHOUT_PINS in device) for device in devices] == [without]

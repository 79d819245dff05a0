"""Runs ``make sim SCENE=`` for scenes of a board that learns, as a user types it."""

import subprocess
import sys
from pathlib import Path

import pytest
from copied import movable

from tactus.scene import scene_path

ROOT = Path(__file__).parents[1]


LEARNS = """
[front_end]
converter = "mcp3208"

[uart]
baud = 1_000_000
"""


@pytest.mark.all_only
@pytest.mark.parametrize("name", ["digit", "digit-load"])
def test_the_benches_of_a_board_that_learns_are_green(name: str, tmp_path: Path) -> None:
    """Four outputs with a profile, and one output, whose only known output is the last one."""
    text = movable(scene_path(name))
    text = text.replace("clock_mhz = 64.0", 'clock_mhz = 25.0\nlearning = "lms"')
    drawn = '\n[visualisation]\nanalogue = "pulse_density"\n' if name == "digit" else ""
    own = tmp_path / f"{name}-learns.toml"
    own.write_text(text + LEARNS + drawn)
    for block in ("readout", "lesson_receiver", "packet_sender", "uart_instrument"):
        words = ["sim", f"SCENE={own}", f"BLOCK={block}", "SIM=icarus"]
        command = ["make", "--no-print-directory", "-o", "ready", f"VENV={sys.prefix}", *words]
        said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert said.returncode == 0, said.stdout + said.stderr
        assert "1 benches, 0 failed" in said.stdout

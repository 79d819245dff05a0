"""Runs ``make sim SCENE=`` for every shipped scene, and for scenes of a board that learns.

Of a shipped scene it is every bench, in both simulators.

Only these tests simulate what shipped scenes have beyond the sizes of the benches' cases. ALL=1
runs them, and CI draws a sample of them (``tests/sample.py``).
"""

import subprocess
import sys
from pathlib import Path

import pytest
from copied import movable
from test_benches import check, check_clocks

from golden.block import walk
from golden.scene import load_scene, scene_names, scene_path
from tb.common.runner import jobs, read_outcome
from tb.common.tools import SIMULATORS

ROOT = Path(__file__).parents[1]


@pytest.mark.all_only
@pytest.mark.parametrize("name", scene_names())
def test_every_bench_of_a_scene_is_green(name: str) -> None:
    (Path(sys.prefix) / ".ready").touch()
    command = ["make", "--no-print-directory", f"VENV={sys.prefix}", "sim", f"SCENE={name}"]
    said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    red = [line for line in said.stdout.splitlines() if "FAIL" in line or "Error: " in line]
    assert said.returncode == 0, "\n".join([*red, said.stderr])
    scene = load_scene(name)
    outcomes = [read_outcome(job, True, 0) for s in SIMULATORS for job in jobs(scene, s)]
    entities = {part.entity for part in walk(scene.twin())}
    assert {outcome.job.entity for outcome in outcomes} == entities
    check(outcomes)
    check_clocks(outcomes)


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

"""``python -m tb.report.measure.own_rig CSV OUTPUTS``: times the way from a CSV to tested VHDL.

Each step is the command of a target of the Makefile and runs in an empty folder. The time of each
step is printed.

    python -m tb.report.measure.own_rig docs/tutorial/readings.csv force,place
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from golden.cli import run, would
from golden.files import check_file
from golden.folders import BUILD
from golden.input_error import InputError
from golden.machine import closing
from golden.scene import load_scene


def steps(readings: Path, outputs: str, scene: Path) -> dict[str, list[str]]:
    """For each target its module and words. The bench is that of the whole design."""
    return {
        "scene": ["golden.commands.scene", str(readings), outputs, "--to", str(scene)],
        "check": ["tb.check", str(scene)],
        "train": ["golden.commands.train", str(scene)],
        "vhdl": ["hdl.export", str(scene), "vhdl"],
        "sim": ["tb.sim", str(scene), "--block", "engine", "--sim", "ghdl"],
    }


def timed(readings: Path, outputs: str, scene: Path) -> dict[str, float]:
    """The seconds of each step, by the wall clock."""
    seconds = {}
    for name, (module, *words) in steps(readings, outputs, scene).items():
        started = time.perf_counter()
        command = [sys.executable, "-m", module, *words]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise InputError(f"make {name}: {done.stdout}{done.stderr}")
        seconds[name] = time.perf_counter() - started
        print(f"make {name:6} {seconds[name]:6.1f} s   {done.stdout.splitlines()[-1]}", flush=True)
    return seconds


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tb.report.measure.own_rig")
    parser.add_argument("csv", type=Path)
    parser.add_argument("outputs")
    arguments = parser.parse_args()
    check_file(arguments.csv)
    would(f"do with {arguments.csv} all that the tutorial does, and measure how long it takes")
    with tempfile.TemporaryDirectory(prefix="own-rig-") as folder:
        readings = Path(shutil.copy(arguments.csv, folder))
        # The build has the name of the scene, which is new, so no earlier build is used.
        scene = Path(folder) / f"{Path(folder).name}.toml"
        try:
            seconds = timed(readings, arguments.outputs, scene)
            print(f"{load_scene(str(scene)).describe()} networks")
        finally:
            shutil.rmtree(BUILD / scene.stem, ignore_errors=True)
    print("\n".join(closing(sum(seconds.values()))))


if __name__ == "__main__":
    sys.exit(run(main))

"""docs/new-block.md, typed in as it stands: the block trains, simulates and is found out."""

import re
import subprocess
import sys
from pathlib import Path

from copied import ROOT, copy_room


def test_the_worked_example_works(tmp_path: Path) -> None:
    """docs/new-block.md, typed in as it stands: the block trains, simulates and is found out."""
    page = (ROOT / "docs" / "new-block.md").read_text()
    copy = tmp_path / "tactus"
    for room in ("golden", "hdl", "scenes", "tactus", "tb", "docs"):
        copy_room(room, copy)
    named = r"^`([\w/.-]+\.(?:py|toml))`[^\n]*(?:\n[^\n]+)*:\n\n```(?:python|toml)\n(.*?)```"
    files = re.findall(named, page, re.M | re.S)
    assert len(files) >= 4
    for name, text in files:
        (copy / name).parent.mkdir(exist_ok=True)
        (copy / name).write_text(text)
    sheet = re.search(r"^`(docs/blocks/\w+\.md)`.*?\n````markdown\n(.*?)````$", page, re.M | re.S)
    assert sheet
    (copy / sheet[1]).write_text(sheet[2])
    scene = next(name for name, _ in files if name.endswith(".toml"))

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", *words]
        return subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False)

    trained = run("tactus.cli.train", scene)
    assert trained.returncode == 0, trained.stderr
    simulated = run("tactus.verify.sim", scene, "--block", "relu")
    assert simulated.returncode == 0, simulated.stdout + simulated.stderr
    assert "2 benches, 0 failed" in simulated.stdout
    hardware = copy / "hdl" / "activation" / "relu.py"
    hardware.write_text(hardware.read_text().replace("Rounding.ROUND", "Rounding.TRUNCATE"))
    broken = run("tactus.verify.sim", scene, "--block", "relu", "--sim", "icarus")
    assert broken.returncode == 1
    assert "results differ" in broken.stdout

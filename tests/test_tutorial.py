"""The tutorials of docs/tutorial, typed in as they stand in a copy of the project."""

import os
import re
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
from conftest import tiered
from copied import ROOT, copy_room

from tactus.core.folders import ROOMS

FOLDER = ROOT / "docs" / "tutorial"
MONITOR = re.compile(r"^make monitor .*$", re.M)


def shell(text: str, copy: Path) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"VENV": sys.prefix, "TERM": "dumb"}
    environment["PATH"] = f"{sys.prefix}/bin:{environment['PATH']}"
    # pyproject.toml looks newer than the environment, and a copy sets nothing up.
    given = f'make() {{ command make --no-print-directory -o ready "$@"; }}\n{text}'
    return subprocess.run(
        ["bash", "-ec", given],
        cwd=copy,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def look(line: str, copy: Path) -> str:
    """What the browser is given by a monitor, which is then ended."""
    monitor = [sys.executable, "-m", "tactus.cli.commands", "monitor"]
    given = dict(word.split("=", 1) for word in line.split()[2:])
    with subprocess.Popen(
        monitor, cwd=copy, env=os.environ | given, stdout=subprocess.PIPE, text=True
    ) as running:
        try:
            assert running.stdout
            address = re.search(r"http://\S+/", running.stdout.readline())
            assert address
            with urllib.request.urlopen(address[0]) as page:
                return str(page.read(), "utf-8")
        finally:
            running.terminate()


@pytest.mark.parametrize("reader", tiered(["student"], ["researcher", "engineer"]))
def test_a_tutorial_does_what_it_shows(reader: str, tmp_path: Path) -> None:
    page = (FOLDER / f"{reader}.md").read_text(encoding="utf-8")
    for room in (*ROOMS, "docs/tutorial"):
        copy_room(room, tmp_path)
    for name in ("Makefile", "pyproject.toml"):
        (tmp_path / name).write_text((ROOT / name).read_text())
    for name, text in re.findall(r"^`([\w/.-]+)`:\n\n```\w+\n(.*?)```", page, re.M | re.S):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    typed = "".join(re.findall(r"^```sh\n(.*?)```", page, re.M | re.S)).replace(
        "mkdir ", "mkdir -p "
    )
    done = shell(MONITOR.sub("", typed), tmp_path)
    assert done.returncode == 0, f"{done.stdout[-3000:]}{done.stderr[-3000:]}"
    for block in re.findall(r"^```text\n(.*?)```", page, re.M | re.S):
        for line in block.splitlines():
            assert line.strip() in done.stdout, line
    for line in MONITOR.findall(typed):
        assert "place" in look(line, tmp_path)


def test_make_scene_drafts_the_scene_of_the_rail(tmp_path: Path) -> None:
    readings, written = FOLDER / "readings.csv", tmp_path / "rig.toml"
    (tmp_path / "readings.csv").write_text(readings.read_text())
    command = ["tactus.cli.scene", str(tmp_path / "readings.csv"), "force,place"]
    done = subprocess.run(
        [sys.executable, "-m", *command, "--to", str(written)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    text = written.read_text().replace(os.path.relpath(ROOT, tmp_path), "../tactus", 1)
    assert text == (FOLDER / "rig.toml").read_text()

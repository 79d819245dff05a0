"""The tests as on other machines: what is run, what is named, and what the pages say of it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import machines
import pytest
import yaml
from machines import MACHINES, NOT_COPIED, ROOT, SIMULATED, Machine, copy_checkout, main

from golden.machine import SETTINGS

OTHERS = {
    "green": Machine("passes", {"TZ": "Pacific/Chatham"}),
    "never": Machine("cannot be", holds="False", needs="another world"),
}


@pytest.fixture
def asks(tmp_path: Path) -> list[str]:
    """Arguments that run one test, which is green in the time zone of ``green`` alone."""
    test = tmp_path / "test_zone.py"
    test.write_text("import os\n\ndef test_zone():\n    assert os.environ.get('TZ') == ")
    with test.open("a") as handle:
        handle.write(f"{OTHERS['green'].environment['TZ']!r}\n")
    return ["--tests", f"-p no:cacheprovider {test}"]


def run(monkeypatch: pytest.MonkeyPatch, folder: Path, *arguments: str) -> int:
    """``make machines`` with machines of this test."""
    monkeypatch.setattr(sys, "argv", ["machines", *arguments])
    monkeypatch.setattr(machines, "MACHINES", OTHERS | {"red": Machine("nothing changed")})
    monkeypatch.setattr(machines, "LOGS", folder / "logs")
    monkeypatch.delenv("TZ", raising=False)
    return main()


def test_a_line_for_each_and_red_if_one_is(monkeypatch, tmp_path, capsys, asks) -> None:
    assert run(monkeypatch, tmp_path, *asks) == 1
    green, never, red, last = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"passed   green +\d+ s  1 passed in .*", green)
    assert re.fullmatch(r"not run  never +needs another world", never)
    assert re.fullmatch(r"failed   red +\d+ s  1 failed in .*; see .*red\.log", red)
    assert last == "machines: 1 passed, 1 failed, 1 not run"
    assert "assert None == 'Pacific/Chatham'" in (tmp_path / "logs" / "red.log").read_text()


def test_what_cannot_be_is_an_error_where_it_is_asked_for(monkeypatch, tmp_path, asks) -> None:
    assert run(monkeypatch, tmp_path, "green", *asks) == 0
    assert run(monkeypatch, tmp_path, "green", "never", *asks) == 2
    assert run(monkeypatch, tmp_path, "gren", *asks) == 2


def test_make_test_runs_as_another_machine(asks) -> None:
    words = ["make", "--no-print-directory", "test", f"VENV={sys.prefix}", f"TESTS={asks[1]}"]
    environment = os.environ | {"MAKEFLAGS": ""}
    environment.pop("TZ", None)
    for machine, code, closing in (("time-zone", 0, "1 passed"), ("default", 2, "1 failed")):
        result = subprocess.run(
            [*words, f"MACHINE={machine}"],
            cwd=ROOT,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert result.returncode == code, result.stdout + result.stderr
        assert closing in result.stdout


def test_a_copy_has_the_files_and_the_umask(tmp_path: Path) -> None:
    machine = Machine("", copy="takt", umask=0o077)
    copy_checkout(tmp_path / "takt", machine)
    files = [path for path in (tmp_path / "takt").rglob("*") if path.is_file()]
    assert (tmp_path / "takt" / "tests" / "machines.py") in files
    assert not any(path.stat().st_mode & 0o077 for path in files)
    assert {path.name for path in (tmp_path / "takt").iterdir()} >= {"golden", "hdl", "tb"}
    assert not (tmp_path / "takt" / "build").exists()
    ignored = (ROOT / ".gitignore").read_text().split()
    assert {line.strip("/") for line in ignored} <= {*NOT_COPIED, ".venv"} | {
        ".mypy_cache",
        ".ruff_cache",
        ".pytest_cache",
    }


def test_simulated_tests_are_those_of_files_that_are_there() -> None:
    for name in SIMULATED:
        file, _, function = name.partition("::")
        text = (ROOT / "tests" / file).read_text()
        assert f"def {function or 'test_'}" in text, name


def test_the_settings_are_those_that_figures_are_measured_under() -> None:
    assert {name: MACHINES[name].environment for name in SETTINGS} == SETTINGS


def test_every_night_runs_every_machine() -> None:
    text = (ROOT / ".github" / "workflows" / "machines.yml").read_text()
    matrix = yaml.safe_load(text)["jobs"]["machine"]["strategy"]["matrix"]
    named = [*matrix["machine"], *(entry["machine"] for entry in matrix["include"])]
    assert sorted(named) == sorted(MACHINES)


def test_the_page_has_every_machine() -> None:
    page = (ROOT / "docs" / "verification.md").read_text()
    rows = re.findall(r"^\| `([\w.-]+)` \| (.*?) \| (.*?) \|$", page, re.M)
    assert rows == [
        (
            name,
            machine.what,
            " ".join(f"`{k}={v}`" for k, v in machine.environment.items()),
        )
        for name, machine in MACHINES.items()
    ]

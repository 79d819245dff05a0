"""Tests make machines: which tests it runs, what it prints, and what the pages say of it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import machines
import pytest
import yaml
from groups import EVERYTHING, FILES, GROUPS, SIMULATED, Group, Rest
from machines import MACHINES, NOT_COPIED, ROOT, Machine, copy_checkout, main

OTHERS = {
    "green": Machine("passes", FILES, {"TZ": "Pacific/Chatham"}),
    "never": Machine("cannot be", holds="False", needs="another world"),
    "again": Machine("green by another name", FILES, {"TZ": "Pacific/Chatham"}),
}
RESTS = {id(rest): rest for group in GROUPS for rest in group.rests}.values()


@pytest.fixture
def asks(tmp_path: Path) -> list[str]:
    """Arguments that run one test, which only passes in the time zone of machine ``green``."""
    test = tmp_path / "test_zone.py"
    test.write_text("import os\n\ndef test_zone():\n    assert os.environ.get('TZ') == ")
    with test.open("a") as handle:
        handle.write(f"{OTHERS['green'].environment['TZ']!r}\n")
    return ["--tests", f"-p no:cacheprovider {test}"]


def run(monkeypatch: pytest.MonkeyPatch, folder: Path, *arguments: str) -> int:
    """Run ``make machines`` with the machines of this test."""
    monkeypatch.setattr(sys, "argv", ["machines", *arguments])
    monkeypatch.setattr(machines, "MACHINES", OTHERS | {"red": Machine("nothing changed")})
    monkeypatch.setattr(machines, "LOGS", folder / "logs")
    monkeypatch.delenv("TZ", raising=False)
    return main()


def test_a_line_for_each_and_red_if_one_is(monkeypatch, tmp_path, capsys, asks) -> None:
    assert run(monkeypatch, tmp_path, *asks) == 1
    green, never, again, red, last = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"passed   green +chosen +\d+ s  1 passed in .*", green)
    assert re.fullmatch(r"not run  never +needs another world", never)
    assert re.fullmatch(r"passed   again +is green here", again)
    assert re.fullmatch(r"failed   red +chosen +\d+ s  1 failed in .*; see .*red\.log", red)
    assert last == "machines: 2 passed, 1 failed, 1 not run"
    assert "assert None == 'Pacific/Chatham'" in (tmp_path / "logs" / "red.log").read_text()


def test_what_cannot_be_is_an_error_where_it_is_asked_for(monkeypatch, tmp_path, asks) -> None:
    assert run(monkeypatch, tmp_path, "--only=green", *asks) == 0
    assert run(monkeypatch, tmp_path, "--only=green never", *asks) == 2
    assert run(monkeypatch, tmp_path, "--only=gren", *asks) == 2
    assert run(monkeypatch, tmp_path, "--only=--help", *asks) == 2


def test_the_line_has_what_pytest_counted() -> None:
    """This holds even if make prints something after it."""
    counted = "1 failed, 2 passed, 3 warnings in 4.05s (0:00:04)"
    assert machines.closing(f"a\n== {counted} ==\nmake: *** [test] Error 1\n") == counted
    assert machines.closing("no such package\nmake: *** [.venv] Error 1\n").startswith("make: ")


def test_make_test_runs_as_another_machine(asks) -> None:
    words = ["make", "--no-print-directory", "test", f"VENV={sys.prefix}", f"TESTS={asks[1]}"]
    environment = {name: text for name, text in os.environ.items() if name != "TZ"}
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


def test_a_machine_runs_its_group_or_all(monkeypatch, tmp_path, capsys) -> None:
    rests = (Rest("One.", ("test_a.py", "test_b.py::test_c")), Rest("Other.", ("test_d.py",)))
    few = replace(OTHERS["green"], group=Group("few", "little", rests))
    monkeypatch.setitem(OTHERS, "green", few)
    left_out = [f"--deselect=tests/{name}" for name in (*rests[0].tests, *rests[1].tests)]
    ran = []
    monkeypatch.setattr(machines, "run", lambda machine, tests, output: ran.append(tests) or 0)
    for words in ([], ["--whole"], ["--all"], ["--tests", "tests/test_a.py"]):
        assert run(monkeypatch, tmp_path, "--only=green", *words) == 0
    assert ran == [left_out, [], ["--all"], ["tests/test_a.py"]]
    said = [line.split()[2] for line in capsys.readouterr().out.splitlines()]
    assert said == ["few", "everything", "everything", "chosen"]


def test_what_is_left_out_is_there_and_has_a_reason() -> None:
    for rest in RESTS:
        assert re.fullmatch(r"[A-Z].*\.", rest.why)
        assert rest.tests == tuple(sorted(set(rest.tests)))
        for name in rest.tests:
            file, _, function = name.partition("::")
            assert f"def {function or 'test_'}" in (ROOT / "tests" / file).read_text(), name


def test_every_test_is_in_a_group_besides_everything() -> None:
    """Simulated tests are an exception."""
    assert EVERYTHING.leaves_out() == []
    assert {machine.group.name for machine in MACHINES.values()} == {g.name for g in GROUPS}
    for file in {path.name for path in (ROOT / "tests").glob("test_*.py")} - {*SIMULATED.tests}:
        groups = [group.name for group in GROUPS if file not in group.leaves_out()]
        assert groups != ["everything"], file


def test_every_night_runs_every_machine() -> None:
    text = (ROOT / ".github" / "workflows" / "machines.yml").read_text()
    matrix = yaml.safe_load(text)["jobs"]["machine"]["strategy"]["matrix"]
    named = [*matrix["machine"], *(entry["machine"] for entry in matrix["include"])]
    assert sorted(named) == sorted(MACHINES)


def test_the_page_has_every_machine() -> None:
    page = (ROOT / "docs" / "verification.md").read_text()
    rows = re.findall(r"^\| `([\w.-]+)` \| (\w+) \| (.*?) \| (.*?) \|$", page, re.M)
    assert rows == [
        (
            name,
            machine.group.name,
            machine.what,
            " ".join(f"`{k}={v}`" for k, v in machine.environment.items()),
        )
        for name, machine in MACHINES.items()
    ]
    for group in GROUPS:
        assert f"\n| {group.name} | {group.changes} |\n" in page

"""Tests the machines of make test MACHINE=: their matrix, how they run, and what they leave out."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import chosen
import machines
import pytest
import yaml
from groups import EVERYTHING, GROUPS, SIMULATED
from machines import NOT_COPIED, ROOT, WORKFLOW, Machine, has_effect, run_on

from golden.input_error import InputError
from golden.machine import SETTINGS

MACHINES = machines.machines()
RESTS = {id(rest): rest for group in GROUPS.values() for rest in group.rests}.values()


def make_test(*variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["make", "--no-print-directory", "test", f"VENV={sys.prefix}", *variables],
        cwd=ROOT,
        env={name: text for name, text in os.environ.items() if name != "TZ"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_make_test_runs_as_another_machine(tmp_path: Path) -> None:
    test = tmp_path / "test_zone.py"
    zone = MACHINES["time-zone"].env["TZ"]
    test.write_text(f"import os\n\ndef test_zone():\n    assert os.environ.get('TZ') == {zone!r}\n")
    tests = f"TESTS=-n 0 -p no:cacheprovider {test}"
    as_machine, as_here = make_test(tests, "MACHINE=time-zone"), make_test(tests)
    assert (as_machine.returncode, as_here.returncode) == (0, 2)
    assert "1 passed" in as_machine.stdout
    assert "1 failed" in as_here.stdout


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("--machine=lokale", "MACHINE=lokale: no such machine, expected numpy-avx2, "),
        ("--machine=--help", "MACHINE=--help: no such machine, expected numpy-avx2, "),
        ("--group=letters", "GROUP=letters: no such group, expected everything, versions, "),
    ],
)
def test_an_unknown_name_is_refused(
    monkeypatch: pytest.MonkeyPatch, word: str, message: str
) -> None:
    monkeypatch.setattr(sys, "argv", ["chosen", word])
    with pytest.raises(InputError, match=message):
        chosen.main()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("LC_ALL", "de_DE.KOI-9"),
        ("OPENBLAS_CORETYPE", "Z80"),
        ("OPENBLAS_NUM_THREADS", "0"),
        ("PYTHON", "python2.9"),
    ],
)
def test_a_variable_without_effect_is_refused(name: str, value: str) -> None:
    """Otherwise the tests would pass as on this machine."""
    with pytest.raises(InputError, match=f"MACHINE=other: {name}={value} has no effect"):
        run_on(Machine("other", "", "files", {name: value}, run="true"), "files")


def test_what_the_processor_still_does_has_an_effect(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machines, "numpy_targets", lambda: ["SSE2", "AVX512_SKX"])
    assert has_effect("NPY_DISABLE_CPU_FEATURES", "X86_V3")
    assert not has_effect("NPY_DISABLE_CPU_FEATURES", "X86_V4")


def test_a_machine_has_its_folder_and_its_commands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first command that fails ends the run, and the copy has no more than the checkout."""
    monkeypatch.setenv("MACHINE", "here")
    monkeypatch.setenv("MAKEFLAGS", "-n")
    there = tmp_path / "there"
    said = '"$PWD" "$GROUP" "$VENV" "$SIZE" "${MACHINE-none}" "${MAKEFLAGS-none}"'
    run = f"printf '%s\\n' {said} > {shlex.quote(str(there))}; ls -A >> {there}; false; rm {there}"
    machine = Machine("other", "", "order", {"SIZE": "3"}, "takt ü s", run)
    assert run_on(machine, "files") == 1
    folder, *words = there.read_text(encoding="utf-8").splitlines()
    assert Path(folder).name == "takt ü s"
    assert not Path(folder).exists()
    assert words[:5] == ["files", ".venv", "3", "none", "none"]
    assert {"Makefile", "golden", "hdl", "tb", "tests", ".github"} <= {*words[5:]}
    assert not {"build", ".git", ".venv"} & {*words[5:]}
    ignored = (ROOT / ".gitignore").read_text().split()
    caches = {".mypy_cache", ".ruff_cache", ".pytest_cache"}
    assert {line.strip("/") for line in ignored} <= {*NOT_COPIED, ".venv"} | caches


@pytest.mark.parametrize(
    ("words", "group"),
    [
        ([], "order"),
        (["--group=files"], "files"),
        (["--tests=tests/test_lut.py"], ""),
        (["--pages"], ""),
        (["--pages", "--group=files"], "files"),
    ],
)
def test_a_machine_runs_its_group_or_what_is_named(
    monkeypatch: pytest.MonkeyPatch, words: list[str], group: str
) -> None:
    ran = []
    monkeypatch.setattr(chosen, "run_on", lambda machine, group: ran.append((machine, group)))
    monkeypatch.setattr(sys, "argv", ["chosen", "--machine=hash-seed-1", *words])
    chosen.main()
    assert ran == [(MACHINES["hash-seed-1"], group)]


@pytest.mark.parametrize("name", GROUPS)
def test_a_group_leaves_its_rests_out(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    ran: list[list[str]] = []
    monkeypatch.setattr(os, "execv", lambda _, command: ran.append(command))
    monkeypatch.setattr(sys, "argv", ["chosen", f"--group={name}"])
    chosen.main()
    left_out = [word for word in ran[0] if word.startswith("--deselect")]
    rests = GROUPS[name].rests
    assert left_out == [f"--deselect=tests/{test}" for rest in rests for test in rest.tests]


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
    for file in {path.name for path in (ROOT / "tests").glob("test_*.py")} - {*SIMULATED.tests}:
        groups = [group for group in GROUPS.values() if file not in group.leaves_out()]
        assert groups != [EVERYTHING], file


def test_the_matrix_says_what_the_script_reads() -> None:
    job = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))["jobs"]["machine"]
    assert job["steps"][-1] == {"run": "make test MACHINE=${{ matrix.machine }}"}
    assert len(job["strategy"]["matrix"]["include"]) == len(MACHINES)
    for machine in MACHINES.values():
        assert machine.group in GROUPS
        assert all(isinstance(value, str) for value in machine.env.values())
        # A command of a machine may change the owner or the rights of its folder.
        assert machine.folder or machine.run == "make test"
    assert {name: MACHINES[name].env for name in SETTINGS} == SETTINGS


def test_the_page_has_every_machine() -> None:
    page = (ROOT / "docs" / "verification.md").read_text()
    rows = re.findall(
        r"^\| (\w+) \| (.*?) \| (.*?) \|$", page.partition("\n## Other machines")[2], re.M
    )
    assert rows[1:] == [
        (
            group.name,
            group.changes,
            ", ".join(f"`{m.machine}`" for m in MACHINES.values() if m.group == group.name),
        )
        for group in GROUPS.values()
    ]

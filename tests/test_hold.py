"""Tests that commands on one scene, or on scenes of one name, wait for each other."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import tiered

from tactus.core.fingerprint import ROOT
from tactus.core.hold import VARIABLE, held
from tactus.verify.benches.collected import CASES_OF
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

WAITS = "from tactus.core.hold import held; import sys; from pathlib import Path\n"
WAITS += "with held([Path(sys.argv[1])]): print('has it', flush=True); sys.stdin.read()"


def waiting(folder: Path, **variables: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", WAITS, str(folder)],
        cwd=ROOT,
        env=os.environ | variables,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_second_command_names_the_first_and_waits_for_its_end(tmp_path: Path) -> None:
    with waiting(tmp_path / "mine") as first:
        assert first.stdout.readline() == "has it\n"
        with waiting(tmp_path / "mine") as second:
            said = second.stdout.readline()
            assert said.startswith(f"{tmp_path / 'mine'}: waiting for process {first.pid}, ")
            first.stdin.close()
            assert second.communicate()[0].splitlines()[-1] == "has it"


def test_a_command_that_was_called_by_the_first_does_not_wait(tmp_path: Path) -> None:
    with held([tmp_path / "mine"]), waiting(tmp_path / "mine") as called:
        assert called.stdout.readline() == "has it\n"
        called.communicate()
    assert VARIABLE not in os.environ or not os.environ[VARIABLE]


@pytest.mark.parametrize("blocked", [0o500, None])
def test_a_folder_that_cannot_be_held_is_left_to_those_that_write(
    tmp_path: Path, blocked: int | None
) -> None:
    place = tmp_path / "there"
    place.touch() if blocked is None else place.mkdir(mode=blocked)
    with held([place / "mine"]):
        pass


@pytest.mark.parametrize(
    "words",
    tiered(
        ["tactus.verify.sim same.toml --sim=icarus", "tactus.verify.prove --block=abs_unit"],
        [
            "tactus.cli.demo same.toml",
            "tactus.export same.toml vhdl",
            "tactus.report same.toml",
            "tactus.certify same.toml",
            "tactus.verify.sign_off.mutate --scene=same.toml",
            "tactus.verify.sign_off.mutate --block=abs_unit",
            "tactus.verify.sign_off.coverage --block=abs_unit",
            "tactus.verify.sim --block=abs_unit --netlist=1 --record",
        ],
    ),
)
def test_commands_wait_for_others_on_the_same_folder(tmp_path: Path, words: str) -> None:
    write_scene(tmp_path, "same", "exact", [random_mlp((3, 4, 2), 1.0, 1)])
    name = CASES_OF["abs_unit"][0] if "--block" in words else "same"
    with (
        held([tmp_path / "build" / name]),
        subprocess.Popen(
            [sys.executable, "-m", *words.split()],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(ROOT), VARIABLE: ""},
            stdout=subprocess.PIPE,
            text=True,
        ) as command,
    ):
        try:
            assert any(f"waiting for process {os.getpid()}," in line for line in command.stdout)
        finally:
            command.kill()


def test_a_second_search_takes_what_the_first_has_found(tmp_path: Path) -> None:
    write_scene(tmp_path, "same", "exact", [random_mlp((3, 4, 2), 1.0, 1)])
    searches = [
        subprocess.Popen(
            [sys.executable, "-m", "tactus.cli.train", "same.toml", "--workers=1"],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            stdout=subprocess.DEVNULL,
        )
        for _ in range(2)
    ]
    assert [search.wait() for search in searches] == [0, 0]
    (record,) = tmp_path.glob("build/store/training/*/0.jsonl")
    lines = record.read_text().splitlines()
    assert len(lines) == len(set(lines)) > 0

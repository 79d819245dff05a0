"""The files that an export adds to the entities run, parse, and list the existing files."""

import re
import shutil
from pathlib import Path
from subprocess import CompletedProcess

import pytest
import yaml
from conftest import tiered
from shared import Shared, run

from tactus.core.fingerprint import fingerprint
from tactus.export.exporter import compile_order
from tactus.scene import load_scene
from tactus.verify.benches.runner import export
from tactus.verify.benches.simulate import QUICK
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# Values of several networks at once; frames further apart than their length; networks of different
# depth; AXI4-Stream; frames without outputs, which are the past of others; the largest output.
EVERY_RUN = ("digit-parallel", "wide", "chain", "axis", "past", "winner")
# A profile beside the outputs; single values; slots, also behind AXI4-Stream; an engine that is
# loaded first; converters on an SPI and a serial line; the largest output behind each of these.
EXPORTED = tiered(
    EVERY_RUN,
    [
        *("digit", "drawn", "least", "pade-parallel", "three", "axis-chain", "one-sensor"),
        *("rails-reload", "past-instrument", "converter", "uart", "winner-axis", "winner-past"),
        *("winner-uart", "winner-reload", "winner-instrument"),
    ],
)
FAULTS = [
    ("wide", "hybrid.vhd", r"out_last => out_last", "out_last => open"),
    ("pade-parallel", "parallel.vhd", r"in_data_1 => in_data_1", "in_data_1 => in_data_0"),
    ("chain", "cascade.vhd", r"in_data_0 => gathered_0", "in_data_0 => gathered_1"),
    ("axis", "axis_network.vhd", r"credit0_used = (\d+)", "credit0_used = 7"),
    ("axis-chain", "axis_network.vhd", r"s_axis_tready <= gate0_ready", "s_axis_tready <= '0'"),
    ("past", "frame_window.vhd", r"past_whole0_known = 5", "past_whole0_known = 4"),
    ("winner", "readout.vhd", r"out_index => winner_index", "out_index => open"),
    ("winner-past", "argmax.vhd", r"low < \w*margin", "low <= 0"),
    (
        "winner-uart",
        "uart_instrument.vhd",
        r"winner_index <= \w+",
        "winner_index <= (others => '0')",
    ),
    # The results are right, but frames are refused or flagged.
    ("wide", "input_controller_of_2_every_5.vhd", r"frame_error <= broken", "frame_error <= done"),
]


@pytest.fixture
def library(shared: Shared, name: str) -> Path:
    """A copy of the library of a scene, with its test bench and example, for all tests."""
    work = shared.folder / "libraries" / name
    top = shared.scene(name).twin().entity

    def make() -> None:
        shutil.copytree(shared.library(name), work)
        more = [f"{top}_{part}.vhd" for part in ("vectors", "tb", "example")]
        analyse(shared.export(name, "vhdl"), work, *more, start=more[0])

    shared.once(f"library {name}", make)
    return work


def analyse(folder: Path, work: Path, *more: str, start: str = "") -> None:
    """Analyse every file in order, then the others, as a user does; or from ``start`` on."""
    names = [*compile_order(folder), *more]
    names = names[names.index(start) if start else 0 :]
    # The library says that it had the changed ones from elsewhere.
    options = ["--std=93", QUICK, *(["-Wno-library"] if start else [])]
    result = run("ghdl", "-a", *options, *(folder / name for name in names), folder=work)
    assert result.returncode == 0, result.stderr
    assert not result.stderr


def simulate(work: Path, top: str) -> CompletedProcess[str]:
    """Run the test bench as docs/handover.md says."""
    assert run("ghdl", "-e", "--std=93", f"{top}_tb", folder=work).returncode == 0
    words = ("--std=93", f"{top}_tb", "--ieee-asserts=disable")
    return run("ghdl", "-r", *words, folder=work)


def counts(result: CompletedProcess[str]) -> list[tuple[int, int]]:
    found = re.findall(r"(\d+) of (\d+) frames match", result.stdout + result.stderr)
    return [(int(matched), int(frames)) for matched, frames in found]


@pytest.mark.parametrize("name", EXPORTED)
def test_every_recorded_frame_matches(shared: Shared, library: Path, name: str) -> None:
    scene = shared.scene(name)
    result = simulate(library, scene.twin().entity)
    frames = len(scene.vectors().codes)
    text = result.stdout + result.stderr
    assert counts(result) == [(frames, frames)] * 2, text
    assert text.count(f"{frames} of {frames} winners match") == 2 * name.startswith("winner"), text
    assert result.returncode == 0


@pytest.mark.parametrize(
    ("name", "file", "pattern", "text"),
    [
        pytest.param(*fault, marks=[] if fault[0] in EVERY_RUN else [pytest.mark.all_only])
        for fault in FAULTS
    ],
)
def test_a_fault_in_an_entity_fails(
    shared: Shared, library: Path, tmp_path: Path, name: str, file: str, pattern: str, text: str
) -> None:
    top = shared.scene(name).twin().entity
    copy, work = tmp_path / "vhdl", tmp_path / "work"
    shutil.copytree(shared.export(name, "vhdl"), copy)
    shutil.copytree(library, work)
    source, count = re.subn(pattern, text, (copy / file).read_text(), count=1)
    assert count == 1, f"{pattern} is not in {file}"
    (copy / file).write_text(source)
    analyse(copy, work, f"{top}_vectors.vhd", f"{top}_tb.vhd", start=file)
    result = simulate(work, top)
    assert result.returncode != 0
    assert "does not give the recorded results" in result.stdout + result.stderr


@pytest.mark.parametrize("name", EVERY_RUN)
@pytest.mark.parametrize("language", ["vhdl", "verilog"])
def test_the_core_file_lists_exactly_the_files(shared: Shared, name: str, language: str) -> None:
    folder = shared.export(name, language)
    top = shared.scene(name).twin().entity
    text = (folder / f"{name}.core").read_text()
    assert text.startswith("CAPI=2:\n")
    core = yaml.safe_load(text)
    assert core["name"] == f"tactus::{name}:0"
    assert core["filesets"]["rtl"]["files"] == compile_order(folder)
    assert core["targets"]["default"] == {"filesets": ["rtl"], "toplevel": top}
    if language == "vhdl":
        assert core["filesets"]["tb"]["files"] == [f"{top}_vectors.vhd", f"{top}_tb.vhd"]
        assert core["targets"]["sim"]["filesets"] == ["rtl", "tb"]
        assert core["targets"]["sim"]["toplevel"] == f"{top}_tb"
    listed = [file for files in core["filesets"].values() for file in files["files"]]
    assert all((folder / file).is_file() for file in listed)
    known = {f"{top}_example{Path(listed[0]).suffix}"}
    sources = {p.name for p in folder.iterdir() if p.suffix in {".vhd", ".v"}}
    assert sources == set(listed) | known


@pytest.mark.parametrize("name", EXPORTED)
def test_the_examples_compile(shared: Shared, library: Path, tmp_path: Path, name: str) -> None:
    top = shared.scene(name).twin().entity
    assert run("ghdl", "-e", "--std=93", f"{top}_example", folder=library).returncode == 0
    folder = shared.export(name, "verilog")
    files = [folder / file for file in [*compile_order(folder), f"{top}_example.v"]]
    result = run("iverilog", "-Wall", "-o", tmp_path / "a.out", "-s", f"{top}_example", *files)
    assert result.returncode == 0, result.stderr
    assert f"{top}_example.v" not in result.stderr


def test_the_constraints_name_the_clock(tmp_path: Path) -> None:
    path = write_scene(tmp_path, "slow", "exact", [random_mlp((2, 3, 1), 1.0, 1)])
    path.write_text(path.read_text().replace("[hardware]", "[hardware]\nclock_mhz = 12.5"))
    export(load_scene(str(path)), "verilog", tmp_path)
    folder = tmp_path / "slow" / "verilog"
    assert 'PERIOD "clk" 80.000 ns' in (folder / "ise.ucf").read_text()
    board = (folder / "arty_a7_35.xdc").read_text()
    # This is the oscillator of the board, whatever the clock of the scene.
    assert "create_clock -name clk -period 10.000" in board
    assert "PACKAGE_PIN E3" in board


def test_a_name_that_vhdl_does_not_take(tmp_path: Path) -> None:
    path = write_scene(tmp_path, "größe 1", "exact", [random_mlp((2, 3, 1), 1.0, 1)])
    export(load_scene(str(path)), "vhdl", tmp_path)
    # GHDL itself does not accept such a folder.
    folder = (tmp_path / "größe 1" / "vhdl").rename(tmp_path / "vhdl")
    assert all(file.read_text().isascii() for file in folder.iterdir())
    assert yaml.safe_load((folder / "gr__e_1.core").read_text())["name"] == "tactus::gr__e_1:0"
    analyse(folder, tmp_path, "hybrid_vectors.vhd", "hybrid_tb.vhd")
    assert simulate(tmp_path, "hybrid").returncode == 0


def test_new_recordings_are_exported_again(tmp_path: Path) -> None:
    path = write_scene(tmp_path, "one", "exact", [random_mlp((2, 3, 1), 1.0, 1)])
    export(load_scene(str(path)), "vhdl", tmp_path)
    before = fingerprint([tmp_path / "one" / "vhdl"])
    table = tmp_path / "one.csv"
    lines = table.read_text().splitlines()
    table.write_text("\n".join(lines[:-1]) + "\n")
    export(load_scene(str(path)), "vhdl", tmp_path)
    assert fingerprint([tmp_path / "one" / "vhdl"]) != before
    assert (
        "frames: positive := 11;" in (tmp_path / "one" / "vhdl" / "hybrid_vectors.vhd").read_text()
    )

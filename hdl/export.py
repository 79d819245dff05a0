"""``python -m hdl.export SCENE LANGUAGE``: a scene as VHDL or Verilog, one file an entity.

The same scene gives the same bytes on every run (``hdl.repeatable``).
"""

from __future__ import annotations

import argparse
import json
import platform
import warnings
from pathlib import Path

import myhdl
from myhdl import ToVerilogWarning, ToVHDLWarning

from golden.files import replace_folder
from golden.fingerprint import fingerprint, sources
from golden.scene import Scene, load_scene
from hdl.common.lookup import latency
from hdl.elaborate import elaborate
from hdl.handover.write import write_handover
from hdl.hierarchy import LANGUAGES, SUFFIX, convert_hierarchy
from hdl.repeatable import run_repeatable

# Functions that MyHDL's VHDL calls (stdl, bool); MyHDL writes the package beside its output.
VHDL_PACKAGE = "pck_myhdl_011"
ORDER = "compile_order.txt"
MANIFEST = "manifest.json"


def export(scene: Scene, language: str, folder: Path) -> list[str]:
    """Write the scene's network into ``folder``, replacing it as a whole.

    Parameters
    ----------
    scene : Scene
    language : str
        "vhdl" or "verilog".
    folder : Path
        Beside the entities it gets ``compile_order.txt``, the files in compile order, and
        ``manifest.json``, which names block, file and latency of every entity, and what
        ``hdl.handover`` writes.

    Returns
    -------
    list of str
        File names in compile order.

    Raises
    ------
    FileNotFoundError, ValueError
        For a fault of the scene, its data or its network; nothing is written then.
    """
    design = scene.design()
    with replace_folder(folder) as temporary, warnings.catch_warnings():
        # A conversion that MyHDL is not sure of is a fault.
        warnings.simplefilter("error", ToVHDLWarning)
        warnings.simplefilter("error", ToVerilogWarning)
        specs = convert_hierarchy(elaborate(design), temporary, language)
        suffix = SUFFIX[language]
        files = [f"{spec.entity}{suffix}" for spec in specs]
        if language == "vhdl":
            files.insert(0, f"{VHDL_PACKAGE}{suffix}")
        (temporary / ORDER).write_text("".join(f"{name}\n" for name in files), encoding="utf-8")
        manifest = [
            {
                "entity": spec.entity,
                "block": spec.block,
                "area": spec.area,
                "file": f"{spec.entity}{suffix}",
                "latency": latency(spec),
            }
            for spec in specs
        ]
        (temporary / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")
        write_handover(scene, design, temporary, ORDER, files, language)
    return files


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m hdl.export", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("language", choices=sorted(LANGUAGES))
    parser.add_argument("--build", type=Path, default=Path("build"))
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    top = scene.design().entity
    folder = arguments.build / scene.name / arguments.language
    stamp = folder.parent / f".{arguments.language}.stamp"
    inputs = [*sources("golden", "hdl"), *scene.files]
    versions = (myhdl.__version__, platform.python_version())
    if not _is_current(stamp, folder, inputs, versions):
        export(scene, arguments.language, folder)
        stamp.write_text(_state(folder, inputs, versions), encoding="utf-8")
    count = len((folder / ORDER).read_text(encoding="utf-8").split())
    print(f"{count} files in {folder}, top {top}, compile order in {folder / ORDER}")


def _state(folder: Path, inputs: list[Path], versions: tuple[str, ...]) -> str:
    """What went in and what came out: a change of either asks for a new export."""
    return fingerprint([*inputs, folder], *versions)


def _is_current(stamp: Path, folder: Path, inputs: list[Path], versions: tuple[str, ...]) -> bool:
    return (
        stamp.is_file()
        and folder.is_dir()
        and stamp.read_text(encoding="utf-8") == _state(folder, inputs, versions)
    )


if __name__ == "__main__":
    run_repeatable("hdl.export", main)

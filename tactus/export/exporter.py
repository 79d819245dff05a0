"""Writes a scene as VHDL or Verilog: a file for each entity, and what users start from.

The export is current as long as a new one would give the same files. It holds the docstrings of
its blocks as comments, so its key is made of the whole text of the sources, not of their code.
"""

import json
import platform
import warnings
from functools import cache
from pathlib import Path

import myhdl
from myhdl import ToVerilogWarning, ToVHDLWarning

from tactus.core import store
from tactus.core.closure import closure
from tactus.core.files import replace_folder
from tactus.core.fingerprint import ROOT, fingerprint
from tactus.export.handover import plain_name, write_handover
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.export.tidy import SUFFIX
from tactus.scene import Scene

# This package declares functions that MyHDL's VHDL calls (stdl, bool). MyHDL writes it beside its
# output.
VHDL_PACKAGE = "pck_myhdl_011"
ORDER = "compile_order.txt"
MANIFEST = "manifest.json"


def compile_order(folder: Path) -> list[str]:
    return (folder / ORDER).read_text(encoding="utf-8").split()


def export(scene: Scene, language: str, folder: Path) -> list[str]:
    """Write the scene's network into ``folder``, replacing it as a whole.

    language: "vhdl" or "verilog".
    folder: Beside the entities it gets three things: ``compile_order.txt``, which lists the files
        in compile order; ``manifest.json``, which names block, file and latency of every entity;
        and the files that ``write_handover`` writes.

    Returns: File names in compile order.
    """
    design = scene.twin()
    with replace_folder(folder) as temporary, warnings.catch_warnings():
        # A warning means that MyHDL is not sure of a conversion. That is a fault here.
        warnings.simplefilter("error", ToVHDLWarning)
        warnings.simplefilter("error", ToVerilogWarning)
        # Where an image is loaded, the image makes the scene, and the hardware serves any scene.
        origin = None if design.image else f"scene {plain_name(scene.name)}"
        specs = convert_hierarchy(elaborate(design), temporary, language, origin)
        suffix = SUFFIX[language]
        files = [f"{spec.entity}{suffix}" for spec in specs]
        if language == "vhdl":
            files.insert(0, f"{VHDL_PACKAGE}{suffix}")
        (temporary / ORDER).write_text("".join(f"{name}\n" for name in files))
        manifest = [
            {
                "entity": spec.entity,
                "block": spec.block,
                "area": spec.area,
                "file": f"{spec.entity}{suffix}",
                "latency": spec.latency,
            }
            for spec in specs
        ]
        (temporary / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n")
        write_handover(scene, design, temporary, ORDER, files, language)
    return files


def is_current(scene: Scene, folder: Path) -> bool:
    """Whether the folder of a language holds what the scene gives with these sources."""
    return folder.is_dir() and store.read(*_asked(scene, folder)) == fingerprint([folder])


def write_stamp(scene: Scene, folder: Path) -> None:
    """Keep a digest of what the folder holds, under the key of what it was exported from."""
    asked, build = _asked(scene, folder)
    store.write(asked, fingerprint([folder]), build)


def _asked(scene: Scene, folder: Path) -> tuple[store.Key, Path]:
    """The key of an export, and the folder for results that it is in."""
    asked = store.key(
        "export",
        scene=scene.name,
        language=folder.name,
        files=[*scene.files, ROOT / "scenes" / "data"],
        sources=_sources(),
        tools=[f"myhdl {myhdl.__version__}", f"python {platform.python_version()}"],
    )
    return asked, folder.parents[1]


@cache
def _sources() -> str:
    """A digest of the modules that read and export a scene, and of the data beside them."""
    modules = closure(["tactus.export.command"]).values()
    beside = {file for folder in {path.parent for path in modules} for file in folder.iterdir()}
    data = sorted(file for file in beside if file.suffix in {".csv", ".jinja", ".toml"})
    return fingerprint([*modules, *data])

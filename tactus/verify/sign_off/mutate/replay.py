"""What a bench drove, saw and looked at, played again in plain Verilog for each mutant."""

import json
import re
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tactus.core.templates import environment

PORT = re.compile(r"^(input|output) (?:signed )?(?:\[(\d+):0\] )?(\w+);", re.MULTILINE)


@dataclass(frozen=True)
class Trace:
    """A trace and its test bench in a folder, and the outputs of its columns with their widths.

    ``masks`` names the flag of each output that the bench looks at only where the flag is high.
    """

    folder: Path
    outputs: dict[str, int]
    rows: int
    masks: dict[str, str]


def write_trace(recorded: Path, entity: str, folder: Path) -> Trace:
    """Write what a bench did as a trace, and a test bench that plays it to an entity.

    The trace has a line for each clock: what is driven, and what is due, with z where the bench
    does not look. Parts in which it looks at more ports come first, so that mutants differ early.
    The folder holds the exported Verilog of the entity.
    """
    exported = (folder / f"{entity}.v").read_text(encoding="utf-8")
    ports = {name: (way, int(top or 0) + 1) for way, top, name in PORT.findall(exported)}
    parts = [json.loads(line) for line in recorded.read_text(encoding="utf-8").splitlines()]
    parts.sort(key=lambda part: -sum("1" in looked for looked in part["looked"].values()))
    names = list(dict.fromkeys(name for part in parts for name in part["columns"]))
    inputs = {n: ports[n][1] for n in names if ports[n][0] == "input"}
    outputs = {n: ports[n][1] for n in names if ports[n][0] == "output"}
    lines = []
    # What a part does not drive keeps what it had.
    held = {name: "z" * width for name, width in inputs.items()}
    for part in parts:
        columns = part["columns"]
        for row in range(len(next(iter(columns.values())))):
            held |= {name: columns[name][row] for name in inputs if name in columns}
            lines.append(f"{''.join(held.values())} {''.join(_due(part, outputs, row))}\n")
    (folder / "trace.txt").write_text("".join(lines), encoding="ascii")
    template = environment("tactus.verify.sign_off.mutate").get_template("replay.v.jinja")
    text = template.render(inputs=inputs, outputs=outputs, entity=entity, clocked="clk" in ports)
    (folder / "replay.v").write_text(text, encoding="utf-8")
    return Trace(folder, outputs, len(lines), masks_of(parts, outputs))


def _due(part: dict[str, Any], outputs: dict[str, int], row: int) -> Iterable[str]:
    for name, width in outputs.items():
        looked = name in part["columns"] and part["looked"][name][row] == "1"
        yield part["columns"][name][row] if looked else "z" * width


def masks_of(parts: list[dict[str, Any]], outputs: Iterable[str]) -> dict[str, str]:
    """By output: the flag of its stream, where the bench never looks while the flag is low."""
    flags = [name for name in outputs if name.endswith("valid")]
    found = {}
    for name in outputs:
        stem = [flag for flag in flags if name.startswith(flag.removesuffix("valid"))]
        if name not in flags and stem and all(_only_with(part, name, stem[0]) for part in parts):
            found[name] = stem[0]
    return found


def _only_with(part: dict[str, Any], name: str, flag: str) -> bool:
    columns = part["columns"]
    if name not in columns or flag not in columns:
        return name not in columns
    looked = part["looked"][name]
    return all(bit == "1" for bit, at in zip(columns[flag], looked, strict=True) if at == "1")


def replay(trace: Trace, sources: list[Path]) -> list[str]:
    """The ports on which a netlist first differs where the bench looks; none where nowhere."""
    built = trace.folder / f"{sources[0].stem}.vvp"
    command = ["iverilog", "-g2012", "-o", built.name, "-s", "replay", "replay.v"]
    _run([*command, *map(str, sources)], trace.folder)
    words = _run(["vvp", "-n", built.name], trace.folder).split()
    built.unlink()
    if words == ["same", str(trace.rows)]:
        return []
    if words[:1] != ["differs"]:
        raise RuntimeError(f"{sources[0]}: vvp: {' '.join(words)}, expected {trace.rows} rows")
    seen, due = words[2:4]
    found, at = [], 0
    for name, width in trace.outputs.items():
        part = slice(at, at + width)
        if any(d != "z" and s != d for s, d in zip(seen[part], due[part], strict=True)):
            found.append(name)
        at += width
    return found


def _run(command: list[str], folder: Path) -> str:
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if result.returncode:
        raise RuntimeError(f"{' '.join(command)}: {result.stdout}{result.stderr}")
    return result.stdout

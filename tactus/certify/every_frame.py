"""The prover as one file, and what it proves the delivered hardware to compute."""

import ast
import json
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.scene import Scene
from tactus.verify import every_frame
from tactus.verify.every_frame.specify import description

NETWORK, REFUSED = "network.json", "refused.txt"
MAIN = "verdict"
_ROOM = "tactus.verify.every_frame."


def write_every_frame(scene: Scene, folder: Path) -> None:
    """Write ``every_frame`` below a folder; without a network, why it cannot be proved."""
    place = folder / "every_frame"
    place.mkdir()
    try:
        text = readable(description(scene))
    except InputError as reason:
        (place / REFUSED).write_text(f"{reason}\n", encoding="utf-8")
        return
    (place / NETWORK).write_text(text, encoding="utf-8")
    (place / "prover.py").write_text(one_file(), encoding="utf-8")


def readable(given: dict[str, Any]) -> str:
    """The network as JSON: a line for each table, and one with its number for each word."""
    numbered = [{"word": given["samples"] + n, **word} for n, word in enumerate(given["words"])]
    many = {
        "tables": (
            "{",
            [f"{json.dumps(k)}: {json.dumps(v)}" for k, v in given["tables"].items()],
            "}",
        ),
        "words": ("[", [json.dumps(word) for word in numbered], "]"),
    }
    entries = []
    for key, value in given.items():
        start, lines, end = many.get(key, ("", [], ""))
        rows = ",\n  ".join(lines)
        text = f"{start}\n  {rows}\n {end}" if lines else json.dumps(value)
        entries.append(f'"{key}": {text}')
    return "{\n " + ",\n ".join(entries) + "\n}\n"


def one_file() -> str:
    """The prover's modules in one, each behind those that it imports."""
    modules: dict[str, str] = {}
    imports: set[str] = set()
    _add(MAIN, modules, imports)
    # What the program is stands at its beginning.
    about, end, last = modules.pop(MAIN).partition('"""\n\n')
    return "\n\n".join([about + end + "\n".join(sorted(imports)), *modules.values(), last])


def _add(module: str, modules: dict[str, str], imports: set[str]) -> None:
    text = (Path(every_frame.__path__[0]) / f"{module}.py").read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in reversed(ast.parse(text).body):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(_ROOM):
            inner = str(node.module).removeprefix(_ROOM)
            if inner not in modules:
                _add(inner, modules, imports)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            imports.add(ast.unparse(node))
        else:
            continue
        del lines[node.lineno - 1 : node.end_lineno]
    modules[module] = "\n".join(lines).strip() + "\n"

"""``python -m tb.report.page.keys``: writes the keys of a scene for its page and for an editor."""

import sys
from pathlib import Path

from golden.cli import run, would
from golden.fingerprint import ROOT
from golden.scene.schema import EDITOR_SCHEMA, SCENE
from golden.schema import KeyTable, json_schema, key_rows
from tb.report.page.markers import put, write

COMMAND = "python -m tb.report.page.keys"
PAGE = ROOT / "docs" / "scenes.md"


def pages() -> dict[Path, str]:
    """The text of every file that this command writes."""
    text = PAGE.read_text(encoding="utf-8")
    for section, key in SCENE.keys.items():
        assert isinstance(key.kind, KeyTable), section
        text = put(PAGE, text, key_rows(key.kind), COMMAND, section)
    return {PAGE: text, EDITOR_SCHEMA: json_schema(SCENE, "A scene of tactus")}


def main() -> None:
    would("write the keys of a scene into its page, and the schema for editors")
    write(pages())


if __name__ == "__main__":
    sys.exit(run(main))

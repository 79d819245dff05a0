"""The JSON schema of a file: what an editor completes and checks it with while it is written."""

from __future__ import annotations

import json

from golden.schema.keys import Table

# The newest that editors of TOML are sure to know.
DRAFT = "http://json-schema.org/draft-07/schema#"


def json_schema(table: Table, title: str) -> str:
    """The text of the schema's file."""
    found = {"$schema": DRAFT, "title": title, **table.schema()}
    return json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

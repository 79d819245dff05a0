"""The JSON schema of a file, with which an editor completes and checks the file."""

import json

from tactus.core.schema.keys import KeyTable

# The newest draft that all editors of TOML support.
DRAFT = "http://json-schema.org/draft-07/schema#"


def json_schema(table: KeyTable, title: str) -> str:
    """The contents of the schema's file."""
    found = {"$schema": DRAFT, "title": title, **table.schema()}
    return json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

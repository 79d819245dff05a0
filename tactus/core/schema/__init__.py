"""Declares the TOML files that tactus reads, each of them once.

A file is a ``KeyTable`` of ``Key``, and a key has a ``Kind``, a default and a meaning. From this
declaration come the check of a file with its messages, the values of keys that are left out, the
JSON schema with which an editor completes and checks a file, and the tables of keys in the pages. A
rule that involves two keys, or another file, is beyond any kind; the code that reads the file
checks it.

No library does all of this. pydantic returns no values when one key is wrong, so faults between the
other keys could not be reported together with it. It reports a fault once for each kind that a key
may have, and it says neither what was expected of a missing key nor which name is the nearest. So
every message would have to be written here all the same. msgspec stops at the first fault.
"""

from tactus.core.schema.json_schema import json_schema
from tactus.core.schema.keys import REQUIRED, Key, KeyTable
from tactus.core.schema.kinds import (
    Alternatives,
    Anything,
    Each,
    Flag,
    Kind,
    List,
    Map,
    Number,
    Text,
    Whole,
    written,
)
from tactus.core.schema.page import key_rows
from tactus.core.schema.reading import (
    check_names,
    read_checked,
    read_toml,
    refuse_outside,
    values_of,
)
from tactus.core.schema.span import Span

__all__ = [
    "REQUIRED",
    "Alternatives",
    "Anything",
    "Each",
    "Flag",
    "Key",
    "KeyTable",
    "Kind",
    "List",
    "Map",
    "Number",
    "Span",
    "Text",
    "Whole",
    "check_names",
    "json_schema",
    "key_rows",
    "read_checked",
    "read_toml",
    "refuse_outside",
    "values_of",
    "written",
]

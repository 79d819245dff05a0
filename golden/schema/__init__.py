"""The TOML files that tactus reads, each declared once.

A file is a ``Table`` of ``Key``, and a key has a ``Kind``, a default and what it means. From that
one declaration come the check of a file with its messages, what stands in the place of keys that
are left out, the JSON schema with which an editor completes and checks a file, and the tables of
keys in the pages. What hangs on two keys together, or on another file, no kind can know: that is
checked by who reads the file.

No library does this. pydantic gives no values where one key is at fault, so faults between other
keys could not be told beside it; it tells a fault once for each kind that a key may have, and
neither what was expected of a missing key nor which name is nearest: every message would be made
here all the same. msgspec stops at the first fault.
"""

from golden.schema.json_schema import json_schema
from golden.schema.keys import REQUIRED, Key, Table
from golden.schema.kinds import (
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
)
from golden.schema.page import key_rows
from golden.schema.reading import check_names, read_checked, read_toml, refuse_outside, values_of
from golden.schema.span import Span

__all__ = [
    "REQUIRED",
    "Alternatives",
    "Anything",
    "Each",
    "Flag",
    "Key",
    "Kind",
    "List",
    "Map",
    "Number",
    "Span",
    "Table",
    "Text",
    "Whole",
    "check_names",
    "json_schema",
    "key_rows",
    "read_checked",
    "read_toml",
    "refuse_outside",
    "values_of",
]

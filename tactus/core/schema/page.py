"""Shows the keys of a table as rows of a page."""

from tactus.core.schema.keys import REQUIRED, Key, KeyTable


def key_rows(table: KeyTable) -> str:
    """A Markdown table with the key, type, default and meaning of each key."""
    lines = ["| key | type | default | meaning |", "|---|---|---|---|"]
    for name, key in table.keys.items():
        kind = key.kind.name.removeprefix("a ")
        span = f", {key.kind.within}" if key.kind.within else ""
        lines.append(f"| `{name}` | {kind}{span} | {_default(key)} | {key.meaning} |")
    return "\n".join(lines)


def _default(key: Key) -> str:
    if key.shown or key.default is REQUIRED:
        return key.shown
    if isinstance(key.default, bool):
        return str(key.default).lower()
    if isinstance(key.default, str) and key.default:
        return f"`{key.default}`"
    if key.kind.absent or key.default in ("", [], {}):
        return "none"
    return str(key.default)

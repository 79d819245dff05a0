"""``python -m tb.report.page.sign_off``: what is recorded of each block, into the documentation.

Rewrites what stands between the markers of each page in ``docs/blocks`` and the table of
``docs/verification.md``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from golden.cli import run, would
from golden.fingerprint import ROOT
from tb.common.collected import BENCHES
from tb.report.page.markers import put, write
from tb.sign_off.record import read_record, record_path

COMMAND = "make pages"
SECTION = "sign-off"
Record = dict[str, Any]


def recorded(kind: str, block: str) -> Record:
    """What was recorded; nothing where it was not tried."""
    return read_record(kind, block) if record_path(kind, block).exists() else {}


def mutation(record: Record) -> str:
    """How many mutants the bench finds."""
    text = (
        f"{record['killed']} of {record['mutants']} of `{record['entity']}` are found, "
        f"{record['same']} proved to be the same: **{percent(record)}**"
    )
    if not record["survivors"]:
        return text
    return "\n".join([f"{text}; left:", *(f"  - {_survivor(s)}" for s in record["survivors"])])


def percent(record: Record) -> str:
    """The score; 100 % only where nothing is left."""
    return "100 %" if record["score"] == 1 else f"{min(99.9, 100 * record['score']):.1f} %"


def _survivor(survivor: Record) -> str:
    explained = survivor["explained"] or "not explained"
    return f"`{survivor['where']}`: `{survivor['what']}`: {explained}"


def proof(record: Record) -> str:
    """What is proved, by which method, under which assumptions."""
    properties = record["properties"]
    copies = sum(one["refuted_by"] for one in properties)
    head = f"{len(properties)} properties, which {copies} broken copies refute:"
    return "\n".join([head, *(f"  - {_property(one)}" for one in properties)])


def _property(one: Record) -> str:
    method = f"{one['method']} over {_clocks(one['depth'])}" if one["depth"] else one["method"]
    facts = [
        f"`{one['entity']}`",
        method,
        *(f"assumes: {text.rstrip('.')}" for text in one["assumes"]),
    ]
    if one["free"]:
        facts.append(f"whatever {', '.join(f'`{name}`' for name in one['free'])} may be")
    return f"{one['sentence']} ({'; '.join(facts)})"


def coverage(record: Record) -> str:
    """What the bench met, and what nothing can reach."""
    borders = record["borders"]
    closed = {name: b["unreachable"] for name, b in borders.items() if "unreachable" in b}
    facts = [
        f"{len(borders) - len(closed)} borders on both sides",
        f"{sum(len(values) for values in record['ports'].values())} values of ports",
        f"{sum(state['values'] for state in record['states'].values())} states",
    ]
    closed |= record["unreachable"]
    text = f"the bench meets {', '.join(facts)}"
    if not closed:
        return text
    return "\n".join([f"{text}; nothing can meet:", *(f"  - {n}: {w}" for n, w in closed.items())])


def equivalence(record: Record) -> str:
    """How VHDL and Verilog were proved to be the same."""
    text = f"`{record['entity']}`: {record['method']}"
    if record["parts"]:
        text += f", given {len(record['parts'])} parts that are equal themselves"
    return f"{text}; broken copies that differ: {record['faults']}"


def netlist(record: Record) -> str:
    """Which netlists the bench ran on."""
    return "; ".join(
        f"{one['family']}: `{one['entity']}` of {one['scene']}, {one['compared']} values"
        + (f" of {one['frames']} frames" if one["frames"] else "")
        + _alone(one["tests"])
        for one in record["runs"]
    )


def _alone(pattern: str) -> str:
    """The tests that were played, unless all were: a regular expression names them one by one."""
    if pattern == "all":
        return ""
    return f" ({' and '.join(f'`{name}`' for name in pattern.strip('()').split('|'))} alone)"


def unknown(record: Record) -> str:
    """What was found with registers that hold nothing known."""
    text = (
        f"`{record['entity']}`: {record['compared']} values, {len(record['not reset'])} registers"
    )
    text += f" that no reset clears, {len(record['reset'])} that it does"
    text += _alone(record["tests"])
    clocks = record["proved over clocks"]
    return text + (f"; proved by induction over {_clocks(clocks)}" if clocks else "")


def _clocks(count: int) -> str:
    return f"{count} clock{'s' if count > 1 else ''}"


# By kind of record: what a datasheet calls it, the command, and what it says.
KINDS: dict[str, tuple[str, str, Callable[[Record], str]]] = {
    "mutation": ("Mutants", "make mutate BLOCK={}", mutation),
    "coverage": ("Coverage", "make coverage BLOCK={}", coverage),
    "equivalence": ("VHDL is Verilog", "make prove BLOCK={}", equivalence),
    "netlist": ("Netlist", "make sim BLOCK={} NETLIST=1", netlist),
    "unknown": ("Unknown registers", "make sim BLOCK={} NETLIST=unknown", unknown),
    "proof": ("Proved", "make prove BLOCK={}", proof),
}


def sheet(block: str) -> str:
    """The list of a datasheet."""
    lines = [
        f"- {title} (`{command.format(block)}`): {text(record)}"
        for kind, (title, command, text) in KINDS.items()
        if (record := recorded(kind, block))
    ]
    return "\n".join(lines) or "Nothing is recorded."


def overview() -> str:
    """A line a block."""
    lines = [
        "| block | mutants | detected | equivalent | score | properties | borders "
        "| VHDL equals Verilog by | netlists | registers without reset |",
        "|" + "---|" * 10,
    ]
    for block in sorted(BENCHES):
        mutants, proofs, met, equal, mapped, unreset = (
            recorded(kind, block)
            for kind in ("mutation", "proof", "coverage", "equivalence", "netlist", "unknown")
        )
        row = [
            f"[{block}](blocks/{block}.md#sign-off)",
            *(mutants.get(key, "") for key in ("mutants", "killed", "same")),
            percent(mutants) if mutants else "",
            len(proofs.get("properties", [])) or "",
            sum("unreachable" not in border for border in met.get("borders", {}).values()) or "",
            equal.get("method", "").partition(",")[0],
            ", ".join(sorted({one["family"] for one in mapped.get("runs", [])})),
            len(unreset["not reset"]) if unreset else "",
        ]
        lines.append(f"| {' | '.join(map(str, row))} |")
    return "\n".join(lines)


def pages() -> dict[Path, str]:
    """Every page that this command writes, as it must be."""
    docs = ROOT / "docs"
    found = {docs / "blocks" / f"{block}.md": sheet(block) for block in BENCHES}
    found[docs / "verification.md"] = overview()
    return {
        page: put(page, page.read_text(encoding="utf-8"), text, COMMAND, SECTION)
        for page, text in found.items()
    }


def main() -> None:
    would("write what is generated in the documentation")
    write(pages())


if __name__ == "__main__":
    sys.exit(run(main))

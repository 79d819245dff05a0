"""The records of all blocks, and those of one block for its page."""

import re
from collections.abc import Callable
from typing import Any

from tactus.report.measure.table import markdown
from tactus.verify.benches.collected import BENCHES
from tactus.verify.sign_off.mutate.score import COUNT
from tactus.verify.sign_off.record import recorded
from tactus.verify.sign_off.subject import recorded_cases

Record = dict[str, Any]


def mutation(record: Record) -> str:
    """A text on how many mutants the bench detects, and what is known about the others."""
    possible = record.get("population", record["mutants"])
    drawn = "" if possible == record["mutants"] else f", of {possible} possible ones,"
    facts = [
        f"{record['killed']} of {record['mutants']} mutants{drawn} are detected",
        f"{_are(record['same'])} proved equivalent",
    ]
    undetected = record["survivors"]
    explained = sum(bool(one["explained"]) for one in undetected)
    if explained:
        facts.append(f"{_are(explained)} undetected with a reason")
    if len(undetected) > explained:
        facts.append(f"{_are(len(undetected) - explained)} undetected without a reason")
    found = f"{', '.join(facts)}; score **{percent(record)}**"
    words = record.get("words")
    if words:
        found += (
            f"; of {words['mutants']} changed bits in the {words['words']} words of its memories "
            f"{_are(words['killed'])} detected"
        )
    return found


def percent(record: Record) -> str:
    """The score as text. It is 100 % only if no mutant is listed as undetected.

    If the mutants are a sample, the interval stands behind it in which the score of all possible
    mutants lies with a probability of 95 % (Clopper and Pearson).
    """
    score = "100 %" if record["score"] == 1 else f"{min(99.9, 100 * record['score']):.1f} %"
    if record["mutants"] < COUNT:
        return score
    detected = record["killed"]
    counted = record["mutants"] - record["same"] - record["explained"]
    # It is imported only here, because that takes half a second.
    from scipy.stats import binomtest

    interval = binomtest(detected, counted).proportion_ci(0.95, "exact")
    return f"{score} ({100 * interval.low:.1f} to {100 * interval.high:.0f} %)"


def undetected_mutants(record: Record) -> list[str]:
    """A row for each reason, with the mutants that it explains."""
    mutants: dict[str, list[str]] = {}
    for one in record.get("survivors", []):
        place = f"`{one['where']}`: `{one['what']}`"
        mutants.setdefault(one["explained"] or "not explained", []).append(place)
    rows = [[reason, "; ".join(found)] for reason, found in mutants.items()]
    return _table(
        "Undetected mutants, and the reason why each is accepted:", "reason | mutants", rows
    ) + undetected_bits(record)


def undetected_bits(record: Record) -> list[str]:
    """A row for each bit of a memory whose fault the bench does not detect in some words."""
    found: dict[tuple[str, str], list[str]] = {}
    for one in record.get("words", {}).get("survivors", []):
        memory, address, bit = re.split(r"\[|\] bit ", one)
        found.setdefault((memory, bit), []).append(address)
    return _table(
        "Bits of words whose faults the bench does not detect. The proof for every frame computes "
        "with each of them:",
        "memory | bit | addresses",
        [[f"`{memory}`", bit, ", ".join(at)] for (memory, bit), at in sorted(found.items())],
    )


def proof(record: Record) -> str:
    """A text on how many properties are proved."""
    properties = record["properties"]
    copies = sum(one["refuted_by"] for one in properties)
    return (
        f"{_count(len(properties), 'property', 'properties')} proved; "
        f"the proof fails for {_count(copies, 'broken copy', 'broken copies')}, as it must"
    )


def proved_properties(record: Record) -> list[str]:
    """A row for each property: by which method it is proved, and under which assumptions."""
    rows = [
        [
            one["sentence"],
            f"`{one['entity']}` of {one['case']}",
            f"{one['method']} over {_clocks(one['depth'])}" if one["depth"] else one["method"],
            "; ".join(text.rstrip(".") for text in one["assumes"]) or "none",
            ", ".join(f"`{name}`" for name in one["free"]) or "none",
        ]
        for one in record.get("properties", [])
    ]
    return _table(
        "Proved properties. A free signal may take any value in any clock:",
        "property | entity | method | assumptions | free signals",
        rows,
    )


def coverage(record: Record) -> str:
    """A text on the borders, states and values that the bench reached."""
    return (
        f"the bench meets {_count(record['borders'], 'border')} on both sides, "
        f"{_count(record['ports'], 'port value')} and {_count(record['states'], 'state')}"
    )


def unreachable(record: Record) -> list[str]:
    """A row for each border or value that no stimulus reaches."""
    return _table(
        "No stimulus can reach the following:",
        "border or value | reason",
        [[name, reason] for name, reason in record.get("unreachable", {}).items()],
    )


def equivalence(record: Record) -> str:
    """A text on how VHDL and Verilog were proved to compute the same."""
    facts = [f"proved by {record['method']}"]
    if record["parts"]:
        facts.append(f"{_count(len(record['parts']), 'part')} proved separately")
    return "; ".join(facts)


def netlist(record: Record) -> str:
    """A text on the netlists on which the bench ran."""
    runs = _count(len(record["runs"]), "run")
    return f"the bench passes on the mapped cells in {runs}, listed below"


def netlist_runs(record: Record) -> list[str]:
    """A row for each entity, with the families on whose cells the bench gave the same result."""
    families: dict[tuple[str, ...], list[str]] = {}
    for one in record.get("runs", []):
        frames = str(one["frames"] or "")
        key = (one["scene"], one["entity"], str(one["compared"]), frames, _tests(one["tests"]))
        families.setdefault(key, []).append(one["family"])
    rows = [
        [scene, f"`{entity}`", ", ".join(found), *rest]
        for (scene, entity, *rest), found in families.items()
    ]
    return _table(
        "Runs on netlists:",
        "scene | entity | families | values compared | frames | tests",
        rows,
    )


def _tests(pattern: str) -> str:
    """The names of the tests that were played, from the regular expression that chooses them."""
    if pattern == "all":
        return "all"
    return ", ".join(f"`{name}`" for name in pattern.strip("()").split("|"))


def unknown(record: Record) -> str:
    """A text on the run in which registers begin unknown."""
    facts = [
        f"{record['compared']} values compared",
        f"{_count(record['not reset'], 'register')} without reset, {record['reset']} with reset",
    ]
    if record["tests"] != "all":
        facts.append(f"tests {_tests(record['tests'])}")
    clocks = record["proved over clocks"]
    if clocks:
        facts.append(f"proved by induction over {_clocks(clocks)}")
    return "; ".join(facts)


def _clocks(count: int) -> str:
    return _count(count, "clock")


def _are(count: int) -> str:
    return f"{count} {'is' if count == 1 else 'are'}"


def _count(count: int, one: str, several: str = "") -> str:
    return f"{count} {one if count == 1 else several or one + 's'}"


def _table(title: str, heads: str, rows: list[list[str]]) -> list[str]:
    """The lines of a title and a table below it; none if the table has no rows."""
    if not rows:
        return []
    return ["", title, "", markdown(heads, rows)]


# By kind of record: what a datasheet calls it, the command, and what it says.
KINDS: dict[str, tuple[str, str, Callable[[Record], str]]] = {
    "mutation": ("mutation score", "make mutate BLOCK={}", mutation),
    "coverage": ("coverage", "make coverage BLOCK={}", coverage),
    "equivalence": ("VHDL equals Verilog", "make prove BLOCK={}", equivalence),
    "netlist": ("netlist simulation", "make sim BLOCK={} NETLIST=1", netlist),
    "unknown": ("unknown registers", "make sim BLOCK={} NETLIST=unknown", unknown),
    "proof": ("proved properties", "make prove BLOCK={}", proof),
}

# What does not fit into a cell of that table, in the order in which it follows.
DETAILS: dict[str, Callable[[Record], list[str]]] = {
    "mutation": undetected_mutants,
    "coverage": unreachable,
    "netlist": netlist_runs,
    "proof": proved_properties,
}


def sheet(block: str) -> str:
    """The tables of a datasheet."""
    # A record of netlists or proofs holds all cases.
    records = {
        kind: [found for name in recorded_cases(block) if (found := recorded(kind, name))]
        for kind in KINDS
    }
    rows = [
        [title, f"`{command.format(block)}`", _entity(record), text(record)]
        for kind, (title, command, text) in KINDS.items()
        for record in records[kind]
    ]
    if not rows:
        return "Nothing is recorded."
    table = markdown("check | command | entity | result", rows)
    lines = ["[Verification](../verification.md) explains these checks.", "", table]
    for kind, details in DETAILS.items():
        for record in records[kind]:
            lines += details(record)
    return "\n".join(lines)


def _entity(record: Record) -> str:
    """The entity that was checked. Runs on netlists and properties name their own entities."""
    if "entity" not in record:
        return "see below"
    scene = f" of {record['scene']}" if "scene" in record else ""
    return f"`{record['entity']}`{scene}"


def overview() -> str:
    """The table of verification.md, with a line for each block."""
    rows = []
    for block in sorted(BENCHES):
        mutants, proofs, met, equal, mapped, unreset = (
            recorded(kind, block)
            for kind in ("mutation", "proof", "coverage", "equivalence", "netlist", "unknown")
        )
        row: list[object] = [
            f"[{block}](blocks/{block}.md#sign-off)",
            *(mutants.get(key, "") for key in ("mutants", "killed", "same")),
            percent(mutants) if mutants else "",
            len(proofs.get("properties", [])) or "",
            met.get("borders") or "",
            equal.get("method", "").partition(",")[0],
            ", ".join(sorted({one["family"] for one in mapped.get("runs", [])})),
            unreset.get("not reset", ""),
        ]
        rows.append(row)
    return markdown(
        "block | mutants | detected | equivalent | score | properties | borders | "
        "VHDL equals Verilog by | netlists | registers without reset",
        rows,
    )

"""The records of all blocks, and those of one block for its page."""

from collections.abc import Callable
from typing import Any

from tactus.report.measure.table import markdown
from tactus.verify.benches.collected import BENCHES
from tactus.verify.sign_off.mutate.score import COUNT
from tactus.verify.sign_off.record import recorded, recorded_cases

Record = dict[str, Any]


def _said(facts: dict[str, Any]) -> str:
    """The facts that are not 0 or empty."""
    return "; ".join(f"{name}: {fact}" for name, fact in facts.items() if fact)


def mutation(record: Record) -> str:
    """How many mutants the bench detects, and what is known about the others."""
    possible = record.get("population", record["mutants"])
    drawn = f", drawn from {possible}" if possible != record["mutants"] else ""
    undetected = record["survivors"]
    explained = sum(bool(one["explained"]) for one in undetected)
    facts = {
        "mutants detected": f"{record['killed']} of {record['mutants']}{drawn}",
        "proved equivalent": record["same"],
        "undetected with a reason": explained,
        "undetected without a reason": len(undetected) - explained,
        "score": f"**{percent(record)}**",
    }
    return _said(facts)


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
    )


def proof(record: Record) -> str:
    """How many properties are proved."""
    properties = record["properties"]
    refuted = sum(one["refuted_by"] for one in properties)
    return _said({"proved": len(properties), "broken copies that the proof refutes": refuted})


def proved_properties(record: Record) -> list[str]:
    """A row for each property: by which method it is proved, and under which assumptions."""
    rows = [
        [
            one["sentence"],
            f"`{one['entity']}` of {one['case']}",
            f"{one['method']}, clocks: {one['depth']}" if one["depth"] else one["method"],
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
    """The borders, states and values that the bench reached."""
    names = {"borders, on both sides": "borders", "port values": "ports", "states": "states"}
    return "met: " + _said({name: record[key] for name, key in names.items()})


def unreachable(record: Record) -> list[str]:
    """A row for each border or value that no stimulus reaches."""
    return _table(
        "No stimulus can reach the following:",
        "border or value | reason",
        [[name, reason] for name, reason in record.get("unreachable", {}).items()],
    )


def equivalence(record: Record) -> str:
    """How VHDL and Verilog were proved to compute the same."""
    return _said({"proved by": record["method"], "parts proved separately": len(record["parts"])})


def netlist(record: Record) -> str:
    """On how many netlists the bench ran."""
    return _said({"runs that pass on the mapped cells, listed below": len(record["runs"])})


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
    """The run in which registers begin unknown."""
    facts = {
        "values compared": record["compared"],
        "registers without reset": record["not reset"],
        "with reset": record["reset"],
        "tests": record["tests"] != "all" and _tests(record["tests"]),
        "clocks of the proof by induction": record["proved over clocks"],
    }
    return _said(facts)


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

"""The records of all blocks, and those of one block for its page."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from golden.common.block import walk
from tactus.report.measure.table import markdown
from tactus.verify.benches.collected import BENCHES, CASES_OF, case_scene
from tactus.verify.sign_off.mutate.score import COUNT
from tactus.verify.sign_off.record import recorded, recorded_cases

Record = dict[str, Any]


def mutation(record: Record) -> str:
    """How many mutants the bench detects, and what is known about the others."""
    possible = record.get("population", record["mutants"])
    drawn = f", drawn from {possible}" if possible != record["mutants"] else ""
    undetected = record["survivors"]
    explained = sum(bool(one["explained"]) for one in undetected)
    return _said(
        {
            "mutants detected": f"{record['killed']} of {record['mutants']}{drawn}",
            "proved equivalent": record["same"],
            "undetected with a reason": explained,
            "undetected without a reason": len(undetected) - explained,
            "score": f"**{percent(record)}**",
        }
    )


def _said(facts: dict[str, Any]) -> str:
    """The facts that are not 0 or empty."""
    return "; ".join(f"{name}: {fact}" for name, fact in facts.items() if fact)


def _tests(pattern: str) -> str:
    """The names of the tests that were played, from the regular expression that chooses them."""
    if pattern == "all":
        return "all"
    return ", ".join(f"`{name}`" for name in pattern.strip("()").split("|"))


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


@cache
def coverage(block: str, case: str) -> Record:
    """The borders of a block in a case, all of which a bench that passes has met, and the rest."""
    with TemporaryDirectory() as folder:
        design = case_scene(case, Path(folder)).twin()
    twin = next(part for part in walk(design) if part.block == block)
    beyond = {border.name: border.unreachable for border in twin.borders if border.unreachable}
    return {
        "entity": twin.entity,
        "scene": case,
        "borders": len(twin.borders) - len(beyond),
        "unreachable": beyond | twin.unreachable,
    }


# By kind of record: what a datasheet calls it, the command, and what it says.
KINDS: dict[str, tuple[str, str, Callable[[Record], str]]] = {
    "mutation": ("mutation score", "make mutate BLOCK={}", mutation),
    "coverage": (
        "coverage",
        "make sim BLOCK={}",
        lambda record: f"borders met on both sides: {record['borders']}",
    ),
    "equivalence": (
        "VHDL equals Verilog",
        "make prove BLOCK={}",
        lambda record: _said(
            {"proved by": record["method"], "parts proved separately": len(record["parts"])}
        ),
    ),
    "netlist": (
        "netlist simulation",
        "make sim BLOCK={} NETLIST=1",
        lambda record: f"runs that pass on the mapped cells, listed below: {len(record['runs'])}",
    ),
    "unknown": (
        "unknown registers",
        "make sim BLOCK={} NETLIST=unknown",
        lambda record: _said(
            {
                "values compared": record["compared"],
                "registers without reset": record["not reset"],
                "with reset": record["reset"],
                "tests": record["tests"] != "all" and _tests(record["tests"]),
                "clocks of the proof by induction": record["proved over clocks"],
            }
        ),
    ),
    "proof": (
        "proved properties",
        "make prove BLOCK={}",
        lambda record: _said(
            {
                "proved": len(record["properties"]),
                "broken copies that the proof refutes": sum(
                    one["refuted_by"] for one in record["properties"]
                ),
            }
        ),
    ),
}


def _details(kind: str, record: Record) -> tuple[str, str, list[list[str]]]:
    """Title, headings and rows of what does not fit into a cell of the table of checks."""
    found: dict[tuple[str, ...], list[str]] = {}
    if kind == "mutation":
        for one in record["survivors"]:
            reason = (one["explained"] or "not explained",)
            found.setdefault(reason, []).append(f"`{one['where']}`: `{one['what']}`")
        return (
            "Undetected mutants, and the reason why each is accepted:",
            "reason | mutants",
            [[reason, "; ".join(mutants)] for (reason,), mutants in found.items()],
        )
    if kind == "coverage":
        return (
            "No stimulus can reach the following:",
            "border or value | reason",
            [[name, reason] for name, reason in record["unreachable"].items()],
        )
    if kind == "netlist":
        for one in record["runs"]:
            frames = str(one["frames"] or "")
            key = (one["scene"], one["entity"], str(one["compared"]), frames, _tests(one["tests"]))
            found.setdefault(key, []).append(one["family"])
        return (
            "Runs on netlists:",
            "scene | entity | families | values compared | frames | tests",
            [
                [scene, f"`{entity}`", ", ".join(families), *rest]
                for (scene, entity, *rest), families in found.items()
            ],
        )
    return (
        "Proved properties. A free signal may take any value in any clock:",
        "property | entity | method | assumptions | free signals",
        [
            [
                one["sentence"],
                f"`{one['entity']}` of {one['case']}",
                f"{one['method']}, clocks: {one['depth']}" if one["depth"] else one["method"],
                "; ".join(text.rstrip(".") for text in one["assumes"]) or "none",
                ", ".join(f"`{name}`" for name in one["free"]) or "none",
            ]
            for one in record["properties"]
        ],
    )


def sheet(block: str) -> str:
    # A record of netlists or proofs holds all cases.
    records = {
        kind: [found for name in recorded_cases(block) if (found := recorded(kind, name))]
        for kind in KINDS
    }
    records["coverage"] = [coverage(block, case) for case in recorded_cases(block).values()]
    rows = [
        [title, f"`{command.format(block)}`", _entity(record), text(record)]
        for kind, (title, command, text) in KINDS.items()
        for record in records[kind]
    ]
    if not rows:
        return "Nothing is recorded."
    table = markdown("check | command | entity | result", rows)
    lines = ["[Verification](../verification.md) explains these checks.", "", table]
    for kind in ("mutation", "coverage", "netlist", "proof"):
        for title, heads, details in (_details(kind, record) for record in records[kind]):
            lines += ["", title, "", markdown(heads, details)] if details else []
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
        mutants, proofs, equal, mapped, unreset = (
            recorded(kind, block)
            for kind in ("mutation", "proof", "equivalence", "netlist", "unknown")
        )
        row: list[object] = [
            f"[{block}](blocks/{block}.md#sign-off)",
            *(mutants.get(key, "") for key in ("mutants", "killed", "same")),
            percent(mutants) if mutants else "",
            len(proofs.get("properties", [])) or "",
            coverage(block, CASES_OF[block][0])["borders"] or "",
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

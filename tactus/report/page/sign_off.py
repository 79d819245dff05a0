"""The records of all blocks, and those of one block for its page."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from golden.common.block import walk
from tactus.core.templates import environment
from tactus.report.measure.table import markdown
from tactus.verify.benches.collected import BENCHES, CASES_OF, case_scene
from tactus.verify.sign_off.equal import METHOD
from tactus.verify.sign_off.mutate.score import COUNT
from tactus.verify.sign_off.record import recorded, recorded_cases, records

Record = dict[str, Any]


def percent(record: Record) -> str:
    """The score as text. It is 100 % only if each undetected mutant is explained or equivalent.

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


def sheet(block: str) -> str:
    """The sign-off of a block, as Markdown; see the template."""
    found = {
        kind: [one for name, one in records(kind).items() if name.partition(".")[0] == block]
        for kind in ("mutation", "equivalence", "netlist", "unknown", "proof")
    }
    met = [coverage(block, case) for case in recorded_cases(block).values()]
    found["coverage"] = [one for one in met if one["borders"] or one["unreachable"]]
    templates = environment("tactus.report.page")
    templates.filters["cell"] = lambda text: text.replace("|", r"\|")
    template = templates.get_template("sign_off.md.jinja")
    return template.render(found, block=block, method=METHOD, percent=percent).rstrip()


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
            METHOD.partition(",")[0] if equal else "",
            ", ".join(sorted({one["family"] for one in mapped.get("runs", [])})),
            unreset.get("not reset", ""),
        ]
        rows.append(row)
    return markdown(
        "block | mutants | detected | equivalent | score | properties | borders | "
        "VHDL equals Verilog by | netlists | registers without reset",
        rows,
    )

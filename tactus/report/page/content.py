"""The content of the report of a scene."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from golden.networks.network import Network
from tactus.core import store
from tactus.core.closure import code
from tactus.core.fingerprint import ROOT, fingerprint
from tactus.core.machine import versions
from tactus.core.templates import environment
from tactus.report.designs import designs, picture_of, refused_lines, sentence
from tactus.report.draw.outcome import (
    Plot,
    Predicted,
    along_plot,
    confusion,
    disturbance_plots,
    predicted_plots,
)
from tactus.report.draw.pictures import draw
from tactus.report.draw.svg import Picture
from tactus.report.measure.networks import FAMILY
from tactus.report.measure.outcome import (
    Outcome,
    accuracy,
    along,
    confidence,
    noise_and_drift,
    outcome,
    per_class,
    sensors,
    telling,
    worst_rows,
    wrong_rows,
)
from tactus.report.measure.table import SEED, Cell, Table
from tactus.report.page import summary
from tactus.report.page.summary import Costs, blocks, costs
from tactus.scene import Scene
from tactus.scene.building import compared
from tactus.sizing.model import CELLS
from tactus.verify.benches.results import left_texts, stored_results
from tactus.verify.benches.runner import scene_variable
from tactus.verify.benches.tools import SIMULATORS, version
from tactus.verify.prove import proof_line

# A function that is told the name of a part, the seconds that it took, and whether it was kept.
Progress = Callable[[str, float, bool], None]


def part_key(name: str, modules: Iterable[str], **parts: store.Part) -> store.Key:
    """The key of a part of a report, which is kept in the store.

    It holds the code that makes the part and all data that tactus ships. So nothing is measured
    again when only a page of the report changes.

    modules: The modules with the functions and classes that make it.
    parts: Everything else on which the part depends.
    """
    tools = [f"{n} {v}" for n, v in versions("myhdl", "numpy", "scipy", "python").items()]
    return store.key("report", name=name, code=code(modules), data=_data(), tools=tools, **parts)


@cache
def _data() -> str:
    """A digest of the data that tables read."""
    return fingerprint([ROOT / "scenes"])


def cached(asked: store.Key, tell: Progress, work: Callable[[], Any]) -> Any:
    """The result of ``work``, from the store if it is kept there."""
    name, started = asked.parts["name"], time.perf_counter()
    answer = store.read(asked)
    if answer is not None:
        tell(name, 0.0, True)
        return answer
    answer = store.write(asked, work())
    tell(name, time.perf_counter() - started, False)
    return answer


def packed(table: Table) -> dict[str, Any]:
    """A table as the store holds it: the arguments of ``Table``."""
    return {"name": table.name, **table.as_data()}


@dataclass(frozen=True)
class Section:
    """A part of the page.

    name: The name of the anchor.
    text, points: The paragraphs, and the list below them.
    tables: The tables that are shown in full.
    folded: The tables that are shown when the reader opens them, and in print.
    """

    name: str
    title: str
    text: Sequence[str] = ()
    points: Sequence[str] = ()
    pictures: Sequence[Picture] = ()
    tables: Sequence[Table] = ()
    folded: Sequence[Table] = ()


@dataclass(frozen=True)
class Page:
    """The whole report.

    built: The lines that say what was built.
    errors, costs: The tables of the first screen.
    made: The lines that say with which tools the report was made.
    """

    title: str
    built: Sequence[str]
    errors: Table
    costs: Table
    sections: Sequence[Section]
    made: Sequence[str] = ()

    def render(self) -> str:
        templates = environment("tactus.report.page", escapes=True)
        return templates.get_template("page.html.jinja").render(page=self)


def content(scene: Scene, tell: Progress) -> Page:
    """The report of a scene. ``tell`` is called for each part that is ready."""
    design = scene.twin()
    tools = [version(s) for s in SIMULATORS]
    files = [*scene.files, *(p for p in scene.provenance_paths if p.is_file())]

    def asked(name: str, *modules: str, **parts: store.Part) -> store.Key:
        return part_key(f"{name}-{scene.name}", modules, scene=files, simulators=tools, **parts)

    cost = costs(scene, design)
    found = outcome(scene)
    disturbed = Table(
        **cached(
            asked("disturbed", noise_and_drift.__module__, seed=SEED),
            tell,
            lambda: packed(noise_and_drift(scene, SEED)),
        )
    )
    places = along(found) if scene.group_by else None
    told = telling(scene)
    if scene.labels:
        errors = [confusion(scene, found.decisions)]
    else:
        errors = _drawn(predicted_plots(found))
    if places:
        errors += _drawn([along_plot(found, places)])
    sections = [
        _verified(scene),
        _errors(found, errors, places),
        Section(
            "sensors",
            "What the sensors do to it",
            pictures=_drawn(disturbance_plots(disturbed)),
            tables=[disturbed, sensors(found), *([told] if told else [])],
        ),
        Section(
            "left-out",
            "Left out",
            text=["What the project has and this scene does not need is not built:"],
            points=summary.left_out(scene, design),
        ),
        _pictures(scene, asked("pictures", draw.__module__), tell),
        _resources(scene, design, cost),
        _designs(
            scene,
            asked("designs", designs.__module__, picture_of.__module__, records=[CELLS]),
            tell,
        ),
    ]
    return Page(
        f"tactus: {scene.name}",
        summary.built(scene, design),
        summary.errors(found),
        summary.cost_table(scene, design, cost, compared=bool(scene.reference)),
        [section for section in sections if section is not None],
    )


def _errors(found: Outcome, pictures: list[Picture], places: Table | None) -> Section:
    tables = [worst_rows(found)]
    if found.scene.labels:
        wrong = wrong_rows(found)
        tables = [accuracy(found), per_class(found), *([wrong] if wrong.rows else [])]
    return Section(
        "outputs",
        "Decisions" if found.scene.labels else "Errors row by row",
        pictures=pictures,
        tables=[*tables, confidence(found)],
        folded=[places] if places else [],
    )


def _drawn(plots: Iterable[Plot | Predicted]) -> list[Picture]:
    return [Picture(plot.name, plot.title, plot.draw(), plot.sentence) for plot in plots]


def _pictures(scene: Scene, asked: store.Key, tell: Progress) -> Section:
    found = cached(asked, tell, lambda: draw(scene))
    skipped = "; ".join(f"{title}: {why}" for title, why in found["skipped"])
    return Section(
        "pictures",
        "Pictures",
        text=[f"Not drawn for this scene. {skipped}."] if skipped else [],
        pictures=[Picture(**part) for part in found["drawn"]],
    )


def _verified(scene: Scene) -> Section:
    """The section on what the benches compared, if they have run on the present files."""
    results, proof = stored_results(scene), proof_line(scene, ask=False)
    prove = f"make prove {scene_variable(scene)}"
    proved = (
        f"Verilog, {proof}; {prove} proves the VHDL too."
        if proof
        else f"The present export was not proved for every frame: {prove} does it."
    )
    if results is None:
        text = (
            "The benches have not run since something that they depend on changed: make demo "
            f"{scene_variable(scene)} runs them."
        )
        return Section("verified", "Verified", text=[proved, text])
    rows: list[list[Cell]] = [
        [block, *(number for s in SIMULATORS for number in cells[s])]
        for block, cells in results["blocks"].items()
    ]
    heading = ["block"]
    heading += [f"{s}, {what}" for s in SIMULATORS for what in ("entities", "values compared")]
    table = Table(
        "benches",
        heading,
        rows,
        "Each entity was simulated on the exported files themselves and compared with its twin, "
        "without any tolerance, in " + " and ".join(version(s) for s in SIMULATORS) + ".",
    )
    said = [
        proved,
        f"{results['benches']} benches, {results['failed']} failed, {results['compared']:,} values "
        "compared bit for bit.",
    ]
    said += left_texts(results)
    return Section("verified", "Verified", text=said, folded=[table])


def _designs(scene: Scene, asked: store.Key, tell: Progress) -> Section:
    """The section on what other designs of the same networks would cost."""

    def work() -> dict[str, Any]:
        rows, refused = compared(scene)
        return {
            "table": packed(designs(scene, rows, FAMILY)),
            "svg": picture_of(scene, rows, FAMILY),
            "sentence": sentence(scene, rows, FAMILY),
            "refused": refused_lines(refused),
        }

    found = cached(asked, tell, work)
    title = "Other designs: LUTs against clocks"
    return Section(
        "designs",
        "Other designs",
        text=[f"make designs {scene_variable(scene)} prints this table."],
        points=found["refused"],
        pictures=[Picture("designs", title, found["svg"], found["sentence"], wide=True)],
        tables=[Table(**found["table"])],
    )


def _resources(scene: Scene, design: Network, found: Costs | None) -> Section | None:
    if found is None:
        return None
    return Section(
        "resources",
        "Resources",
        text=[
            f"ECP5, placed and routed: LUTs {found.timing.luts:,}, flip-flops "
            f"{found.timing.flip_flops:,}, multipliers {found.timing.multipliers}, block RAMs "
            f"{found.timing.block_rams}; {found.timing.clock_mhz} MHz. Slowest path: "
            f"{found.timing.slowest}."
        ],
        folded=[blocks(scene, design, found)],
    )

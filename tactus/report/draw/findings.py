"""Makes plots of error against cost from tables, and the sentences from their figures."""

from collections.abc import Callable, Mapping

from tactus.report.draw.looks import activation_look, network_look
from tactus.report.draw.plots import Plot
from tactus.report.measure.table import Cell, Table

Row = dict[str, Cell]


def rows_of(table: Table, **where: Cell) -> list[Row]:
    """The rows that have the values of ``where``, as mappings. ``_`` stands for a blank."""
    wanted = {key.replace("_", " "): value for key, value in where.items()}
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    unknown = wanted.keys() - set(table.columns)
    found = [row for row in rows if all(row[key] == value for key, value in wanted.items())]
    if unknown or not found:
        raise ValueError(f"table {table.name}: no row with {wanted}, columns {table.columns}")
    return found


def number(row: Row, column: str) -> float:
    """A cell that must hold a number."""
    value = row[column]
    if not isinstance(value, int | float):
        raise ValueError(f"column {column}: got {value!r}, expected a number")
    return float(value)


def groups(
    rows: list[Row], label: Callable[[Row], str], x: str, y: str
) -> dict[str, list[tuple[float, float]]]:
    """The points (x, y) by label. Rows without x or y are left out."""
    found: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        if row[x] is not None and row[y] is not None:
            found.setdefault(label(row), []).append((number(row, x), number(row, y)))
    return found


def cheapest(points: Mapping[str, list[tuple[float, float]]], error: float) -> tuple[str, float]:
    """The group that reaches an error at the least cost, and this cost."""
    costs = {
        label: min((x for x, y in group if y <= error), default=float("inf"))
        for label, group in points.items()
    }
    best = min(costs, key=lambda label: costs[label])
    if costs[best] == float("inf"):
        raise ValueError(f"no group reaches an error of {error:g}")
    return best, costs[best]


def activation_plots(table: Table) -> list[Plot]:
    """The mean and the largest error of every activation against clocks and against cells."""
    # The table also has schemes with the options of the thesis. The plot has each scheme once.
    rows = [
        row
        for row in rows_of(table)
        if row["latency clocks"] is not None and "," not in str(row["scheme"])
    ]
    return [
        plot
        for x, across in (("latency clocks", "latency, clocks"), ("LUT", "Virtex-II LUTs"))
        for y, up in (
            ("mean %", "mean error %"),
            ("largest units", "largest error, $2^{-13}$"),
        )
        if (plot := _activation_plot(rows, x, across, y, up, table.name))
    ]


def _activation_plot(
    rows: list[Row], x: str, across: str, y: str, up: str, table: str
) -> Plot | None:
    points = groups(rows, lambda row: f"{row['scheme']}, {row['arithmetic']}", x, y)
    if not points:
        return None
    best = min(points, key=lambda label: points[label][0][1])
    least = min(points, key=lambda label: points[label][0][0])
    (cost, error), (least_cost, least_error) = points[best][0], points[least][0]
    return Plot(
        f"activations_{y.split()[0]}_{x.split()[0].lower()}",
        f"Activations: {up.split(',')[0]} against {across}",
        across,
        up,
        points,
        f"{best} is the most accurate, {error:.3g} at {cost:g} {across.split()[-1]}; {least} takes "
        f"the least, {least_cost:g}, and has {least_error:.3g}.",
        [table],
        joined=False,
        looks={
            label: activation_look(*(text.strip() for text in label.rsplit(",", 1)))
            for label in points
        },
    )


def iterations_plot(tables: Mapping[str, Table], printed: float | None) -> Plot:
    """The error of the Pade regression against its iterations, for each rho."""
    rows = rows_of(tables["iterations"], arithmetic="thesis")
    points = groups(rows, lambda row: f"rho {row['rho']:g}", "iterations", "mean %")
    best = {label: min(y for _, y in group) for label, group in points.items()}
    rho = min(best, key=lambda label: best[label])
    count = min(x for x, y in points[rho] if y <= 1.05 * best[rho])
    worst = max(best, key=lambda label: best[label])
    return Plot(
        "iterations",
        "Pade: iterations of the regression",
        "iterations",
        "mean error %",
        points,
        f"{rho} comes to {best[rho]:.3g} % within {count:g} iterations, and more do not help; "
        f"{worst} never gets below {best[worst]:.3g} %.",
        ["iterations"],
        levels={} if printed is None else {f"thesis {printed:g}": printed},
    )


def network_plots(table: Table) -> list[Plot]:
    """The worst output of every network on Appendix 2, against clocks and against cells."""
    rows = rows_of(table, data="appendix2")
    plots = []
    for x, across in (("clocks a frame", "clocks a frame"), ("LUT", "Virtex-II LUTs")):
        for y, up in (("largest %", "largest mean error %"), ("mean %", "mean error %")):
            known = [row for row in rows if row[x] is not None]
            points = groups(known, _form, x, y)
            if not points:
                continue
            most = max(number(row, "outputs") for row in known)
            whole = [row for row in known if row["outputs"] == most]
            best = min(whole, key=lambda row: number(row, y))
            least = min(whole, key=lambda row: number(row, x))
            plots.append(
                Plot(
                    f"networks_{y.split()[0]}_{x.split()[0].lower()}",
                    f"Networks: {up.removesuffix(' %')} against {across}",
                    across,
                    up,
                    points,
                    f"Worst output of each. Of the networks with {most:g} outputs "
                    f"{best['scene']} has the least error, {number(best, y):.2g} % at "
                    f"{number(best, x):,.0f}; {least['scene']} costs the least, "
                    f"{number(least, x):,.0f}, and has {number(least, y):.2g} %.",
                    [table.name],
                    joined=False,
                    looks={label: network_look(*label.split(", ")) for label in points},
                )
            )
    return plots


def _form(row: Row) -> str:
    activation = str(row["activation"]).split(" ")[0]
    return f"{row['design']}, {row['arrangement']}, {activation}, {row['precision']}"


def training_plots(tables: Mapping[str, Table]) -> list[Plot]:
    """The validation error against processor time, for the optimisers and the two cascades."""
    rows = rows_of(tables["training"])
    single = [row for row in rows if row["output"] == "all"]
    cascades = [row for row in rows if row["output"] != "all"]
    curves = groups(
        single, lambda row: f"{row['method']}, start {row['restart']}", "CPU s", "validation %"
    )
    ends = {
        method: min(number(row, "validation %") for row in single if row["method"] == method)
        for method in dict.fromkeys(str(row["method"]) for row in single)
    }
    first, second = sorted(ends, key=lambda method: ends[method])
    starts = groups(cascades, lambda row: str(row["method"]), "CPU s", "validation %")
    best = {
        method: sum(
            min(
                number(row, "validation %")
                for row in cascades
                if (row["method"], row["output"]) == (method, output)
            )
            for output in dict.fromkeys(row["output"] for row in cascades)
        )
        for method in starts
    }
    better = min(best, key=lambda method: best[method])
    sums = ", ".join(f"{method} {value:.2f} %" for method, value in best.items())
    return [
        Plot(
            "training_optimisers",
            "Training: optimisers from the same starts",
            "processor time s",
            "validation error %, rms",
            curves,
            f"{first} comes to {ends[first]:.2f} %, {second} to {ends[second]:.2f} %.",
            ["training"],
        ),
        Plot(
            "training_cascades",
            "Training: cascade A and cascade B",
            "processor time of a start s",
            "validation error %, rms",
            starts,
            f"Best starts, summed over the outputs: {sums}; {better} is the better here.",
            ["training"],
            joined=False,
        ),
    ]


def robustness_plot(table: Table) -> Plot:
    """How much a smaller error with noise costs in error as recorded."""
    rows = rows_of(table)
    points = groups(rows, lambda row: str(row["output"]), "as recorded %", "2 mV %")
    noises = [f"{number(row, 'trained for mV'):g}" for row in rows if row["output"] == "load"]
    (low, high), (much_low, much_high) = points["load"][0], points["load"][-1]
    return Plot(
        "robustness",
        "What it costs to be trained for noise",
        "mean error as recorded %",
        "mean error with noise of 2 mV %",
        points,
        f"Points are networks trained for {', '.join(noises)} mV, along the lines. Trained for "
        f"none the load errs by {low:.2g} % as recorded and {high:.2g} % with noise, trained for "
        f"{noises[-1]} mV by {much_low:.2g} % and {much_high:.2g} %.",
        ["robustness"],
    )


def digits_plot(table: Table) -> Plot:
    """What fewer digits cost in error and save in LUTs, in the designs in which they save any."""
    rows, at = rows_of(table), list(table.columns)
    outputs = at[at.index("digits") + 1 : at.index("deviation")]
    points: dict[str, list[tuple[float, float]]] = {}
    counts: set[int] = set()
    for name in (name for name in at if name.endswith(" LUT")):
        found = [row for row in rows if row[name] is not None]
        # Other words in a memory or a multiplexer alone change the LUTs by a hundredth.
        if number(found[-1], name) < 0.99 * number(found[0], name):
            counts |= {int(number(row, "digits")) for row in found}
            points[name.removesuffix(" LUT")] = [
                (number(row, name), sum(number(row, output) for output in outputs) / len(outputs))
                for row in found
            ]
    shrinks = [
        f"{group[0][0]:,.0f} LUTs of {name} become {group[-1][0]:,.0f}"
        for name, group in points.items()
    ]
    return Plot(
        "digits",
        "Weights of fewer signed digits",
        "Virtex-II LUTs",
        "held-out error, part of that before",
        points,
        f"Points are {', '.join(map(str, sorted(counts, reverse=True)))} digits, along the lines; "
        "the error is the mean of the outputs on rows that were held out. "
        f"{', and '.join(shrinks)}.",
        ["digits"],
        linear="xy",
    )


def search_plot(table: Table) -> Plot:
    """How many bits of adders more runs of the search for shared sums save, against their time."""
    points: dict[str, list[tuple[float, float]]] = {}
    most: list[str] = []
    for scene, matrix in dict.fromkeys((row[0], row[1]) for row in table.rows):
        found = rows_of(table, scene=scene, matrix=matrix)
        usual = number(found[0], "bits of adders")
        name = f"{scene}, {matrix}"
        points[name] = [
            (number(row, "CPU s"), 100 * (1 - number(row, "bits of adders") / usual))
            for row in found
        ]
        most.append(f"{points[name][-1][1]:.1f} % in {points[name][-1][0]:.0f} s of {name}")
    runs = [f"{number(row, 'runs'):g}" for row in found[1:]]
    return Plot(
        "search_runs",
        "What more runs of the search for shared sums save",
        "processor time s",
        "bits of adders saved %",
        points,
        f"Points are the usual runs, and then {', '.join(runs)} of them, along the lines. At the "
        f"end they save {', and '.join(most)}.",
        ["search_runs"],
        linear="y",
    )


def swing_plots(tables: Mapping[str, Table]) -> list[Plot]:
    """The integrators of the swing: plain, strongly damped, and started just short of upright."""
    table = tables["swing"]
    plots = []
    for case, name, aim in (
        ("plain", "swing_plain", 1e-6),
        ("strongly damped", "swing_stiff", 1e-6),
        ("179.9 degrees", "swing_upright", 1e-3),
    ):
        rows = rows_of(table, case=case)
        points = groups(rows, lambda row: str(row["method"]), "ms", "error rad")
        best, ms = cheapest(points, aim)
        refused = sum(row["ms"] is None for row in rows)
        left = f"; {refused} runs needed more evaluations than allowed" if refused else ""
        plots.append(
            Plot(
                name,
                f"Swing, {case}: integrators",
                "run time ms",
                "largest error rad",
                points,
                f"{best} is the quickest with an error of {aim:g} rad or less: {ms:.3g} ms{left}.",
                ["swing"],
            )
        )
    return plots


def damping_plot(tables: Mapping[str, Table]) -> Plot:
    """From what damping on an implicit method pays."""
    rows = rows_of(tables["swing_damping"])
    ratio = "rate / natural frequency"
    points = groups(rows, lambda row: str(row["method"]), ratio, "evaluations")
    light, strong = points
    work = {label: dict(group) for label, group in points.items()}
    errors = [number(row, "error rad") for row in rows if row["error rad"] is not None]
    turns = [x for x in work[strong] if work[strong][x] < work[light].get(x, float("inf"))]
    return Plot(
        "swing_damping",
        "Swing: work against damping",
        ratio,
        "evaluations",
        points,
        f"{strong} needs fewer evaluations than {light} at damping ratios of "
        f"{', '.join(f'{x:g}' for x in sorted(turns))}; no error is above {max(errors):.1e} rad.",
        ["swing_damping"],
    )


def bound_plots(tables: Mapping[str, Table]) -> list[Plot]:
    """The bound and the error of the scene for load, position and width along the beam."""
    table = tables["bound_along"]
    *_, bound, reached, any_load, _ = table.columns
    scene = reached.removesuffix(" %")
    plots = []
    for output in dict.fromkeys(str(row["output"]) for row in rows_of(table)):
        rows = rows_of(table, output=output)
        within = [row for row in rows if row["in the readings"] == "yes"]
        if not within:
            continue
        without = [row for row in rows if row["in the readings"] == "no"]
        points = {"bound": _along(within, bound)}
        points |= {scene: _along(within, reached)}
        if without:
            points = {
                **points,
                f"{scene}, not in the readings": _along(without, reached),
                "best guess there": _along(without, any_load),
            }
            of = sum(number(row, "placements") for row in rows)
            says = (
                f"At {sum(number(row, 'placements') for row in without):g} of {of:g} placements no "
                f"reading holds the {output}: no sensor lies under the load. There {scene} is off "
                f"by {_mean(without, reached):.2g} %, where the best estimator for any load can "
                f"only guess, {_mean(without, any_load):.2g} %: it has learnt which loads exist, "
                f"and a load that is not one of them gets a {output} that means nothing."
            )
        else:
            ratio = _mean(within, reached) / _mean(within, bound)
            says = (
                f"{scene} is off by {_mean(within, reached):.2g} %, {ratio:.1f} times what the "
                f"sensors allow, {_mean(within, bound):.2g} %."
            )
        plots.append(
            Plot(
                f"bound_{output}",
                f"What can be known: {output} along the beam, noise of 2 mV",
                "position from the tip, mm",
                "mean error %",
                points,
                says,
                [table.name, "bounds"],
                joined=False,
                linear="x",
            )
        )
    return plots


def recalibration_plot(table: Table) -> Plot:
    """The error that is left of a drift, against the number of known placements."""
    before, drifted, *rows = rows_of(table)
    points = groups(
        rows,
        lambda row: f"{row['chosen']}, noise {number(row, 'noise mV'):g} mV",
        "placements",
        "mean %",
    )
    least = {
        label: next((x for x, y in group if y <= 2 * number(before, "mean %")), None)
        for label, group in points.items()
    }
    told = "; ".join(f"{label}: {count:g}" for label, count in least.items() if count is not None)
    return Plot(
        "recalibration",
        "Recalibration: error left against known placements",
        "known placements",
        "mean error of the outputs %",
        points,
        f"Twice the error of sensors that have not drifted is reached with so many placements: "
        f"{told}.",
        [table.name],
        levels={
            "drifted": number(drifted, "mean %"),
            "not drifted": number(before, "mean %"),
        },
    )


def _along(rows: list[Row], error: str) -> list[tuple[float, float]]:
    return groups(rows, lambda _: error, "position mm", error)[error]


def _mean(rows: list[Row], error: str) -> float:
    """The mean over the placements."""
    counts = [number(row, "placements") for row in rows]
    errors = [number(row, error) for row in rows]
    return sum(c * e for c, e in zip(counts, errors, strict=True)) / sum(counts)


def plate_plot(tables: Mapping[str, Table]) -> Plot:
    """The error of the plate's deflection by series and by grid, against work."""
    rows = rows_of(tables["plate"])
    points = groups(rows, lambda row: f"{row['method']}, {row['point']}", "terms, nodes", "error")
    series = rows_of(tables["plate"], method="series")
    least = {
        str(row["point"]): number(row, "terms, nodes")
        for row in reversed(series)
        if number(row, "error") <= 1e-6
    }
    text = " and ".join(f"{count:g} terms {place}" for place, count in least.items())
    return Plot(
        "plate",
        "Plate: deflection by series and by grid",
        "terms of the series, nodes of the grid",
        "error, part of the limit",
        points,
        f"An error of 1e-6 takes {text}; no grid measured reaches it.",
        ["plate"],
    )


def series_plot(tables: Mapping[str, Table]) -> Plot:
    """The error of equation 3.17 against its terms."""
    points = groups(
        rows_of(tables["series"]), lambda row: f"conditions {row['case']}", "terms", "error / d"
    )
    ends = [max(group) for group in points.values()]
    worst = max(y for _, y in ends)
    return Plot(
        "series",
        "Load profile: terms of equation 3.17",
        "terms",
        "largest error away from jumps, part of the load",
        points,
        f"The error falls with the number of terms, not faster: {ends[0][0]:g} terms leave "
        f"{worst:.2g}, where equation 3.18 takes one power.",
        ["series"],
    )


def simulators_plot(table: Table) -> Plot:
    """Error against run time of every simulator on the same frames."""
    rows = [{**row, "us": 1e6 / number(row, "frames a second")} for row in rows_of(table)]
    error = "mean error %, worst output"
    points = groups(rows, lambda row: str(row["simulator"]), "us", error)
    bit_true = {number(row, error) for row in rows if not str(row["simulator"]).startswith("float")}
    exact = len(bit_true) == 1
    slowest = max(rows, key=lambda row: number(row, "us"))
    quickest = min(rows, key=lambda row: number(row, "us"))
    ratio = number(slowest, "us") / number(quickest, "us")
    return Plot(
        "simulators",
        "Simulators: error against run time of a frame",
        "run time of a frame, microseconds",
        error,
        points,
        (
            "All bit-true simulators have the same error"
            if exact
            else "The bit-true simulators differ"
        )
        + f"; {quickest['simulator']} is {ratio:,.0f} times as fast as {slowest['simulator']}.",
        [table.name],
        joined=False,
        linear="y",
    )

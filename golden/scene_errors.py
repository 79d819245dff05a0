"""Errors of a scene's networks on its recorded vectors."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.disturbance import Disturbance
from golden.metrics import OutputError, summarise
from golden.network_files.network_file import read_provenance
from golden.precision import SIGNAL
from golden.real import Real
from golden.scene import Scene
from golden.scene.scale import readings
from golden.training.split import split_of, split_story

HELD_OUT = "bit-true, held out"

# What is said where nobody can tell which rows a network has not seen.
UNKNOWN = "unknown: not trained here"

# What provenance says that tells nothing of the split: there was no other.
UNTOLD = {"split": "random", "split_by": "", "block_rows": 0, "window": ""}

# At 50,000 frames the mean error moves by one per cent from one seed to another.
FRAMES = 50_000
SEED = 1

# Errors are given with this noise too, as a part of what the last code stands for: 2 mV of a volt.
NOISE = 0.002


def told(scene: Scene) -> list[dict[str, Any]] | None:
    """The provenance of each network of the scene.

    None where a network came from elsewhere, or was trained on other data or with another split.

    Raises
    ------
    InputError
        See ``read_provenance``.
    """
    expected = {"window": ""} | split_story(scene)
    stories = []
    for member, network in zip(scene.members, scene.networks(), strict=True):
        read = read_provenance(member.weights_path)
        if read is None:
            return None
        story = UNTOLD | read
        shape = ":".join(str(n) for n in network.shape)
        story.setdefault("rows", expected["rows"])
        if any(story.get(key) != value for key, value in (expected | {"network": shape}).items()):
            return None
        stories.append(story)
    return stories


def held_out_rows(scene: Scene) -> NDArray[np.int64] | None:
    """Rows that neither trained nor chose any network of the scene.

    None where that is unknown, see ``told``, and where a network was trained on, on all rows.
    """
    stories = told(scene)
    if stories is None or any(story.get("refit") for story in stories):
        return None
    return split_of(scene).test


def held_out_means(scene: Scene) -> list[float] | None:
    """Mean error of each output, in percent, on rows that the networks have not seen.

    Of networks that were trained on, on all rows, it is what their provenance tells: the error of
    what was trained on without these rows. None where it is unknown, see ``told``.
    """
    found = scene_errors(scene).get(HELD_OUT)
    if found is not None:
        return [error.mean for error in found]
    stories = told(scene)
    if stories is None:
        return None
    means: dict[str, float] = {}
    for story in stories:
        means |= story.get("test_mean_percent", {})
    return [means[name] for name in scene.outputs] if means.keys() >= set(scene.outputs) else None


def held_out_text(scene: Scene) -> str:
    """Which rows are held out, in words."""
    means = held_out_means(scene)
    if means is None:
        return UNKNOWN
    settings = scene.training
    columns = " and ".join(settings.split_by)
    how = {
        "random": "drawn at random",
        "blocks": f"in stretches of about {settings.block_rows} rows"
        + (f" with the same {columns}" if columns else ""),
        "groups": f"all that have the same {columns} together",
    }[settings.split]
    rows = held_out_rows(scene)
    if rows is not None:
        return f"{len(rows)} that neither trained nor chose the network, {how}"
    shown = ", ".join(f"{name} {m:.2f}" for name, m in zip(scene.outputs, means, strict=True))
    return (
        "none any more, the networks were trained on with all; before, the mean on "
        f"{len(split_of(scene).test)} that they had not seen, {how}, was {shown}"
    )


def scene_errors(scene: Scene) -> dict[str, list[OutputError]]:
    """Errors on the recorded vectors: in real arithmetic, bit-true, and bit-true on rows that
    neither trained nor chose the network, where these are known."""
    vectors = scene.vectors()
    real = scene.process_real(vectors.inputs)
    bit_true = SIGNAL.to_real(scene.twin().core.process(vectors.codes))
    everything = np.arange(len(vectors.codes))
    kinds = [("float", real, everything), ("bit-true", bit_true, everything)]
    held_out = held_out_rows(scene)
    if held_out is not None:
        kinds.append((HELD_OUT, bit_true, held_out))
    return {
        name: summarise(vectors.percent_errors(results)[rows], vectors.groups[rows])
        for name, results, rows in kinds
    }


def unit_errors(scene: Scene) -> dict[str, OutputError]:
    """Bit-true errors on the recorded vectors in the units of the outputs that have a scale or a
    unit, by output."""
    vectors = scene.vectors()
    results = scene.outputs_in_units(scene.twin().core.process(vectors.codes))
    found = summarise(np.abs(results - scene.in_units(vectors.targets)), vectors.groups)
    named = scene.scale.keys() | scene.units.keys()
    return {name: error for name, error in zip(scene.outputs, found, strict=True) if name in named}


def full_scale_of(scene: Scene) -> float:
    """What the last code adds to a reading, in its unit: of several sensors the median, in two
    digits; 1 where they have no ``data.scale``."""
    return float(f"{np.median([scale.factor for scale in scene.scales(scene.sensors)]):.1e}")


def noises_of(scene: Scene) -> list[float]:
    """The noises that a scene's errors are given with, in the unit of the readings: the one that
    the scene states, if it does, and ``NOISE``."""
    usual = float(f"{NOISE * full_scale_of(scene):.6g}")
    return sorted({scene.training.disturbance.noise or usual, usual})


def disturbed_errors(scene: Scene, disturbance: Disturbance, seed: int = SEED) -> list[float]:
    """Bit-true mean error of each output, in percent, on disturbed readings of all rows."""
    errors = disturbed_rows(scene, disturbance, seed).mean(axis=0)
    return [float(error) for error in errors]


def disturbed_rows(scene: Scene, disturbance: Disturbance, seed: int = SEED) -> Real:
    """Bit-true errors in percent, shape (rows, outputs): of each row the mean of its draws.

    All rows are disturbed so many times that they are ``FRAMES`` or more. Each row is a recording
    of its own, with a drift of its own for each sensor: the mean is that of whole recordings, and
    comes out stable with far fewer of them.
    """
    vectors = scene.vectors()
    draws = 1 if disturbance.none else -(-FRAMES // len(vectors.inputs))
    # Noise and drift are what happens to readings, in their unit, before they are codes.
    many = np.tile(readings(vectors.inputs, scene.scales(scene.inputs)), (draws, 1))
    own = [tap.sensor for tap in scene.window.taps]
    sensors = np.add.outer(len(scene.sensors) * np.arange(len(many)), own).ravel()
    given = disturbance.of(many.reshape(1, -1), np.random.default_rng(seed), sensors)
    codes = scene.codes_of(given.reshape(many.shape))
    results = SIGNAL.to_real(scene.twin().core.process(codes)).reshape(
        draws, *vectors.targets.shape
    )
    rows: Real = vectors.percent_errors(results).mean(axis=0)
    return rows

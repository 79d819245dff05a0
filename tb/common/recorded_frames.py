"""The inputs that a block gets while the recorded frames of its scene run through the design."""

from collections.abc import Callable
from functools import partial
from typing import Any
from unittest.mock import patch

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.common.block import Block, around, walk
from golden.input_error import InputError
from golden.instruments.readout import Readout
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.visualisation.load_profile import LoadProfile
from tb.common.bench import Bench, test_named
from tb.common.stream import check_stream, ports_of

# At most so many inputs, evenly spaced. A quarter of an hour of frames would take hours.
MOST_SEEN = 4000
MOST_FRAMES = 20_000


def recorded_frames(bench: Bench, most: int = MOST_FRAMES) -> Codes:
    """The recorded frames that yield outputs, at most so many, and the past of the first."""
    given, past = bench.given, bench.given.design.past
    frames = np.concatenate(given.recordings) if past else given.codes
    return frames[: past + most]


def recorded_inputs(
    bench: Bench, part: Block | None = None, most: int = MOST_SEEN
) -> tuple[Codes, ...]:
    """The inputs of the block under test, or of ``part``, as the twin takes them."""
    found = seen(bench.given.design, part or bench.twin, recorded_frames(bench))
    count = len(found[0])
    kept = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))
    return tuple(column[kept] for column in found)


async def check_recorded(
    bench: Bench, twin: Callable[..., Any] | None = None, items: dict[str, Codes] | None = None
) -> None:
    """Play the recorded inputs as close as the twin takes them; compare each result and its clock.

    twin: See ``check_stream``.
    items: The values of the input ports, if they are not those that ``process`` takes.
    """
    if items is None:
        items = dict(zip(ports_of(bench.twin, "in"), recorded_inputs(bench), strict=True))
    await check_stream(bench, items, twin)
    count = len(next(iter(items.values())))
    bench.facts["recorded"] = count
    bench.finish(at_least=(1 + len(ports_of(bench.twin, "out"))) * count)


def recorded_test(module: str, of: Callable[..., Any] = lambda twin: twin.process) -> Any:
    """The test ``what_recorded_frames_bring`` of a bench, which does this; see ``suite``."""

    @test_named(module, "what_recorded_frames_bring")
    async def what_recorded_frames_bring(dut: Any) -> None:
        bench = Bench(dut)
        await check_recorded(bench, of(bench.twin))

    return what_recorded_frames_bring


def seen(design: Network, part: Block, frames: Codes) -> tuple[Codes, ...]:
    """The inputs of a block's ``process``, in the order in which the twins compute it.

    part: A block to which ``compute`` of the design, or of an activation in it, passes its inputs;
        or a part of the profile that the design draws of its outputs.
    frames, shape (frames, inputs): Sample codes, as ``design.process`` takes them.

    Returns: One for each input, all of equal length. If several networks or neurons have the same
        block, their inputs follow each other. A part of a profile has inputs for each point of each
        frame; ``ramp``, which has none, gives an empty tuple.
    """
    # An activation looks its results up in a table, so only its parts get single codes.
    owners = list(around(design, part))
    activations = [block for block in owners if isinstance(block, ActivationBlock)]
    calls: list[tuple[Codes, ...]] = []
    for activation in activations:
        (codes,) = seen(design, activation, frames)
        calls += _calls(part, partial(activation.compute, codes))
    if any(isinstance(block, LoadProfile) for block in owners):
        points = _calls(part, partial(_draw, design, frames))
        calls += [tuple(np.ravel(column) for column in call) for call in points]
    elif not activations:
        calls += _calls(part, partial(design.process, frames))
    if not calls:
        raise InputError(f"{part.entity}: {design.entity} does not compute it on its own")
    return tuple(np.concatenate(column) for column in zip(*calls, strict=True))


def _draw(design: Network, frames: Codes) -> None:
    """Compute the profiles of the outputs of frames."""
    outputs = design.process(frames)
    for block in walk(design):
        if isinstance(block, Readout) and block.load_profile:
            block.profile(outputs)


def _calls(part: Block, compute: Callable[[], object]) -> list[tuple[Codes, ...]]:
    """The arguments with which ``process`` of a block is called during a computation."""
    found: list[tuple[Codes, ...]] = []
    kind: Any = type(part)
    process = kind.process

    def noting(block: Any, *inputs: Codes) -> Any:
        if block == part:
            found.append(tuple(np.broadcast_arrays(*inputs)))
        return process(block, *inputs)

    with patch.object(kind, "process", noting):
        compute()
    return found

"""Finds the inputs that a block inside a design gets while frames run through the twins."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.common.block import Block, around, walk
from golden.input_error import InputError
from golden.instruments.readout import Readout
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.visualisation.load_profile import LoadProfile


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
    activations = [b for b in around(design, part) if isinstance(b, ActivationBlock)]
    calls: list[tuple[Codes, ...]] = []
    for activation in activations:
        (codes,) = seen(design, activation, frames)
        calls += _calls(part, partial(activation.compute, codes))
    if any(isinstance(block, LoadProfile) for block in around(design, part)):
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

    own = "process" in vars(kind)
    kind.process = noting
    try:
        compute()
    finally:
        if own:
            kind.process = process
        else:
            del kind.process
    return found

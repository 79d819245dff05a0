"""Hybrid: a network of two layers, folded over its inputs and over its outputs."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.activation.activation_block import ActivationBlock
from golden.block import Block
from golden.fixed import Codes
from golden.layers.input_controller import InputController
from golden.layers.input_integral import InputIntegral
from golden.layers.output_controller import OutputController
from golden.layers.output_integral import OutputIntegral

# Frames computed at a time; 4096 x 16 nodes x 8 bytes fit a second-level cache.
CHUNK = 4096


@dataclass(frozen=True)
class Hybrid(Block):
    """y = f2(activation(f1(x))) with N + M + L folded work (thesis section 5.4, Figure 5.8).

    Layer 1 has one multiplier per hidden node, used once per sample; each hidden node has one
    activation; layer 2 has one multiplier per hidden node, used once per output.

    Parameters
    ----------
    input_integral : InputIntegral
    activations : tuple of ActivationBlock
        One per hidden node.
    output_integral : OutputIntegral
    """

    block = "hybrid"
    area = "networks"
    input_integral: InputIntegral
    activations: tuple[ActivationBlock, ...]
    output_integral: OutputIntegral

    def __post_init__(self) -> None:
        hidden = len(self.input_integral.nodes)
        if not hidden == len(self.activations) == self.output_integral.hidden:
            raise ValueError(
                f"{self.entity}: got {hidden} nodes, {len(self.activations)} activations and "
                f"{self.output_integral.hidden} weights per output, expected equal numbers"
            )

    @property
    def inputs(self) -> int:
        """Samples of one frame."""
        return self.input_integral.inputs

    @property
    def outputs(self) -> int:
        """Results of one frame."""
        return self.output_integral.outputs

    @property
    def interval(self) -> int:
        """Least clocks from one frame to the next."""
        return max(self.inputs, self.outputs, *(a.interval for a in self.activations))

    @property
    def input_controller(self) -> InputController:
        spacing = self.interval if self.interval > self.inputs else 0
        return InputController(self.inputs, spacing, variant=self.variant)

    @property
    def output_controller(self) -> OutputController:
        return OutputController(self.outputs, variant=self.variant)

    def parts(self) -> tuple[Block, ...]:
        return (
            self.input_controller,
            self.input_integral,
            *self.activations,
            self.output_controller,
            self.output_integral,
        )

    def left_out(self) -> list[str]:
        """What this network does not need and therefore does not build."""
        counts: Counter[str] = sum((a.left_out() for a in self.activations), Counter())
        texts = [f"{count} {what}" for what, count in sorted(counts.items())]
        if self.output_integral.factors is None:
            texts.append("the de-normalisation multiplier and its ROM")
        if not self.input_controller.spacing:
            texts.append("the counter that keeps frames apart: a frame has samples enough")
        return texts

    def process(self, frames: ArrayLike) -> Codes:
        """Output codes, shape (..., outputs), of frames of sample codes, shape (..., inputs).

        Computed in chunks that stay in the processor's cache, so that memory beyond the results
        does not grow with the batch.

        Raises
        ------
        ValueError
            For a wrong last axis or a code outside the signal format.
        """
        samples = np.asarray(frames)
        if samples.ndim == 0 or samples.shape[-1] != self.inputs:
            raise ValueError(
                f"{self.entity} frames: got shape {samples.shape}, expected (..., {self.inputs})"
            )
        flat = samples.reshape(-1, self.inputs)
        results = np.empty((len(flat), self.outputs), dtype=np.int64)
        for start in range(0, len(flat), CHUNK):
            part = slice(start, start + CHUNK)
            q = self.input_integral.process(flat[part])
            columns = [a.process(q[:, j]) for j, a in enumerate(self.activations)]
            results[part] = self.output_integral.process(np.stack(columns, axis=-1))
        return results.reshape(*samples.shape[:-1], self.outputs)

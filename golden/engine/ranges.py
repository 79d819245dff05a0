"""The range of the words behind a ReLU, a leaky ReLU or a linear layer, and where it is from.

Saturation of such a word would be an error. Two ranges avoid it. The bounds of a sum follow from
the bounds of its operands, and no samples exceed them. But they add up the largest magnitudes of
all operands, which real samples never reach together, so they can waste bits. The other range is
that of the recorded frames with a margin. Samples that are unlike every recorded frame may exceed
it; such a sum then saturates.
"""

from dataclasses import dataclass

import numpy as np

from golden.numbers.fixed import Fix
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork, forward_passes

# The bits that the largest word of the recorded frames must have, beside its sign, for the bounds
# to be good enough. A word is rounded by half a unit. The rounding of a weight moves the word by up
# to 4 units for each operand, since an operand has up to 2**17 and the weight an error of up to
# 2**-15. With 15 bits these are 2**-16 and 2**-13 of the largest word. A sample and an output have
# one code per 2**-13 of their range, so an operand of a hidden layer then costs no more than a
# code. Each bit less would double this.
ENOUGH = 15
# By how much a sum may exceed the largest magnitude of the recorded frames. If sums were normally
# distributed, the largest of 1000 to 100,000 recorded ones would be 3 to 4.5 standard deviations
# from the mean, and one of twice that would never occur. It costs one bit. So a range from the data
# leaves ``ENOUGH`` bits or more.
MARGIN = 2


@dataclass(frozen=True)
class Range:
    """The range of the words of one hidden layer.

    bound: The magnitude that no sum exceeds, whatever the samples are.
    met: The largest magnitude on the recorded frames; 0 where there are none.
    from_data: Whether the format is from ``met``. Otherwise it is from ``bound``, and no sum
        saturates.
    layer: Which layer it is, in words.
    places: The neurons of the graph that are the sums of the layer.
    unit: What the last place of a word stands for, where that is more than ``fmt`` can say.
    """

    fmt: Fix
    bound: float
    met: float
    from_data: bool
    layer: str = ""
    places: tuple[int, ...] = ()
    unit: int = 1

    @property
    def text(self) -> str:
        """The range in words."""
        units = f" in units of {self.unit}" if self.unit > 1 else ""
        held = f"words of {self.fmt}{units} hold {self.unit * self.fmt.to_real(self.fmt.high):.4g}"
        if not self.from_data:
            return f"{self.layer}: {held}, from bounds: no sum exceeds {self.bound:.4g}"
        return (
            f"{self.layer}: {held}, from the data: {self.met:.4g} is met, margin {MARGIN}; bounds "
            f"would be {self.bound:.4g}"
        )


def frac_of(met: float, width: int) -> int:
    """The most fraction bits with which words of ``width`` bits hold ``met`` and the margin."""
    return next(
        (frac for frac in range(width - 1, -1, -1) if MARGIN * met * 2**frac < 2 ** (width - 1)), -1
    )


def hidden_peaks(network: DenseNetwork, inputs: Real) -> tuple[float, ...]:
    """The largest magnitude of the words of each hidden layer, in floating point.

    inputs, shape (frames, inputs): Inputs of the network, as signals.
    """
    # Sums that no float holds fit in no format either.
    with np.errstate(over="ignore", invalid="ignore"):
        *hidden, _ = forward_passes(network, inputs)
    # A node with leaky ReLU stores its sum.
    words = (p.sums if p.layer.activation == "leaky_relu" else p.values for p in hidden)
    # Six digits, because the last bits of a sum depend on the machine.
    return tuple(float(f"{np.abs(w).max(initial=0.0):.6g}") for w in words)


def function_input_ranges(network: DenseNetwork, inputs: Real) -> tuple[tuple[float, float], ...]:
    """The least and the largest sum of each node of the last hidden layer, in floating point.

    Only for nodes that have functions of their own; without them there are none. The parameters
    are those of ``hidden_peaks``.
    """
    *_, layer, _ = (None, *network.layers)
    if layer is None or not layer.functions:
        return ()
    *_, last, _ = forward_passes(network, inputs)
    if not len(last.sums):
        return ()
    ends = zip(last.sums.min(axis=0), last.sums.max(axis=0), strict=True)
    return tuple((float(f"{low:.6g}"), float(f"{high:.6g}")) for low, high in ends)

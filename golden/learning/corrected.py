"""The networks of a cascade behind a correction of each sensor, in the words of an engine.

The correction is ``z = x + x g + o`` for each sensor, before all networks. What is learned is
``theta``: first the g of each sensor, then each o, in standard deviations of the drift that
``make recalibrate`` expects. So every element of ``theta`` is about as large as any other, and 0
means no correction.

Each network is taught alone: in the place of the outputs of earlier networks it reads the known
outputs of the placement (R. J. Williams and D. Zipser, "A learning algorithm for continually
running fully recurrent neural networks", *Neural Computation* 1 (1989), 270-280, call that teacher
forcing). So an error of an earlier network cannot drive a later one out of its range, and the
derivatives need no chain through the cascade.

The derivatives are those of back-propagation. As the weights of the networks do not change, they
need the squares of the hidden words and nothing else that is not a constant:

    dy/dz = sum over the nodes of c (1 - h^2) = C - sum of c h^2,   c = w2 w1,   C = sum of c

The arithmetic is that of an engine: a sum is exact, half a unit of its word is added, the lowest
bits are dropped, and what does not fit is saturated. A *product of two words* is not in an engine
that does not learn. The program's weight, which is the coefficient of the multiplier, is replaced
by a second word of the memory without its ``SHORT`` lowest bits, with the sign kept. Of words with
a and b fraction bits, the product has a + b - ``SHORT``, and its word has a + b - 17 after
``DROPPED`` bits: two fractions give a fraction. A sample loses nothing, because its lowest bits are
zeros.

======================  ==========  ============================================
word                    format      why
======================  ==========  ============================================
theta                   Fix(18,14)  8 standard deviations either way
gain less one, offset   Fix(18,17)  8 x 5 % = 0.4
z, offset               Fix(18,16)  as samples
h, h^2, known outputs   Fix(18,17)  as results
dy/dz                   Fix(18,14)  those of ``digit`` stay below 7
======================  ==========  ============================================
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from golden.engine.formats import (
    DROPPED,
    HIDDEN,
    OUTPUT_SHIFT,
    RESULT,
    SAMPLE,
    SAMPLE_SHIFT,
    coeff_frac,
    word_of,
)
from golden.engine.function_table import table_of
from golden.engine.integer_network import IntegerLayer, IntegerNetwork
from golden.engine.quantise import integer_networks
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from golden.trained.function import TANH

# The lowest bits of a word that are dropped when it takes the place of a weight.
SHORT = SAMPLE_SHIFT
THETA = Fix(18, 14)
GAIN = Fix(18, 17)
# Fraction bits of a standard deviation of theta as a weight: of a gain, and of an offset.
GAIN_WEIGHT = GAIN.frac + DROPPED - THETA.frac
OFFSET_WEIGHT = SAMPLE.frac + DROPPED - THETA.frac
# The format of a derivative of an output by a corrected sample.
SLOPE = Fix(18, 14)
# The fraction bits of w2 w1 as the weight of a square.
_OF_SQUARE = SLOPE.frac + DROPPED - RESULT.frac
# Half a unit of an output, which is contained in its word; see ``integer_networks``.
HALF = 1 << (OUTPUT_SHIFT - 1)
# Half a unit of a word, in units of a product.
HALF_WORD = 1 << (DROPPED - 1)


def rounded(sums: Codes) -> Codes:
    """The words of sums."""
    return word_of(sums + HALF_WORD, False)


@dataclass(frozen=True)
class Corrected:
    """Networks of one hidden layer of tanh and one output each, behind corrected sensors.

    gains, offsets, shape (sensors,): A standard deviation of theta, as weights with 17 and 16
        fraction bits.
    """

    networks: tuple[IntegerNetwork, ...]
    gains: Codes
    offsets: Codes

    @classmethod
    def of(cls, mlps: Sequence[DenseNetwork], gain: Real, offset: Real) -> Corrected:
        """Trained networks of a cascade, in whole numbers.

        gain, offset, shape (sensors,): Standard deviations of the expected drift, the offset as a
            signal.
        """
        networks = integer_networks("cascade", mlps)
        for number, network in enumerate(networks, start=1):
            hidden, last = network.layers[0], network.layers[-1]
            if len(network.layers) != 2 or last.nodes != 1 or set(hidden.functions) != {TANH}:
                raise InputError(
                    f"network {number}: got {len(network.layers)} layers and {last.nodes} outputs, "
                    "expected one hidden layer of tanh and one output, which is what is studied"
                )
        gains = Fix(18, GAIN_WEIGHT).quantise(gain)[0]
        return cls(networks, gains, Fix(18, OFFSET_WEIGHT).quantise(offset)[0])

    @property
    def sensors(self) -> int:
        return len(self.gains)

    @property
    def outputs(self) -> int:
        return len(self.networks)

    @cached_property
    def slope_weights(self) -> list[tuple[Codes, Codes]]:
        """C of each sensor and c of each node and sensor for each network, as weights.

        Where C does not fit in 18 bits, it is two weights of a program.
        """
        frac = coeff_frac(RESULT, RESULT) + coeff_frac(HIDDEN, SAMPLE)
        found = []
        for hidden, last in (network.layers for network in self.networks):
            # A product of two words has fewer bits than a float, so it is exact.
            first = np.array(hidden.weights, dtype=np.float64)[:, : self.sensors]
            products = np.array(last.weights, dtype=np.float64).T * first / 2.0**frac
            of_one = Fix(19, SLOPE.frac).quantise(products.sum(axis=0))[0]
            found.append((of_one, Fix(18, _OF_SQUARE).quantise(products)[0]))
        return found

    def corrections(self, codes: Codes) -> tuple[Real, Real]:
        """The gain less one of each sensor, and its offset as a signal.

        codes, shape (2 sensors,): Theta as it can be read: without the lowest bits of its words, as
            outputs leave.
        """
        by_gain, by_offset = np.split(codes / (1 << (THETA.frac - OUTPUT_SHIFT)), 2)
        weights = self.gains / (1 << GAIN_WEIGHT), self.offsets / (1 << OFFSET_WEIGHT)
        return by_gain * weights[0], by_offset * weights[1]

    def samples(self, theta: Codes, samples: Codes) -> Codes:
        """The corrected samples z as words, shape (drifts, sensors).

        theta: shape (drifts, 2 sensors).
        samples, shape (drifts, sensors): Words of samples.
        """
        by_gain, by_offset = np.split(theta, 2, axis=1)
        gains, offsets = rounded(by_gain * self.gains), rounded(by_offset * self.offsets)
        return rounded((samples << DROPPED) + gains * (samples >> SHORT) + (offsets << DROPPED))

    def hidden(self, number: int, words: Codes) -> Codes:
        """The words of tanh of a network, shape (drifts, nodes), of samples and earlier outputs."""
        network = self.networks[number]
        q = rounded(_sums(network.layers[0], words))
        return rounded(table_of(TANH, network.segment_width).sums(q))

    def output(self, number: int, hidden: Codes) -> Codes:
        """The word of an output with half a unit of it, as engines keep it, shape (drifts, 1)."""
        # The start of the sum holds what a word of an output is rounded by.
        return word_of(_sums(self.networks[number].layers[1], hidden), False)

    def slopes(self, number: int, hidden: Codes) -> Codes:
        """The derivatives of an output by the corrected samples, shape (drifts, sensors)."""
        of_one, of_square = self.slope_weights[number]
        squares = rounded(hidden * (hidden >> SHORT))
        return rounded((of_one << DROPPED) - squares @ of_square)

    def process(self, theta: Codes, samples: Codes) -> Codes:
        """The output codes of whole frames, shape (frames, outputs), with one row of theta each."""
        words = self.samples(theta, samples << SAMPLE_SHIFT)
        for number in range(self.outputs):
            words = np.hstack([words, self.output(number, self.hidden(number, words))])
        return np.asarray(words[:, self.sensors :] >> OUTPUT_SHIFT, dtype=np.int64)


def _sums(layer: IntegerLayer, words: Codes) -> Codes:
    """The sums of a layer."""
    return np.asarray(words @ np.array(layer.weights).T + np.array(layer.starts), dtype=np.int64)

"""How far hardware is from the network in floating point, in any frame.

The hardware is the network of `network.py`, which is proved. Word by word, what it is in real
numbers is compared with what the trained network has there: a sum differs by its rounded weights
times the codes, by the differences of what it adds up, and by its own rounding; a table differs at
each code by its value there, and by how far the function moves while its argument is that much off.
Differences keep their sign. So the bound is reached if all nodes are at their worst codes at once.

Floating point saturates where an output or a sum without a table does.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.trained.dense import Dense
from tactus.verify.every_frame.counterexample import Evaluated
from tactus.verify.every_frame.network import Network, looked_up
from tactus.verify.every_frame.sums import Space, Sum

Ends = tuple[float, float]
# Frames of the search: drawn, and tried for each sample of the best of those.
DRAWN, TRIED, ROUNDS, MOVED = 20_000, 200, 4, 12
SEED = 1


@dataclass
class Known:
    """A word of hardware beside what it stands for: its codes, the unit of a code, and how much it
    is too high. A table has one of each for each code of its argument. `cut` tells whether codes
    below and above are cut off."""

    low: Any
    high: Any
    unit: float
    off: tuple[Any, Any]
    cut: tuple[bool, bool] = (False, False)

    def times(self, built: float, trained: float) -> Ends:
        """How much the product with a built weight can be above that with the trained one."""
        found = [
            (built - trained) * code * self.unit + trained * off
            for code in (self.low, self.high)
            for off in self.off
        ]
        # The ends of a table belong together code by code.
        return float(np.min(found)), float(np.max(found))


# A node of tanh that is not built, since nothing that is built reads it.
UNBUILT = Known(0, 0, 1.0, (-1.0, 1.0))


def up(bound: float) -> float:
    """A bound with one decimal, which is not below it."""
    return math.ceil(bound * 10) / 10


def _power(real: float, code: float) -> float:
    """The power of two that a code stands for."""
    if not real or not code:
        raise InputError("no bound is known: a layer or a table of nothing but 0")
    return float(2.0 ** np.round(np.log2(abs(real) / abs(code))))


def bounds(
    given: dict[str, Any], networks: Sequence[Sequence[Dense]], tanh: Any, apart: bool = False
) -> list[Ends]:
    """How much each output can be above the trained network's, in codes of the output.

    With `apart` the trained network reads what the hardware gave for earlier networks, so that the
    error is that of one network alone.
    """
    top, samples = 1 << given["bits"] - 1, given["samples"]
    known = [Known(-top, top - 1, 1 / top, (0.0, 0.0)) for _ in range(samples)]
    places: list[Any] = [[-1, 0, k] for k in range(samples)]
    last = {tuple(place): one for place, one in zip(places, known, strict=True)}
    units: dict[tuple[int, int], float] = {}

    def inputs(network: int, layer: int) -> list[tuple[int, int, int]]:
        """The places of what a layer takes."""
        if layer:
            return [(network, layer - 1, j) for j in range(networks[network][layer - 1].nodes)]
        count = networks[network][0].weights.shape[1]
        earlier = [
            (n, len(layers) - 1, j)
            for n, layers in enumerate(networks[:network])
            for j in range(layers[-1].nodes)
        ]
        return [*[(-1, 0, k) for k in range(samples)], *earlier][:count]

    for word in given["words"]:
        place, terms = word["place"], word.get("sum", [])
        shift, left = word.get("shift", 0), word.get("left", 0)
        if "table" in word:
            of = known[word["of"]]
            layer = networks[place[0]][place[1]]
            known.append(_table(given["tables"][word["table"]], of, layer, tanh))
        elif "round" not in word and len(terms) == 1 and terms[0][1] == 1:
            # The same word with fewer bits, or in another place.
            one = known[terms[0][0]]
            if np.ndim(one.low):
                raise InputError("no bound is known for what follows a table")
            unit = one.unit * 2.0 ** (shift - left)
            lost = (1 - 2.0**-shift) * one.unit * 2.0**shift
            off = one.off[0] - lost, one.off[1]
            known.append(Known(one.low >> shift << left, one.high >> shift << left, unit, off))
            place = places[terms[0][0]]
        elif place[0] < 0:
            raise InputError("no bound is known behind sensors that are corrected")
        else:
            layer = networks[place[0]][place[1]]
            row, bias = layer.weights[place[2]], float(layer.biases[place[2]])
            if layer.activation not in ("tanh", "relu", "linear") or layer.quantiser:
                raise InputError(f"no bound is known for {layer.activation_text}")
            taken = inputs(place[0], place[1])
            built = {tuple(places[k]): (known[k], w) for k, w in terms}
            if len(built) < len(terms) or not {*built} <= {*taken}:
                raise InputError(
                    "no bound is known: a sum adds up what the trained network does not"
                )
            if (key := (place[0], place[1])) not in units:
                known_at = [(abs(w), at) for w, at in zip(row, taken, strict=True) if at in built]
                if not known_at:
                    raise InputError("no bound is known: a sum of nothing")
                trained, at = max(known_at)
                units[key] = _power(trained * built[at][0].unit * 2.0**shift, built[at][1])
            unit = units[key]
            low = high = start = int(word.get("start", 0))
            least = most = start * unit / 2.0**shift - bias
            for at, trained in zip(taken, row, strict=True):
                one, w = built.get(at) or (last.get(at, UNBUILT), 0)
                if apart and -1 < at[0] < place[0]:
                    one = replace(one, off=(0.0, 0.0))
                ends = np.min([one.low * w, one.high * w]), np.max([one.low * w, one.high * w])
                low, high = low + int(ends[0]), high + int(ends[1])
                more = one.times(w * unit / (2.0**shift * one.unit), float(trained))
                least, most = least + more[0], most + more[1]
            part = (1 - 2.0**-shift) * unit
            up = {"down": 0.0, "up": unit / 2, "even": unit / 2}[word.get("round", "down")]
            least, most = least + min(up - part, -up), most + up
            raised = round(up / unit * 2.0**shift)
            low, high = (int(end) + raised >> shift for end in (low, high))
            cut = False, False
            if "clip" in word:
                first, end = word["clip"]
                cut = low < first, high > end
                if low * unit - most < first * unit or high * unit - least > end * unit:
                    # What saturates on both sides comes no further apart.
                    least, most = min(least, 0.0), max(most, 0.0)
                low, high = (min(max(code, first), end) for code in (low, high))
            known.append(Known(low << left, high << left, unit / 2.0**left, (least, most), cut))
        places.append(place)
        last[tuple(place)] = known[-1]
    found = [known[k] for k in given["outputs"]]
    if any(one.unit * top != 1 for one in found):
        raise InputError("no bound is known: weights are normalised")
    return [(one.off[0] / one.unit, one.off[1] / one.unit) for one in found]


def _table(table: dict[str, Any], of: Known, layer: Dense, tanh: Any) -> Known:
    """The values of a table at every code, beside the function at all that its argument can be."""
    if layer.functions:
        raise InputError("no bound is known: each node has a function of its own")
    codes = np.arange(of.low, of.high + 1)
    values = looked_up(table)(codes)

    def real(q: Any) -> Any:
        return layer.activate(q, tanh)[0]

    # Where the sum is cut off, the trained one may go on.
    lower, upper = (codes * of.unit - off for off in (of.off[1], of.off[0]))
    lower[0] = -np.inf if of.cut[0] else lower[0]
    upper[-1] = np.inf if of.cut[1] else upper[-1]
    below, above = real(lower), real(upper)
    if (np.diff(real(np.sort(np.concatenate([lower, upper])))) < 0).any():
        raise InputError("no bound is known: a function falls somewhere")
    k = int(np.abs(values).argmax())
    unit = _power(float(real(codes * of.unit)[k]), float(values[k])) if values[k] else 1.0
    return Known(values, values, unit, (values * unit - above, values * unit - below))


def farthest(given: dict[str, Any], real: Callable[[Any], Any]) -> list[float]:
    """The largest difference of each output that a search finds, in codes.

    `real` gives the outputs in floating point for samples of frames.
    """
    top, space = 1 << given["bits"] - 1, Space()
    samples = [space.sample(f"x{k}", -top, top - 1) for k in range(given["samples"])]
    network = Network(given)
    outputs = network.outputs(network.words(space, samples))
    words = [w for v in samples if isinstance(v, Sum) for w in v.terms]
    rng = np.random.default_rng(SEED)
    drawn = rng.integers(-top, top, (DRAWN, len(words)))
    drawn[: DRAWN // 2] = rng.choice([-top, -1, 0, top - 1], (DRAWN // 2, len(words)))

    def apart(frames: Any) -> Any:
        now = Evaluated(words, frames)
        got = np.stack([now.value(v) for v in outputs], axis=1)
        return np.abs(got - np.clip(real(frames / top) * top, -top, top - 1))

    first, found = apart(drawn), []
    for n in range(len(outputs)):
        best, frame = 0.0, drawn[first[:, n].argmax()]
        for _ in range(ROUNDS):
            for k in rng.permutation(len(words))[:MOVED]:
                tried = np.repeat(frame[np.newaxis], TRIED, axis=0)
                tried[1:, k] = rng.integers(-top, top, TRIED - 1)
                tried[1 : TRIED // 2, k] = np.clip(
                    frame[k] + rng.integers(-64, 65, TRIED // 2 - 1), -top, top - 1
                )
                differences = apart(tried)[:, n]
                best, frame = float(differences.max()), tried[differences.argmax()]
        found.append(best)
    return found

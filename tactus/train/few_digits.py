"""Weights with few signed digits: ``training.digits`` of a scene.

A product with a constant is a sum of as many shifted numbers as the constant has signed digits. So
hardware without multipliers is as large as the digits of all weights together.

The weights are rounded to few digits one after another, beginning with those where that costs
least. After each one, all weights that are still free compensate for it, as in the optimal brain
surgeon (B. Hassibi and D. G. Stork, 1993). With the Hessian H of the error, moving weight i by d,
while the free ones compensate, costs ``d**2 / inverse(H)[i, i]``, and moves the free ones by ``d *
inverse(H)[:, i] / inverse(H)[i, i]``. A weight gets the number for which the sum of this cost and
of a price for each digit is least. The price determines how many digits all weights have in the
end. After every few weights the free ones are refitted by Levenberg-Marquardt, and H is computed
anew. The digits of biases cost nothing, because adding a constant takes one adder, whatever the
constant is.

The error is that of the rows that train and of further frames between and just beyond these rows,
where the trained network is the teacher, because no row determines the network there. Each output
is weighted by the inverse of the trained network's error on validation rows.

The outputs of a network for classes are logits. There the error is the squared difference from the
logits of the trained network. The cross-entropy would not do: at a network that is sure of its
classes it is so flat that large changes of weights seem to cost nothing.

A node of ReLU computes the same with weights twice as large in front of it and half as large behind
it. So the Hessian says that one layer can make up for any change of the other, which is true only
near the trained weights. For networks of named layers it is damped, so that large compensations
cost something too. Such networks may be large, and the time grows with the cube of their size. So
fewer orders of the weights are tried, and several weights are rounded at once.
"""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from golden.input_error import InputError, naming
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.numbers.signed_digits import digit_counts, nearest_with
from golden.trained.dense import DenseNetwork, packed, tanh, unpacked
from tactus.train.objective import Objective, Rows
from tactus.train.task import Frames, Task, shift_biases, signed_errors

# Number of different orders in which the weights are rounded; random factors on their costs make
# the orders differ.
STARTS = 6
SHUFFLE = 0.2

# The teacher's frames: their number; among how many neighbours of a row one is chosen; how far each
# frame is on the way to it, or beyond; how far it is off the way, as a part of a sensor's standard
# deviation; and the weight of all frames against the rows.
TEACHER_FRAMES = 600
NEIGHBOURS = 4
WAY = (-0.25, 0.75)
ASIDE = 0.02
TEACHER_WEIGHT = 2.0

REFITS = 9  # between the first weight and the last
STEPS = 2  # of each
DAMPING = np.geomspace(1e-9, 1e3, 9)

# The range of the price of a digit, as parts of the error of the trained network.
PRICES = (1e-3, 1e8)
PRICE_STEP = 0.02  # between the last two prices that are tried, as a part
NEAR = 1.5  # later starts search prices within this factor of the first start's price
RUNGS = 64  # from the least price to the greatest, where the fewest digits are looked for
SLACK = 0.02  # so much fewer digits than asked for will do

# For networks of named layers: how much the Hessian is damped, as a part of its diagonal.
HOLD = 0.01
# the weights and biases up to which each weight is rounded by itself, and all orders are tried.
ONE_BY_ONE = 512


@dataclass(frozen=True)
class Grid:
    """The numbers that the weights and biases of a network can have, in the order of ``packed``.

    like: A network with the same layers.
    low, high: The least and the largest code, which both formats share.
    weights: Which of them are weights; the others are biases.
    """

    like: DenseNetwork
    lsb: Real
    low: int
    high: int
    weights: NDArray[np.bool_]

    def network(self, vector: Real) -> DenseNetwork:
        return unpacked(vector, self.like)

    def rounded(self, vector: Real) -> Real:
        """The values of the nearest codes within the format."""
        return np.asarray(self._codes(vector) * self.lsb)

    def digits(self, vector: Real) -> int:
        codes = self._codes(vector)[self.weights].astype(np.int64)
        return int(digit_counts(codes).sum())

    def within(self, vector: Real) -> Real:
        """The vector, limited to the range of the formats."""
        return np.asarray(np.clip(vector, self.low * self.lsb, self.high * self.lsb))

    def _codes(self, vector: Real) -> Real:
        return np.clip(np.floor(vector / self.lsb + 0.5), self.low, self.high)


def grid_of(network: DenseNetwork, width: int) -> Grid:
    layers = network.layers
    formats = [
        Fix.largest_frac(
            width, np.concatenate([layer.weights.ravel(), layer.biases]), f"layer {n} weights"
        )
        for n, layer in enumerate(layers, start=1)
    ]
    sizes = [size for layer in layers for size in (layer.weights.size, layer.nodes)]
    lsb = np.repeat([2.0**-fmt.frac for fmt in formats for _ in range(2)], sizes)
    low, high = formats[0].low, formats[0].high
    return Grid(network, lsb, low, high, np.repeat([True, False] * len(layers), sizes))


@dataclass(frozen=True)
class Rounding:
    """A trained network of a scene that gets fewer digits.

    part: The part of the rows that trained it, whose error counts.
    importance: The factors of the scales of the outputs; see ``importance_of``.
    layered: Whether the network has layers that the scene names, or many rows.
    """

    task: Task
    network: DenseNetwork
    part: str
    importance: Real
    layered: bool

    @cached_property
    def grid(self) -> Grid:
        return grid_of(self.network, self.task.scene.precision.coeff_width)

    @property
    def frames(self) -> Frames:
        """The rows that trained the network, with disturbance."""
        frames: Frames = getattr(self.task, self.part)
        return frames

    @cached_property
    def start(self) -> Real:
        return packed(self.network)

    @cached_property
    def objective(self) -> Objective:
        """The error that is minimised: that of its training rows. Nothing ends it early."""
        activation = tanh if self.layered else self.task.scene.scheme.real
        rows = self._rows()
        return Objective(self.network, rows, rows, sys.maxsize, activation, 0.0)

    @cached_property
    def unit(self) -> float:
        """The unit of prices: the error of the trained network, but at least that of an LSB."""
        return max(self.objective.value(self.start), float(SIGNAL.to_real(1)) ** 2)

    def rounded(self, count: int) -> Iterator[DenseNetwork]:
        """A network of ``count`` digits from each start; only the nearest if it has so few."""
        nearest = self.grid.rounded(self.start)
        if self.grid.digits(nearest) <= count:
            yield self.grid.network(nearest)
            return
        price = None
        for rng in self.generators():
            with naming(f"{self.task.scene.path}: training.digits"):
                point, price = at_most(self, count, rng, price)
            yield self.finished(point)

    def generators(self) -> Iterator[np.random.Generator]:
        """The random numbers of each start."""
        seed = self.task.scene.training.seed
        starts = 1 if self.layered and len(self.start) > ONE_BY_ONE else STARTS
        return (np.random.default_rng([seed, self.task.number, n]) for n in range(starts))

    def finished(self, point: Real) -> DenseNetwork:
        """The network of a point, whose biases are shifted and rounded; nothing shifts logits."""
        network = self.grid.network(point)
        if not self.task.scene.labels:
            network = shift_biases(self.task, network, self.frames)
        return self.grid.network(self.grid.rounded(packed(network)))

    def _rows(self) -> Rows:
        """``frames``, and frames between and just beyond recorded rows.

        If the scene has classes, the targets of all are the logits of the network, and errors are
        parts of these.
        """
        activation, frames = self.task.scene.scheme.real, self.frames
        taught = teacher_frames(self.task, self.task.recorded.take(self.task.rows(self.part)))
        inputs = np.concatenate([frames.inputs, taught.inputs])
        if self.task.scene.labels:
            logits = self.network.process(inputs, activation)
            spread = max(float(logits.std()), sys.float_info.min)
            return Rows(inputs, logits, np.full(logits.shape, spread * np.sqrt(logits.size)))
        count = np.sqrt(len(frames.inputs)), np.sqrt(len(taught.inputs) / TEACHER_WEIGHT)
        return Rows(
            inputs,
            np.concatenate([frames.targets, self.network.process(taught.inputs, activation)]),
            np.concatenate([frames.scale * count[0], taught.scale * count[1]]) * self.importance,
        )


def teacher_frames(task: Task, recorded: Frames) -> Rows:
    """Frames near recorded ones, close to the way from a row to one of its neighbours.

    The targets and scales are those of the row from which a frame starts.
    """
    rng = np.random.default_rng([task.scene.training.seed, task.number, TEACHER_FRAMES])
    spread = recorded.inputs.std(axis=0)
    measured = recorded.inputs / np.where(spread > 0, spread, 1)
    at = rng.integers(0, len(measured), TEACHER_FRAMES)
    distances = cdist(measured[at], measured)
    distances[np.arange(len(at)), at] = np.inf
    near = np.argsort(distances, axis=1, kind="stable")[:, : min(NEIGHBOURS, len(measured) - 1)]
    other = near[np.arange(len(at)), rng.integers(0, near.shape[1], len(at))]
    way = rng.uniform(*WAY, (len(at), 1))
    here, there = recorded.inputs[at], recorded.inputs[other]
    aside = ASIDE * spread * rng.normal(size=here.shape)
    inputs = np.clip(here + way * (there - here) + aside, -1, 1)
    return Rows(inputs, recorded.targets[at], recorded.scale[at])


def refitted(aim: Rounding, vector: Real, free: NDArray[np.bool_]) -> tuple[Real, Real]:
    """Refit the free weights by some steps of Levenberg and Marquardt.

    Returns the new point, and the Hessian of the free weights there, damped so that it can be
    inverted.
    """
    at = np.flatnonzero(free)
    value = aim.objective.value(vector)
    gradient, whole = aim.objective.gradient_hessian(vector)
    for _ in range(STEPS):
        for damping in DAMPING:
            moved = vector.copy()
            moved[at] -= np.linalg.solve(_damped(whole, at, damping), gradient[at])
            moved = aim.grid.within(moved)
            new = aim.objective.value(moved)
            if new < value:
                break
        else:
            break
        vector, value = moved, new
        gradient, whole = aim.objective.gradient_hessian(vector)
    return vector, _damped(whole, at, HOLD if aim.layered else DAMPING[0])


def _damped(whole: Real, at: NDArray[np.int64], damping: float) -> Real:
    """Part of a Hessian, damped so that it has an inverse even if it is zero."""
    diagonal = whole.diagonal()
    least = 1e-12 * diagonal.max() + sys.float_info.min
    return whole[np.ix_(at, at)] + np.diag(damping * diagonal[at] + least)


def priced(aim: Rounding, price: float, rng: np.random.Generator) -> Real:
    """Round a trained network, giving each weight as many digits as are worth their price.

    price: Price of a digit, in the unit of the error.
    rng: Source of the random factors that change the order.
    """
    grid, vector = aim.grid, aim.start.copy()
    free = np.ones(len(vector), dtype=bool)
    each = -(-int(grid.weights.sum()) // REFITS)
    together = max(1, len(vector) // ONE_BY_ONE) if aim.layered else 1
    while (free & grid.weights).any():
        vector, hessian = refitted(aim, vector, free)
        at = np.flatnonzero(free)
        inverse = np.linalg.inv(hessian)
        lsb, values, left = grid.lsb[at], vector[at], grid.weights[at].copy()
        many = min(each, int(left.sum()))
        while many:
            found = np.flatnonzero(left)
            stiff = _stiffness(np.diag(inverse)[found])
            targets = values[found]
            numbers = _cheapest(targets / lsb[found], lsb[found] ** 2 / stiff, price, grid)
            moves = numbers * lsb[found] - targets
            costs = moves**2 / stiff * np.exp(SHUFFLE * rng.normal(size=len(found)))
            best = found[np.argsort(costs, kind="stable")[: min(together, many)]]
            # The inverse is updated for all of them at once; until then, ``along`` and ``rows``
            # hold what each of them changes.
            along, rows = np.zeros((len(at), len(best))), np.zeros((len(best), len(at)))
            for n, i in enumerate(best):
                rows[n] = inverse[i] - along[i] @ rows
                column = inverse[:, i] - along @ rows[:, i]
                one = _stiffness(column[[i]])
                number = _cheapest(values[[i]] / lsb[i], lsb[i] ** 2 / one, price, grid)
                along[:, n] = column / one
                values = values + along[:, n] * (number * lsb[i] - values[i])
                values[i] = number[0] * lsb[i]
            inverse = inverse - along @ rows
            left[best] = False
            free[at[best]] = False
            many -= len(best)
        vector[at] = values
        vector = grid.within(vector)
    vector, _ = refitted(aim, vector, free)
    return grid.rounded(vector)


def _stiffness(diagonal: Real) -> Real:
    """Elements of a diagonal, which a rounding error may have made 0 or negative."""
    return np.maximum(diagonal, sys.float_info.min)


def _cheapest(values: Real, stiffness: Real, price: float, grid: Grid) -> Real:
    """For each value the whole number with the least cost.

    The cost is the squared distance times the stiffness, plus the price of each digit.
    """
    values = np.clip(values, grid.low, grid.high)
    # A number of n bits has at most n / 2 + 1 signed digits.
    numbers = nearest_with(values, grid.high.bit_length() // 2 + 1)
    costs = (numbers - values) ** 2 * stiffness + price * np.arange(len(numbers))[:, np.newaxis]
    costs[(numbers < grid.low) | (numbers > grid.high)] = np.inf
    return numbers[costs.argmin(axis=0), np.arange(len(values))].astype(np.float64)


def at_most(
    aim: Rounding, count: int, rng: np.random.Generator, near: float | None = None
) -> tuple[Real, float]:
    """Round a trained network to ``count`` digits, or slightly fewer.

    Returns the point, and the price that led to it, as a part of ``aim.unit``.

    near: A price near which the search begins.
    """
    for ends in [*([(near / NEAR, near * NEAR)] if near else []), PRICES]:
        low, high = np.log(ends)
        best: tuple[Real, float] | None = None
        while high - low > PRICE_STEP:
            middle = (low + high) / 2
            price = float(np.exp(middle))
            point = priced(aim, price * aim.unit, rng)
            digits = aim.grid.digits(point)
            if digits > count:
                low = middle
                continue
            high = middle
            if best is None or aim.objective.value(point) < aim.objective.value(best[0]):
                best = point, price
            if digits >= count * (1 - SLACK):
                break
        if best:
            return best
    raise InputError(f"got {count}, expected at least {digits}: no weights with fewer digits")


def count_digits(network: DenseNetwork, width: int) -> int:
    """The number of signed digits of all weights of a network in ``width`` bits."""
    grid = grid_of(network, width)
    return grid.digits(packed(network))


def errors_of(task: Task, network: DenseNetwork) -> Real:
    """Mean bit-true error of each output on the validation rows.

    If the scene has classes, it is the mean cross-entropy with the labels, which is one number.
    """
    frames = task.validation
    if task.scene.labels:
        outputs = network.process(frames.inputs, task.scene.scheme.real)
        return np.array([(frames.errors(outputs) ** 2).mean()])
    return np.abs(signed_errors(task, network, frames)).mean(axis=0)


def importance_of(task: Task, network: DenseNetwork) -> Real:
    """The relative error of each output, where no error counts as a small one."""
    found = errors_of(task, network)
    found = np.maximum(found, 1e-3 * found.max())
    return found / found.mean() if found.max() else np.ones(len(found))


def growth(task: Task, before: DenseNetwork, network: DenseNetwork) -> float:
    """The largest growth of an output's error on the validation rows, as a ratio."""
    return float((errors_of(task, network) / np.maximum(errors_of(task, before), 1e-12)).max())


def selected(aim: Rounding) -> DenseNetwork:
    """The network with the digits that the scene asks for, selected by the validation rows."""
    settings, grid = aim.task.scene.training, aim.grid

    worst = partial(growth, aim.task, aim.network)
    if isinstance(settings.digits, int):
        return min(aim.rounded(settings.digits), key=worst)
    best = grid.network(grid.rounded(aim.start))
    for price in aim.unit * np.geomspace(*PRICES, RUNGS):
        found = [aim.finished(priced(aim, price, rng)) for rng in aim.generators()]
        network = min(found, key=worst)
        if worst(network) > 1 + settings.digits_tolerance:
            break
        best = min(best, network, key=lambda one: grid.digits(packed(one)))
    return best


def with_few_digits(
    stages: Sequence[tuple[Task, DenseNetwork]], layered: bool
) -> list[DenseNetwork]:
    """The chosen network with few digits, then the tested and the written one.

    Each is fitted on the rows that it has seen. Without ``training.refit`` there is one.

    stages: Each network with its task; the last two were trained further, on training and
        validation rows and on all rows.
    layered: See ``Rounding``.
    """
    (task, chosen), *more = stages
    settings, importance = task.scene.training, importance_of(task, chosen)
    found = [selected(Rounding(task, chosen, "training", importance, layered))]
    if not settings.refit:
        return found * 3
    count = settings.digits
    if not isinstance(count, int):
        count = count_digits(found[0], task.scene.precision.coeff_width)
    for (own, network), part in zip(more, ("known", "every"), strict=True):
        aim = Rounding(own, network, part, importance, layered)
        # No rows are left to choose among the starts: the best on these rows is taken.
        found.append(min(aim.rounded(count), key=lambda one: aim.objective.value(packed(one))))
    return found

"""Gain and offset of each sensor, so that known placements get the outputs that are known.

The networks stay what they are. What is fitted is the correction ``gain * reading + offset`` of
each sensor before them: the one whose outputs are nearest to the known ones. It is general: the
placements need not stand in the recording, and any scene can be recalibrated.

A correction is told by what it adds at both ends of what its sensor read in the recording. There
it is the same kind of number for every sensor, and it is as likely to be large at either end.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares

from golden.networks.mlp import Real
from golden.scene import Scene, Vectors
from golden.scene.scale import Scale

# What a correction is without any placement, as a standard deviation of a signal from -1 to 1: more
# than sensors drift, so that it decides nothing that a placement tells.
BEFOREHAND = 0.1

# Of a signal: to the bit.
LEAST_SPAN = 2.0**-13

# Own error of a network, in percent, below which it is as good as none.
LEAST_ERROR = 0.01


def outputs_and_slopes(scene: Scene, samples: Real) -> tuple[Real, Real]:
    """Outputs of the networks in floating point, and their derivatives by the sensors.

    Parameters
    ----------
    scene : Scene
    samples : float array, shape (rows, sensors)
        Signals.

    Returns
    -------
    float array, shape (rows, outputs); float array, shape (rows, outputs, sensors)
    """
    rows, sensors = samples.shape
    outputs, slopes = np.empty((rows, 0)), np.empty((rows, 0, sensors))
    by_sensor = np.broadcast_to(np.eye(sensors), (rows, sensors, sensors))
    cascade = scene.arrangement == "cascade"
    for mlp in scene.mlps():
        seen = np.hstack([samples, outputs]) if cascade else samples
        hidden, bends = scene.scheme.real(seen @ mlp.w1.T + mlp.b1)
        found = np.einsum("oh,rh,hi->roi", mlp.w2, bends, mlp.w1, optimize=True)
        inner = np.concatenate([by_sensor, slopes], axis=1) if cascade else by_sensor
        outputs = np.hstack([outputs, hidden @ mlp.w2.T + mlp.b2])
        slopes = np.concatenate([slopes, found @ inner], axis=1)
    return outputs, slopes


@dataclass(frozen=True)
class Sensitivity:
    """What a scene's recording says of its sensors and of its networks.

    Attributes
    ----------
    low, high : float array, shape (sensors,)
        Ends of what each sensor read, as signals.
    error : float array, shape (outputs,)
        Root mean square of each output's own error, percent, floating point.
    tells : float array, shape (rows, outputs, 2 sensors)
        What each recorded placement would tell; see ``telling``.
    """

    low: Real
    high: Real
    error: Real
    tells: Real

    @classmethod
    def of(cls, scene: Scene) -> Sensitivity:
        """Of a scene.

        Raises
        ------
        FileNotFoundError, ValueError
            See ``Scene.vectors`` and ``Scene.mlps``.
        """
        vectors = scene.vectors()
        low = vectors.inputs.min(axis=0)
        high = np.maximum(vectors.inputs.max(axis=0), low + LEAST_SPAN)
        errors = vectors.percent_errors(scene.process_real(vectors.inputs))
        error = np.maximum(np.sqrt((errors**2).mean(axis=0)), LEAST_ERROR)
        part = cls(low, high, error, np.empty(0))
        return cls(low, high, error, part.telling(scene, vectors.inputs, vectors.scale))

    def ends(self, samples: Real) -> Real:
        """How much a correction at either end of each sensor adds to samples: (rows, 2 sensors)."""
        part = (samples - self.low) / (self.high - self.low)
        result: Real = np.hstack([1 - part, part])
        return result

    def telling(self, scene: Scene, samples: Real, scale: Real) -> Real:
        """Derivatives of the errors, each as a part of its network's own, by the corrections.

        Parameters
        ----------
        scene : Scene
        samples : float array, shape (rows, sensors)
        scale : float array, shape (rows, outputs)
            What an error counts against; see ``Vectors``.

        Returns
        -------
        float array, shape (rows, outputs, 2 sensors)
        """
        _, slopes = outputs_and_slopes(scene, samples)
        by_ends = np.concatenate([slopes, slopes], axis=2) * self.ends(samples)[:, np.newaxis]
        result: Real = by_ends * (100 / scale / self.error)[:, :, np.newaxis]
        return result

    def unsure(self, information: Real) -> Real:
        """Covariance of the corrections, shape (2 sensors, 2 sensors).

        Parameters
        ----------
        information : float array, shape (2 sensors, 2 sensors)
            Of some placements, ``tells^T tells``.
        """
        beforehand = np.eye(len(information)) / BEFOREHAND**2
        return np.asarray(np.linalg.inv(information + beforehand), dtype=np.float64)

    def added(self, covariance: Real) -> Real:
        """What corrections of some covariance add to the error of each output over the recording,
        as a part of the output's own."""
        squares = np.einsum("roi,ij,roj->ro", self.tells, covariance, self.tells, optimize=True)
        result: Real = np.sqrt(squares.mean(axis=0))
        return result

    def added_by(self, covariance: Real) -> Real:
        """The largest of these that each sensor alone would add."""
        sensors = len(self.low)
        found = []
        for sensor in range(sensors):
            own = np.zeros_like(covariance)
            at = np.ix_([sensor, sensor + sensors], [sensor, sensor + sensors])
            own[at] = covariance[at]
            found.append(self.added(own).max())
        return np.array(found)


def fit(scene: Scene, recorded: Sensitivity, placements: Vectors) -> list[Scale]:
    """The correction of each sensor: ``offset + factor * signal`` is what the networks get.

    The best of two descents: from no correction, and from the one that brings the readings next to
    those that were recorded at the nearest placement. The first alone may end elsewhere.

    Parameters
    ----------
    scene : Scene
    recorded : Sensitivity
        Of the scene.
    placements : Vectors
        Readings and known outputs.
    """
    samples, ends = placements.inputs, recorded.ends(placements.inputs)
    weights = 100 / placements.scale / recorded.error

    def corrected(correction: Real) -> Real:
        """Of each sensor what either end adds."""
        low, high = np.split(ends * correction, 2, axis=1)
        return samples + low + high

    @lru_cache(maxsize=1)
    def both(correction: bytes) -> tuple[Real, Real]:
        """Outputs and slopes: a descent asks for either at the same place."""
        return outputs_and_slopes(scene, corrected(np.frombuffer(correction)))

    def errors(correction: Real) -> Real:
        outputs, _ = both(correction.tobytes())
        misses = (outputs - placements.targets) * weights
        return np.concatenate([misses.ravel(), correction / BEFOREHAND])

    def slopes(correction: Real) -> Real:
        _, found = both(correction.tobytes())
        moved = np.concatenate([found, found], axis=2) * ends[:, np.newaxis]
        moved = (moved * weights[:, :, np.newaxis]).reshape(-1, len(correction))
        return np.concatenate([moved, np.eye(len(correction)) / BEFOREHAND])

    starts = [np.zeros(ends.shape[1]), _towards_recorded(scene, recorded, placements)]
    found = [least_squares(errors, start, jac=slopes) for start in starts]
    low, high = np.split(min(found, key=lambda one: float(one.cost)).x, 2)
    gains = 1 + (high - low) / (recorded.high - recorded.low)
    offsets = low + (1 - gains) * recorded.low
    return [Scale(float(o), float(g)) for o, g in zip(offsets, gains, strict=True)]


def _towards_recorded(scene: Scene, recorded: Sensitivity, placements: Vectors) -> Real:
    """The correction that brings readings next to those recorded at the nearest placement."""
    vectors = scene.vectors()
    found = []
    apart = (placements.targets[:, np.newaxis] - vectors.targets) / placements.scale[:, np.newaxis]
    nearest: Real = vectors.inputs[(apart**2).sum(axis=2).argmin(axis=1)]
    ends = recorded.ends(placements.inputs)
    sensors = len(recorded.low)
    for sensor in range(sensors):
        matrix = ends[:, [sensor, sensor + sensors]]
        missing = nearest[:, sensor] - placements.inputs[:, sensor]
        # A little of the least correction, where readings that hardly differ say nothing of both.
        matrix = np.vstack([matrix, LEAST_SPAN * np.eye(2)])
        found.append(np.linalg.lstsq(matrix, np.append(missing, [0, 0]))[0])
    return np.concatenate(np.array(found).T)

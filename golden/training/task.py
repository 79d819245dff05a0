"""What one network of a scene learns from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.fixed import Codes
from golden.networks.arrangement import seen
from golden.networks.mlp import Mlp, Real
from golden.precision import SIGNAL
from golden.scene import Scene, Vectors
from golden.scene.scale import readings


@dataclass(frozen=True)
class Split:
    """Row numbers of the training, validation and test rows: 50, 25 and 25 % of all."""

    training: NDArray[np.int64]
    validation: NDArray[np.int64]
    test: NDArray[np.int64]


def split_rows(rows: int, seed: int) -> Split:
    """A random split of ``rows`` rows.

    Raises
    ------
    ValueError
        For fewer than 8 rows: a part would hold a single row or none.
    """
    if rows < 8:
        raise ValueError(f"got {rows} rows, expected at least 8 to split into 50, 25 and 25 %")
    order = np.random.default_rng(seed).permutation(rows)
    half, three_quarters = rows // 2, rows // 2 + rows // 4
    return Split(order[:half], order[half:three_quarters], order[three_quarters:])


@dataclass(frozen=True)
class Task:
    """One network to train, with what it sees and what it shall give.

    Attributes
    ----------
    scene : Scene
    number : int
        Which network of the scene.
    inputs : float array, shape (rows, inputs)
        What it trains on: the samples as quantised and, in a cascade, the outputs of the networks
        before it, bit-true or in floating point as ``training.earlier_outputs`` says.
    codes : int64 array, shape (rows, inputs)
        What its hardware sees.
    targets, scale : float arrays, shape (rows, outputs)
        ``scale`` is what an error counts against: the target or a full scale.
    split : Split
    """

    scene: Scene
    number: int
    inputs: Real
    codes: Codes
    targets: Real
    scale: Real
    split: Split

    def bit_true(self, mlp: Mlp, rows: NDArray[np.int64] | slice = slice(None)) -> Real:
        """Outputs of ``mlp`` in the scene's hardware.

        Raises
        ------
        ValueError
            When the hardware's formats cannot hold its weights.
        """
        return SIGNAL.to_real(self.scene.build(mlp).process(self.codes[rows]))


def task_for(scene: Scene, vectors: Vectors, earlier: Sequence[Mlp]) -> Task:
    """The task of the network that follows ``earlier``, the trained networks before it.

    Raises
    ------
    ValueError
        For too few rows to split, or a column without which the network would learn the same.
    """
    split = split_rows(len(vectors.inputs), scene.training.seed)
    _refuse_constant(scene, vectors)
    codes, inputs = vectors.codes, SIGNAL.to_real(vectors.codes)
    bit_true: list[Codes] = []
    given: list[Real] = []
    for mlp in earlier:
        bit_true.append(scene.build(mlp).process(seen(scene.arrangement, codes, bit_true)))
        if scene.training.earlier_outputs == "float":
            real = seen(scene.arrangement, inputs, given)
            given.append(mlp.process(real, scene.scheme.real))
        else:
            given.append(SIGNAL.to_real(bit_true[-1]))
    number = len(earlier)
    outputs = scene.members[number].outputs
    columns = [scene.outputs.index(name) for name in outputs]
    targets = vectors.targets[:, columns]
    return Task(
        scene,
        number,
        seen(scene.arrangement, inputs, given),
        seen(scene.arrangement, codes, bit_true),
        targets,
        vectors.scale[:, columns],
        split,
    )


def _refuse_constant(scene: Scene, vectors: Vectors) -> None:
    for key, names, values in (
        ("sensors", scene.sensors, readings(vectors.inputs, scene.scales(scene.sensors))),
        ("outputs", scene.outputs, scene.in_units(vectors.targets)),
    ):
        for name, column in zip(names, values.T, strict=True):
            if (column == column[0]).all():
                raise ValueError(
                    f"{scene.data_path}: column {name!r}: got {column[0]:g} in every row, expected "
                    f"values that differ; take it out of data.{key} in {scene.path}"
                )

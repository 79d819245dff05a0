"""The plate equation by finite differences, as an independent check of the series."""

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.linalg import eigsh, spsolve

from golden.numbers.domain import checked
from golden.numbers.real import Real
from tactus.physics.plate import Plate

MOST_CELLS = 2000


def _biharmonic(plate: Plate, columns: int, rows: int) -> sparse.csc_array:
    """The operator of the plate equation, over the stiffness, at the inner nodes (row by row)."""
    checked(columns=(columns, 4, MOST_CELLS), rows=(rows, 4, MOST_CELLS))

    def second(cells: int, length: float) -> sparse.dia_array:
        ones = np.ones(cells - 1)
        bands = (ones, -2 * ones, ones)
        return sparse.dia_array((np.stack(bands), (-1, 0, 1)), shape=(cells - 1, cells - 1)) * (
            (cells / length) ** 2
        )

    x, y = second(columns, plate.length), second(rows, plate.width)
    fourth = (y @ y).tolil()
    if plate.clamped:
        # A mirrored node beyond a clamped edge has the deflection of its image; at a simply
        # supported edge it has the negative of it. So the mirror adds 1 + 1 instead of -1 + 1.
        for end in (0, rows - 2):
            fourth[end, end] += 2 * (rows / plate.width) ** 4
    identity_x = sparse.eye_array(columns - 1)
    identity_y = sparse.eye_array(rows - 1)
    return sparse.csc_array(
        sparse.kron(identity_y, x @ x) + 2 * sparse.kron(y, x) + sparse.kron(fourth, identity_x)
    )


def grid_influence(plate: Plate, load: ArrayLike, columns: int, rows: int) -> Real:
    """Deflection of all inner nodes for 1 N at one node, m/N.

    It uses the thirteen-point stencil of the plate equation, which is of second order. At the load,
    where the curvature has no limit, the error is of second order except for a logarithm.

    load, shape (2,): xi and eta in m; the load acts at the nearest inner node.
    columns, rows: Cells along x and y, 4 to 2000.

    Returns, shape (rows - 1, columns - 1): Node (i, j) is at y = (i + 1) b / rows, x = (j + 1) a /
        columns.
    """
    operator = _biharmonic(plate, columns, rows)
    xi, eta = np.asarray(load, dtype=np.float64)
    checked(load_x=(xi, 0, plate.length), load_y=(eta, 0, plate.width))
    j = int(np.clip(round(xi / plate.length * columns), 1, columns - 1)) - 1
    i = int(np.clip(round(eta / plate.width * rows), 1, rows - 1)) - 1
    pressure = np.zeros((rows - 1, columns - 1))
    pressure[i, j] = columns * rows / (plate.length * plate.width * plate.stiffness)
    result: Real = spsolve(operator, pressure.ravel()).reshape(pressure.shape)
    return result


def natural_frequency(plate: Plate, density: float, columns: int, rows: int) -> float:
    """Lowest natural frequency in Hz; the error is of second order in the size of the cells.

    density: kg/m^3, 1 to 1e5; that of steel is 7850.
    columns, rows: Cells along x and y, 4 to 2000.
    """
    checked(density=(density, 1, 1e5))
    lowest = eigsh(
        _biharmonic(plate, columns, rows), k=1, sigma=0, which="LM", return_eigenvectors=False
    )
    stiffness_over_mass = plate.stiffness / (density * plate.thickness)
    return float(np.sqrt(lowest[0] * stiffness_over_mass) / (2 * np.pi))

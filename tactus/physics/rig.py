"""The swing on its plate, and the readings of its three sensors (thesis sections 6.2 to 6.4)."""

from dataclasses import dataclass, field

import numpy as np

from golden.input_error import InputError
from golden.numbers.domain import checked
from golden.numbers.real import Real
from tactus.physics import GRAVITY
from tactus.physics.plate import Plate
from tactus.physics.swing import Motion, Swing, foot_forces


@dataclass(frozen=True)
class Rig:
    """A swing in the middle of a plate, with its frames along the plate's length.

    frames: Distance of the two A-frames in m; 0.350 in thesis section 6.2.2.
    offset: Distance in m of sensors 1 and 3, which lie on the line of the feet, from the middle of
        the plate's width; sensor 2 lies in the middle. The value is ours: the thesis has them
        "closely to" the axis, but a sensor on the axis gives the same reading whichever frame
        carries the load, so that no sensor would detect the wobble.
    """

    plate: Plate = field(default_factory=Plate)
    swing: Swing = field(default_factory=Swing)
    frames: float = 0.350
    offset: float = 0.040

    def __post_init__(self) -> None:
        checked(
            feet=(self.swing.feet, 0, self.plate.length),
            frames=(self.frames, 1e-3, self.plate.width),
            offset=(self.offset, -self.plate.width / 2, self.plate.width / 2),
        )

    @property
    def feet(self) -> Real:
        """The places of the four feet, shape (4, 2): side 1 then side 2, each left then right."""
        middle, across = self.plate.length / 2, self.plate.width / 2
        return np.array(
            [
                [middle + side * self.swing.feet / 2, across + frame * self.frames / 2]
                for side in (-1, 1)
                for frame in (-1, 1)
            ]
        )

    @property
    def sensors(self) -> Real:
        """The places of the three sensors, shape (3, 2)."""
        middle, across = self.plate.length / 2, self.plate.width / 2
        half = self.swing.feet / 2
        return np.array(
            [
                [middle - half, across + self.offset],
                [middle, across],
                [middle + half, across + self.offset],
            ]
        )

    def forces(self, motion: Motion, lateral: Real, lateral_acceleration: Real) -> Real:
        """Force of each foot in N, shape (n, 4).

        The force on each side (equations 6.4 and 6.5) is divided equally between its frames, as the
        thesis assumes, apart from the wobble, which is our addition. A mass at x off the middle,
        whose support it accelerates by x'' at the height of the axis, shifts the load to one frame
        by (D a_g x - D x'' height) / frames, half of it on each side.
        """
        swing = self.swing
        tilt = swing.mass * (GRAVITY * lateral - lateral_acceleration * swing.height) / self.frames
        sides = foot_forces(swing, motion.angle, motion.speed)
        forces = np.stack([(n + sign * tilt) / 2 for n in sides for sign in (-1, 1)], axis=-1)
        if forces.min() < 0:
            worst = int(forces.min(axis=1).argmin())
            raise InputError(
                f"foot forces: got {forces.min():.3g} N at {motion.time[worst]:.3g} s, expected 0 "
                "or more; start at a smaller angle or give the frame a weight"
            )
        return forces

    def deflections(self, forces: Real) -> Real:
        """Deflection of the plate above each sensor in m, shape (n, 3), for forces (n, 4)."""
        return np.asarray(forces @ self.plate.influence(self.sensors, self.feet).T)

"""Mass of a body, its centre and its moment of inertia."""

from __future__ import annotations

import numpy as np

from ..core.fields import FARTHEST, ComplexOrArray, FloatOrArray, entry, quantity
from ..core.records import record


@record(checked=True, arrays=True)
class Mass:
    """Mass properties of a rigid body, in the body's own frame.

    Parameters
    ----------
    mass : float or array
        kg; at least 0.
    centre : complex or array
        Centre of mass, mm in the body's frame.
    inertia : float or array
        Moment of inertia about the centre, kg mm2; at least 0.

    Notes
    -----
    The sum of two is that of the rigid body made of both, in the frame that both are stated in. Arrays have the shape
    (linkages,): one value for each of many linkages.

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.Mass(2.0, inertia=50.0) + gk.Mass(1.0, centre=30)
    Mass(mass=3, centre=10+0j, inertia=650)
    """

    mass: FloatOrArray = quantity("mass", "kg", at_least=0, at_most=FARTHEST, example=0.2)
    centre: ComplexOrArray = entry("centre of mass in the body's frame, [x, y] in mm", default=0j, example=20 + 0j)
    inertia: FloatOrArray = quantity(
        "moment of inertia about the centre", "kg mm2", default=0.0, at_least=0, at_most=FARTHEST**2, example=100
    )

    def __add__(self, other: Mass) -> Mass:
        mass = self.mass + other.mass
        share = other.mass / np.where(mass == 0, 1.0, mass)
        apart = other.centre - self.centre
        # Parallel axes: both masses together add mass x other mass / sum x distance squared about the common centre.
        inertia = self.inertia + other.inertia + self.mass * share * np.abs(apart) ** 2
        return Mass(mass, self.centre + share * apart, inertia)

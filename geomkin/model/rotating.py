"""Bodies that turn about a fixed axis in a constant ratio to the driver, by which mechanisms join each other."""

from __future__ import annotations

from fractions import Fraction

from ..core.records import record


@record
class RotatingBody:
    """A body that turns about a fixed axis in a constant ratio to the driver of its mechanism.

    Parameters
    ----------
    axis : complex
        Its axis, mm.
    speed : Fraction
        Its rotations, counterclockwise, for one rotation of the driver; not 0.
    is_wheel : bool, optional
        Whether it looks alike at every angle, apart from teeth and marks, as a gear does.
    """

    axis: complex
    speed: Fraction
    is_wheel: bool = False

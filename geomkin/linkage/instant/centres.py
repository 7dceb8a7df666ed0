"""Instant centres: points at which two bodies of a linkage have the same velocity."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Real, known, unit
from ..joints.slide import Slider
from ..linkage import Linkage
from ..motion import Motion, fastest, is_rounding


@record(checked=True, eq=False)
class InstantCentre:
    """A point that may be at infinity, accurate also near infinity: `reference` + `arm` / `weight`, mm.

    Parameters
    ----------
    reference, arm : array of complex
        mm; a point near the body, and the direction and scaled distance from there.
    weight : array
        0 where the point is at infinity. All arrays are (frames,), nan where there is no such point.

    Notes
    -----
    Derived here: a point in homogeneous coordinates about a point near the body.
    """

    reference: Complex
    arm: Complex
    weight: Real

    @property
    def position(self) -> Complex:
        """Position, mm; nan where at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            position = self.reference + np.divide(self.arm, self.weight)
        return np.where(self.weight != 0, position, complex(np.nan, np.nan))

    @property
    def direction(self) -> Complex:
        """Direction of a point at infinity, unit complex; the opposite direction is the same point.

        For other points, the direction of the line from `reference` to the point; nan if the two coincide.
        """
        return unit(self.arm)


@checked
def instant_centre(motion: Motion, body: str, other: str) -> InstantCentre:
    """The point at which two bodies have the same velocity; at infinity where they turn at the same rate.

    Parameters
    ----------
    motion : Motion
        Motion of the linkage.
    body, other : str
        Names of the two bodies.

    Returns
    -------
    InstantCentre
        Arrays of the motion's shape; nan where the linkage is open and at a dead centre of the driver.

    Raises
    ------
    DesignError
        If the linkage has no such body, or both are the same.

    Notes
    -----
    If a pin or a slider joins the two bodies it is their pin, or at infinity perpendicular to the line.
    Otherwise, with f the velocity of the first body's origin less that of the second body's point there, and w the
    difference of their angular velocities, the centre is at the origin + i f / w. Derived here; Kennedy's theorem, that
    the centres of three bodies are in line, is the test.
    """
    for name in (body, other):
        if name not in motion.bodies:
            raise DesignError("body", f"found {name!r}", f"give one of {', '.join(motion.bodies)}", "unknown-key")
    if body == other:
        raise DesignError("other", f"found {other!r} twice", "give two different bodies", "conflict")
    one, two = motion.bodies[body], motion.bodies[other]
    pin, rail = pin_between(motion.linkage, body, other), slider_between(motion.linkage, body, other)
    if pin is not None:
        reference = one.point(motion.linkage.bodies[body][pin]).position
        arm, weight = np.zeros_like(reference), np.ones_like(reference.real)
    elif rail is not None:
        reference = one.origin.position
        arm, weight = 1j * motion.bodies[rail.along].direction * rail.direction, np.zeros_like(reference.real)
    else:
        reference = one.origin.position
        with np.errstate(invalid="ignore"):  # rates are infinite at a dead centre of the driver
            apart = reference - two.origin.position
            arm = 1j * (one.origin.first - two.origin.first - 1j * two.first * apart)
            weight = one.first - two.first
            rest = is_rounding(abs(arm) + abs(weight) * motion.linkage.size, fastest(motion))
            if np.any(rest):
                # Where both bodies reverse together this is 0 / 0, and the ratio is that of the derivatives.
                rotation = 1j * two.second - two.first**2
                arm_rate = 1j * (one.origin.second - two.origin.second - rotation * apart)
                arm, weight = np.where(rest, arm_rate, arm), np.where(rest, one.second - two.second, weight)
            weight = zero_at_infinity(weight, abs(arm), motion.linkage.size)
    return InstantCentre(*(known(motion.assembled, v) for v in (reference, arm, weight)))


@checked
def instant_centres(motion: Motion) -> Mapping[tuple[str, str], InstantCentre]:
    """All n (n - 1) / 2 instant centres of n bodies.

    Parameters
    ----------
    motion : Motion
        Motion of the linkage.

    Returns
    -------
    mapping of (str, str) to InstantCentre
        By pairs of names in the linkage's order.
    """
    return {(body, other): instant_centre(motion, body, other) for body, other in combinations(motion.bodies, 2)}


def zero_at_infinity(weight: Real, arm: Real, size: Real) -> Real:
    """`weight`, but 0 where a point `arm` / `weight` away, mm, counts as at infinity; arm is a length."""
    return np.where(is_rounding(weight * size, arm), 0.0, weight)


def pin_between(linkage: Linkage, body: str, other: str) -> str | None:
    """Name of the pin that joins two bodies, or None."""
    return next((name for name, joined in linkage.pins.items() if {body, other} <= set(joined)), None)


def slider_between(linkage: Linkage, body: str, other: str) -> Slider | None:
    """The slider that joins two bodies, or None."""
    return next((slider for slider in linkage.sliders if {slider.body, slider.along} == {body, other}), None)

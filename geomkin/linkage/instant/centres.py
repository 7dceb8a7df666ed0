"""Instant centres: where two bodies of a linkage have the same velocity."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from itertools import combinations

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Mask, Real, known, unit
from ..linkage import Linkage, Slider
from ..motion import Motion

# Distance, in sizes of the linkage, from which a centre counts as at infinity. Rates carry 16 digits, so what lies
# farther is rounding. Larger, and a parallelogram's coupler gets a centre; smaller, and true far ones are lost.
FAR = 1e12


@record(checked=True, eq=False)
class InstantCentre:
    """A point that may lie at infinity, without loss of digits near it: `reference` + `arm` / `weight`, mm.

    weight: 0 where the point is at infinity. All (frames,), nan where there is no such point. Derived here: a point in
    homogeneous coordinates about a place near the body.
    """

    reference: Complex
    arm: Complex
    weight: Real

    @property
    def position(self) -> Complex:
        """mm; nan where at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            near = self.reference + np.divide(self.arm, self.weight)
        return np.where(self.weight != 0, near, complex(np.nan, np.nan))

    @property
    def direction(self) -> Complex:
        """Direction in which the point lies where it is at infinity, unit complex; the opposite one is the same point.

        Elsewhere the line through `reference` in this direction leads to the point; nan where the two coincide.
        """
        return unit(self.arm)


@checked
def instant_centre(motion: Motion, body: str, other: str) -> InstantCentre:
    """The point at which two bodies have the same velocity, (frames,); at infinity where they turn alike.

    Where a pin or a slider joins the two it is their pin, or infinity square to the line. Otherwise, with f the
    velocity of the first body's origin less that of the second body's point there, and w the difference of their
    rates of turning, the centre lies at the origin + i f / w. nan where the linkage is open and where the driver
    stands at its own dead centre, where rates are infinite. DesignError for a body that the linkage has not.
    Derived here; Kennedy's theorem, that three bodies' centres lie in line, is the test.
    """
    for name in (body, other):
        if name not in motion.bodies:
            raise DesignError("body", f"found {name!r}", f"give one of {', '.join(motion.bodies)}")
    if body == other:
        raise DesignError("other", f"found {other!r} twice", "give two different bodies")
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
            rest = _at_rest(motion, arm, weight)
            if np.any(rest):
                # Where both bodies turn back together this is 0 / 0, and the derivatives tell the ratio.
                turn = 1j * two.second - two.first**2
                gain = 1j * (one.origin.second - two.origin.second - turn * apart)
                arm, weight = np.where(rest, gain, arm), np.where(rest, one.second - two.second, weight)
            weight = settled(weight, abs(arm), motion.linkage.size)
    return InstantCentre(*(known(motion.assembled, v) for v in (reference, arm, weight)))


@checked
def instant_centres(motion: Motion) -> Mapping[tuple[str, str], InstantCentre]:
    """All n (n - 1) / 2 instant centres of n bodies, by pairs of names in the linkage's order."""
    return {(body, other): instant_centre(motion, body, other) for body, other in combinations(motion.bodies, 2)}


def settled(weight: Real, arm: Real, size: Real) -> Real:
    """`weight`, but 0 where a point `arm` / `weight` away, mm, counts as at infinity; arm is a length."""
    far = np.isfinite(arm) & (abs(weight) * size * FAR <= arm)
    return np.where(far, 0.0, weight)


def _at_rest(motion: Motion, slide: Complex, turn: Real) -> Mask:
    """Whether a relative motion is no more than the rounding of the linkage's liveliest body, (frames,)."""
    extent = motion.linkage.size
    liveliest = reduce(np.maximum, [abs(b.origin.first) + abs(b.first) * extent for b in motion.bodies.values()])
    return np.less_equal((abs(slide) + abs(turn) * extent) * FAR, liveliest)


def pin_between(linkage: Linkage, body: str, other: str) -> str | None:
    """Name of the pin that joins two bodies."""
    return next((name for name, joined in linkage.pins.items() if {body, other} <= set(joined)), None)


def slider_between(linkage: Linkage, body: str, other: str) -> Slider | None:
    """The slider that joins two bodies."""
    return next((slider for slider in linkage.sliders if {slider.body, slider.along} == {body, other}), None)

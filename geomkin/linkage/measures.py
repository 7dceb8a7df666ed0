"""Measures of a linkage: Grashof's inequality, circuits, transmission angle."""

from __future__ import annotations

from fractions import Fraction
from typing import Literal, NamedTuple

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.units import Sentence, mm
from ..model.motor import RotatingBody
from ..plane.vec import Real, Whole, dot
from .drive_limits import largest_between
from .linkage import AbstractLinkage
from .motion import Motion, unwrapped_deg
from .named_linkages import FourBar, SliderCrank


class Grashof(NamedTuple):
    """Grashof's inequality of a four-bar: the shortest link can turn fully if `spare` is not negative.

    Parameters
    ----------
    type : str
        As returned by `grashof_type`.
    shortest, longest : str
        Names of these links.
    shortest_and_longest, other_two : float
        Sums of lengths, mm.
    """

    type: str
    shortest: str
    longest: str
    shortest_and_longest: float
    other_two: float

    @property
    def spare(self) -> float:
        """Sum of the other two links less that of shortest and longest, mm."""
        return self.other_two - self.shortest_and_longest


@checked
def grashof(linkage: FourBar) -> Grashof:
    """Grashof's inequality with its numbers: shortest + longest against the sum of the other two links.

    Parameters
    ----------
    linkage : FourBar
        One four-bar; its lengths are numbers, not arrays.

    Returns
    -------
    Grashof

    Notes
    -----
    Grashof, 1883.

    Examples
    --------
    >>> import geomkin as gk
    >>> result = gk.linkage.grashof(gk.FourBar(ground=100, crank=30, coupler=90, rocker=70))
    >>> result.type, result.spare
    ('crank-rocker', 30.0)
    """
    lengths = {kind: float(getattr(linkage, kind)) for kind in ("ground", "crank", "coupler", "rocker")}
    shortest, *others, longest = sorted(lengths, key=lengths.__getitem__)
    sums = lengths[shortest] + lengths[longest], lengths[others[0]] + lengths[others[1]]
    spare = sums[1] - sums[0]
    types = {"crank": "crank-rocker", "ground": "double-crank", "rocker": "rocker-crank", "coupler": "double-rocker"}
    kind = types[shortest] if spare > 0 else "triple-rocker"
    if abs(spare) <= 1e-12 * lengths[longest]:
        kind = "change-point"
    return Grashof(kind, shortest, longest, *sums)


@checked
def grashof_type(linkage: FourBar) -> str:
    """Type of a four-bar by Grashof's inequality.

    Parameters
    ----------
    linkage : FourBar
        One four-bar.

    Returns
    -------
    str
        "crank-rocker", "double-crank", "rocker-crank", "double-rocker" (the coupler turns fully), "change-point" (the
        sums are equal, to rounding) or "triple-rocker" (no link turns fully).

    Notes
    -----
    Grashof, 1883.
    """
    return grashof(linkage).type


@checked
def circuits(linkage: FourBar | SliderCrank, motion: Motion) -> Whole:
    """Circuit of each frame; poses of one circuit are reached from each other without taking the linkage apart.

    Parameters
    ----------
    linkage : FourBar or SliderCrank
        The linkage.
    motion : Motion
        A motion of this linkage.

    Returns
    -------
    array of int, shape of the motion
        +1 or -1; 0 where open; +1 throughout if there is only one circuit. For a Grashof four-bar it is the sign of the
        angle at a joint not adjacent to the shortest link. For a slider-crank it is the side of the slider if the crank
        turns fully, and the side of the crank if the connecting rod does.

    Raises
    ------
    DesignError
        If the motion is of another linkage.

    Notes
    -----
    Chase and Mirth, Circuits and branches of single-degree-of-freedom planar linkages, Journal of
    Mechanical Design 115, 1993.
    """
    if not _is_of(motion, linkage):
        raise DesignError("motion", "it is of another linkage", "give a motion of this linkage", "conflict")
    if isinstance(linkage, FourBar):
        inequality = grashof(linkage)
        # Shortest link -> a joint that is not adjacent to it.
        joints = {"crank": "rocker_pin", "ground": "rocker_pin", "coupler": "crank_pivot", "rocker": "crank_pin"}
        if inequality.spare <= 0:
            sign = np.ones(motion.assembled.shape)
        else:
            crank, coupler, rocker = (motion.bodies[n].direction for n in ("crank", "coupler", "rocker"))
            ground = motion.bodies["ground"].direction
            pairs = {"rocker_pin": (coupler, rocker), "crank_pivot": (ground, crank), "crank_pin": (crank, coupler)}
            one, two = pairs[joints[inequality.shortest]]
            sign = np.sign(np.imag(np.conj(one) * two))
    elif linkage.crank + np.abs(linkage.offset) < linkage.coupler:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["coupler"].direction))
    elif linkage.coupler + np.abs(linkage.offset) < linkage.crank:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["crank"].direction))
    else:
        sign = np.ones(motion.assembled.shape)
    return np.where(motion.assembled, sign, 0).astype(int)


def _is_of(motion: Motion, linkage: FourBar | SliderCrank) -> bool:
    """Whether a motion is of a linkage with these sizes, at any position and with any driver."""
    moved, given, pins = motion.linkage.bodies, linkage.linkage.bodies, linkage.linkage.pins
    return motion.linkage.pins == pins and all(
        np.array_equal(moved[body][pin], given[body][pin]) for pin, bodies in pins.items() for body in bodies
    )


@checked
def least_transmission_angle(motion: Motion) -> Real:
    """Smallest transmission angle over the frames that are reached; `linkage_checks` also has that between frames.

    Parameters
    ----------
    motion : Motion
        Motion of one or many linkages.

    Returns
    -------
    array, shape () or (linkages,)
        rad; nan if no frame has a transmission angle.

    See Also
    --------
    move, driver_limits, crank_rocker

    Examples
    --------
    >>> import numpy as np
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 361))
    >>> float(np.degrees(gk.least_transmission_angle(motion)).round(1))
    50.0
    """
    least: Real = np.fmin.reduce(np.where(motion.assembled, motion.transmission_angle, np.nan), axis=0)
    return least


# deg. A smaller transmission angle is 0: next to a limit of the driver it changes by the root of a rounding error.
NO_ANGLE_DEG = 1e-5


def transmission_extreme(motion: Motion, sign: Literal[1, -1]) -> tuple[float, float]:
    """Largest (1) or least (-1) transmission angle, deg, also between frames, and the drive there; nan if unknown."""
    (value,), (drive,) = _transmission_extremes(motion, sign)
    return value, drive


def _transmission_extremes(motion: Motion, *signs: Literal[1, -1]) -> tuple[list[float], list[float]]:
    """Largest (1) and least (-1) transmission angles, deg, and the drives there."""
    ways = np.array(signs)

    def both_ways(moved: Motion) -> Real:
        return ways[:, None] * np.degrees(np.where(moved.assembled, moved.transmission_angle, np.nan))

    values, drives = largest_between(motion, both_ways, to_limits=True)
    return np.where(np.abs(values) < NO_ANGLE_DEG, 0.0, ways * values).tolist(), drives.tolist()


# deg. A body that moves through less is at rest, and one that moves through more may turn fully: its ends between
# frames are not known.
AT_REST_DEG, ALL_ROUND_DEG = 1e-6, 350.0


def swings(motion: Motion) -> dict[str, tuple[float, float]]:
    """Least and largest direction, deg from +x, of each body that swings about a fixed pin, also between frames.

    Of the driver, of a body that turns fully, and of a linkage that does not close everywhere there is none.
    """
    linkage, middles = motion.linkage, dict[str, float]()
    fixed = linkage.bodies[linkage.ground].keys() & linkage.pins.keys()
    for name, points in linkage.bodies.items() if motion.assembled.all() else ():
        angles = unwrapped_deg(motion.bodies[name].direction)
        is_follower = name not in (linkage.ground, linkage.driver) and points.keys() & fixed
        if is_follower and AT_REST_DEG < np.ptp(angles) < ALL_ROUND_DEG:
            middles[name] = float(angles.min() + angles.max()) / 2
    if not middles:
        return {}

    def both_ways(moved: Motion) -> Real:
        """Angles from the middles in both senses, deg."""
        apart = [
            np.angle(moved.bodies[name].direction * np.exp(-1j * np.radians(middle)), deg=True)
            for name, middle in middles.items()
        ]
        return np.concatenate([np.negative(apart), apart])

    lower, upper = largest_between(motion, both_ways)[0].reshape(2, -1).tolist()
    return {
        name: (middle - below, middle + above) for (name, middle), below, above in zip(middles.items(), lower, upper)
    }


# Largest number of bodies whose lengths are listed.
MOST_LISTED = 12


def motion_quantities(linkage: AbstractLinkage, motion: Motion) -> dict[str, str]:
    """Grashof type, distances between the pins of each body, mm, and range of the transmission angle, by label."""
    general = motion.linkage
    listed = {"Grashof type": grashof_type(linkage)} if isinstance(linkage, FourBar) else {}
    for body, points in list(general.bodies.items())[:MOST_LISTED]:
        pins = [complex(z) for name, z in points.items() if name in general.pins]
        pairs = zip(pins, [*pins[1:], pins[0]]) if len(pins) > 2 else [tuple(pins)] * (len(pins) == 2)
        if lengths := [abs(b - a) for a, b in pairs]:
            listed[body.replace("_", " ")] = Sentence(f"{mm(*lengths):.5g}")
    (least, largest), _ = _transmission_extremes(motion, -1, 1)
    if np.isfinite(least):
        listed["transmission angle"] = f"{least:.4g} to {largest:.4g} deg"
    return listed


# Difference of directions, as unit numbers, below which two bodies turn alike.
ALIKE = 1e-9


def steady_bodies(motion: Motion) -> dict[str, RotatingBody]:
    """The driver of a linkage, which turns on the ground, and the bodies on fixed pins that turn as it does.

    The motion covers one turn of the driver without gaps. A linkage has no other ratio than 1 over the whole turn,
    apart from that of a body at rest.
    """
    linkage = motion.linkage
    driver = motion.bodies[linkage.driver].direction
    names = [linkage.driver, *(name for name in linkage.bodies if name not in (linkage.driver, linkage.ground))]
    bodies = {}
    for name in names:
        pin = next((pin for pin in linkage.bodies[name] if pin in linkage.bodies[linkage.ground]), None)
        angle = motion.bodies[name].direction * np.conj(driver)
        if pin is not None and np.abs(angle - angle[0]).max() <= ALIKE:
            bodies[name] = RotatingBody(complex(motion.point(pin).position[0]), Fraction(1))
    return bodies

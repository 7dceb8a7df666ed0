"""Cognates: the three four-bars of a coupler curve, after Roberts and Chebyshev, and Roberts' figure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Literal

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from ..core.units import mm
from ..plane.vec import Complex, cross, direction_deg
from .linkage import Linkage
from .moving import move
from .named_linkages import FourBar
from .solve.branch import Branch

Link = Literal["crank", "coupler", "rocker"]

# Distance of the coupler point from a pin, as a share of the coupler, below which a cognate counts as shrunk to
# a point.
AT_PIN = 1e-12

# Links that turn together. P = A + w AB is the coupler point as a ratio w of the coupler AB. With a e1, b e3, c e4 and
# d e0 the links crank, coupler, rocker and ground as vectors, a e1 + b e3 = d e0 + c e4, and parallelograms on both
# sides of P make, about the third pivot O_A + w d e0:
#     left   w b e3       + w a e1       = w d e0       + w c e4         from the crank pivot to the third
#     right  (1-w) a e1   + (w-1) c e4   = (1-w) d e0   + (w-1) b e3     from the third to the rocker pivot
LEFT: Mapping[Link, Link] = MappingProxyType({"crank": "coupler", "coupler": "crank", "rocker": "rocker"})
RIGHT: Mapping[Link, Link] = MappingProxyType({"crank": "crank", "coupler": "rocker", "rocker": "coupler"})


@record
class Cognate:
    """One of the three four-bars of a coupler curve.

    Move `linkage` at the drive of the given linkage plus `drive_offset`, on the branch of the given linkage times
    `branch`: then both coupler points coincide at every frame.

    Parameters
    ----------
    linkage : FourBar
        The cognate.
    drive_offset : float
        rad.
    branch : {+1, -1}
        Factor of the branch.
    turns_with : mapping of str to str
        For each of its links, the link of the given linkage to which its angle is constant.
    """

    linkage: FourBar
    drive_offset: float
    branch: int
    turns_with: Mapping[Link, Link]


@checked
def cognates(four_bar: FourBar) -> tuple[Cognate, Cognate, Cognate]:
    """The given four-bar and its two cognates: three linkages whose coupler points trace the same curve.

    Parameters
    ----------
    four_bar : FourBar
        One four-bar with its coupler point.

    Returns
    -------
    tuple of three Cognate
        The given four-bar; the cognate between crank pivot and third pivot; the cognate between third pivot and rocker
        pivot. Each is driven by the link that turns with the given linkage's driver, which need not be its crank.

    Raises
    ------
    DesignError
        If the coupler point is at a pin, where one cognate shrinks to a point.

    Notes
    -----
    Roberts, On three-bar motion in plane space, Proc. London Math. Soc. 7, 1875; Chebyshev 1878. Drivers
    and branches are derived here.
    """
    given, w = four_bar, _ratio(four_bar)
    same = MappingProxyType({link: link for link in LEFT})
    # Rotated and scaled, never mirrored: the branch changes its sign only if the two links of the dyad are exchanged.
    left = Cognate(_left(given, w), 0.0, -1 if given.driver == "rocker" else 1, LEFT)
    # Coupler and rocker of the right cognate point against the links they turn with: their factor is w - 1, not 1 - w.
    half_turn = 0.0 if given.driver == "crank" else np.pi
    right = Cognate(_right(given, w), half_turn, -1 if given.driver == "crank" else 1, RIGHT)
    return Cognate(given, 0.0, 1, same), left, right


@checked
def third_pivot(four_bar: FourBar) -> complex:
    """The fixed pivot that the two cognates share: it forms with the other two pivots the coupler's triangle.

    Parameters
    ----------
    four_bar : FourBar
        One four-bar with its coupler point.

    Returns
    -------
    complex
        mm.

    Notes
    -----
    Roberts 1875, as for `cognates`.
    """
    ground = four_bar.ground * direction_deg(four_bar.ground_angle_deg)
    return complex(four_bar.origin + four_bar.coupler_point / four_bar.coupler * ground)


# The bodies of Roberts' figure by their points, the frame's origin first and a point on its x axis second.
ROBERTS_BODIES = {
    "ground": ("crank_pivot", "rocker_pivot"),
    "crank": ("crank_pivot", "crank_pin"),
    "coupler": ("crank_pin", "rocker_pin", "coupler_point"),
    "rocker": ("rocker_pivot", "rocker_pin"),
    "left_crank": ("crank_pivot", "left_pin"),
    "left_coupler": ("left_pin", "left_rocker_pin", "coupler_point"),
    "left_rocker": ("third_pivot", "left_rocker_pin"),
    "right_crank": ("third_pivot", "right_crank_pin"),
    "right_coupler": ("right_crank_pin", "right_pin", "coupler_point"),
    "right_rocker": ("rocker_pivot", "right_pin"),
}
# The dyad that the driver moves, by driver: two bodies, and their first, common and last point.
ROBERTS_FIRST_DYAD = {
    "crank": ("coupler", "rocker", ("crank_pin", "rocker_pin", "rocker_pivot")),
    "coupler": ("crank", "rocker", ("crank_pivot", "crank_pin", "driver_back")),
    "rocker": ("crank", "coupler", ("crank_pivot", "crank_pin", "rocker_pin")),
}
# The other dyads, in order.
ROBERTS_DYADS = (
    ("left_crank", "left_coupler", ("crank_pivot", "left_pin", "coupler_point")),
    ("right_coupler", "right_rocker", ("coupler_point", "right_pin", "rocker_pivot")),
    ("left_rocker", "right_crank", ("left_rocker_pin", "third_pivot", "right_crank_pin")),
)


@checked
def roberts_linkage(four_bar: FourBar, start: float = 0.0, branch: Branch = 1) -> Linkage:
    """Roberts' figure: the three cognates as one linkage of ten bars, joined at the coupler point.

    Its bodies are crank, coupler, rocker; left_crank, left_coupler, left_rocker; right_crank, right_coupler,
    right_rocker; its new pins left_pin, left_rocker_pin, right_crank_pin, right_pin, third_pivot. The third pivot is a
    pin of two links and not of the ground: that it does not move is Roberts' theorem (pinned to the ground too, the
    linkage would count as over-constrained). The parallelograms pass change points: move it with branch "follow" from
    the drive `start`.

    Parameters
    ----------
    four_bar : FourBar
        One four-bar with its coupler point.
    start : float
        First drive, rad.
    branch : {+1, -1, "follow"}, mapping or Continuation
        Branch of the given four-bar at `start`.

    Returns
    -------
    Linkage

    Raises
    ------
    DesignError
        As for `cognates`, or if the four-bar is open at `start`.

    Notes
    -----
    The figure: Roberts 1875; that it runs through change points is derived here.
    """
    point = _roberts_points(four_bar, start, branch)
    order = ["ground", four_bar.driver]
    for one, two, (first, joint, last) in (ROBERTS_FIRST_DYAD[four_bar.driver], *ROBERTS_DYADS):
        # "follow" starts with every joint on the left of its dyad, from the body that comes first.
        on_left = cross(point[last] - point[first], point[joint] - point[first]) >= 0
        order += [one, two] if on_left else [two, one]

    def local(body: str) -> dict[str, complex | Complex]:
        origin, on_x_axis = (point[name] for name in ROBERTS_BODIES[body][:2])
        x_axis = (on_x_axis - origin) / abs(complex(on_x_axis - origin))
        return {name: (point[name] - origin) * x_axis.conjugate() for name in ROBERTS_BODIES[body]}

    return Linkage(
        bodies={body: local(body) for body in order},
        driver=four_bar.driver,
        origin=four_bar.origin,
        ground_angle_deg=four_bar.ground_angle_deg,
    )


def _roberts_points(four_bar: FourBar, start: float, branch: Branch) -> dict[str, complex | Complex]:
    """The points of Roberts' figure at a drive, in the frame of the ground link."""
    a, b, c, d = four_bar.crank, four_bar.coupler, four_bar.rocker, four_bar.ground
    w = _ratio(four_bar)
    motion = move(replace(four_bar, origin=0j, ground_angle_deg=0.0), [start], branch)
    if not motion.assembled[0]:
        problem = f"found {start:g} rad, where the linkage is open"
        raise DesignError("start", problem, "give a drive that it reaches", "does-not-assemble")
    e1, e3, e4 = (complex(motion.bodies[link].direction[0]) for link in ("crank", "coupler", "rocker"))
    point = {
        "crank_pivot": 0j,
        "rocker_pivot": d + 0j,
        "third_pivot": w * d,
        "crank_pin": a * e1,
        "rocker_pin": d + c * e4,
        "coupler_point": a * e1 + w * b * e3,
        "left_pin": w * b * e3,
        "left_rocker_pin": w * b * e3 + w * a * e1,
        "right_pin": d + (w - 1) * b * e3,
        "right_crank_pin": w * d + (1 - w) * a * e1,
    }
    # If the coupler drives, crank and rocker close as a dyad whose second pivot is moved back by the coupler.
    back = point["rocker_pivot"] - (point["rocker_pin"] - point["crank_pin"])
    return point | {"driver_back": back}


def _ratio(four_bar: FourBar) -> complex:
    w = complex(four_bar.coupler_point / four_bar.coupler)
    for distance, pin in ((abs(w), "crank"), (abs(w - 1), "rocker")):
        if distance <= AT_PIN:
            given = mm(four_bar.coupler_point.real, four_bar.coupler_point.imag)
            raise DesignError(
                "coupler_point",
                f"found ({given:g}), at the {pin} pin, where one cognate shrinks to a point",
                "give a point away from both pins: at a pin the coupler curve is an arc, which a single link traces",
            )
    return w


def _left(given: FourBar, w: complex) -> FourBar:
    size = abs(w)
    return replace(
        given,
        ground=size * given.ground,
        crank=size * given.coupler,
        coupler=size * given.crank,
        rocker=size * given.rocker,
        coupler_point=size * given.crank / w,
        driver=LEFT[given.driver],
        ground_angle_deg=_turned(given, w),
    )


def _right(given: FourBar, w: complex) -> FourBar:
    size = abs(1 - w)
    return replace(
        given,
        ground=size * given.ground,
        crank=size * given.crank,
        coupler=size * given.rocker,
        rocker=size * given.coupler,
        coupler_point=size * given.rocker * w / (w - 1),
        driver=RIGHT[given.driver],
        origin=third_pivot(given),
        ground_angle_deg=_turned(given, 1 - w),
    )


def _turned(given: FourBar, by: complex) -> float:
    """Angle of the ground line rotated by a ratio, deg, within half a turn."""
    return float(np.degrees(np.angle(direction_deg(given.ground_angle_deg) * by)))

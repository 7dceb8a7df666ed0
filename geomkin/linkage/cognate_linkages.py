"""Cognates: the three four-bars that trace one coupler curve (Roberts and Chebyshev)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np

from ..arguments import checked
from ..brief import one_line
from ..errors import DesignError
from ..plane.vec import Complex, cross, direction_deg
from .bars import FourBar
from .linkage import Linkage
from .solve.branch import Branch
from .solve.move import move

Link = Literal["crank", "coupler", "rocker"]

# Distance of the coupler point from a pin, as a share of the coupler, below which a cognate counts as shrunk to
# a point. Smaller takes the rounding of a pin's own place for a linkage; larger refuses a tiny but real one.
AT_PIN = 1e-12

# What turns with what. P = A + w AB is the coupler point as a ratio w of the coupler AB. With a e1, b e3, c e4 and
# d e0 the links crank, coupler, rocker and ground as vectors, a e1 + b e3 = d e0 + c e4, and parallelograms on both
# sides of P make, about the third pivot O_A + w d e0:
#     left   w b e3       + w a e1       = w d e0       + w c e4         from the crank pivot to the third
#     right  (1-w) a e1   + (w-1) c e4   = (1-w) d e0   + (w-1) b e3     from the third to the rocker pivot
LEFT: Mapping[Link, Link] = MappingProxyType({"crank": "coupler", "coupler": "crank", "rocker": "rocker"})
RIGHT: Mapping[Link, Link] = MappingProxyType({"crank": "crank", "coupler": "rocker", "rocker": "coupler"})


@dataclass(frozen=True)
class Cognate:
    """One of the three four-bars of a coupler curve, and how it moves to be at the same point at the same moment.

    Move `linkage` at the given linkage's drive plus `drive_offset`, rad, on the given branch times `branch`.
    turns_with: for each of its links, the link of the given linkage that it keeps its angle to.
    """

    linkage: FourBar
    drive_offset: float
    branch: int
    turns_with: Mapping[Link, Link]

    __repr__ = one_line


@checked
def cognates(four_bar: FourBar) -> tuple[Cognate, Cognate, Cognate]:
    """The given four-bar and its two cognates: three linkages whose coupler points trace one curve.

    The second stands on the crank pivot and the third pivot, the third on the third pivot and the rocker
    pivot. Each is driven by the link that turns with the given linkage's driver, which need not be its crank.
    A coupler point on the line of the coupler is an ordinary case; at a pin one cognate shrinks to that pin's
    pivot, which is a DesignError. Roberts, On three-bar motion in plane space, Proc. London Math. Soc. 7, 1875;
    Chebyshev 1878. Drivers and branches are derived here.
    """
    given, w = four_bar, _ratio(four_bar)
    same = MappingProxyType({link: link for link in LEFT})
    # Turned and scaled, never mirrored: the branch's sign changes only where the two links of the dyad change places.
    left = Cognate(_left(given, w), 0.0, -1 if given.driver == "rocker" else 1, LEFT)
    # Coupler and rocker of the right one point against the links that they turn with: they have w - 1, not 1 - w.
    half_turn = 0.0 if given.driver == "crank" else np.pi
    right = Cognate(_right(given, w), half_turn, -1 if given.driver == "crank" else 1, RIGHT)
    return Cognate(given, 0.0, 1, same), left, right


@checked
def third_pivot(four_bar: FourBar) -> complex:
    """The fixed point, mm, at which the two cognates meet: it makes with the pivots the coupler's triangle.

    Roberts 1875, as in `cognates`.
    """
    ground = four_bar.ground * direction_deg(four_bar.ground_angle_deg)
    return complex(four_bar.origin + four_bar.coupler_point / four_bar.coupler * ground)


@checked
def roberts_linkage(four_bar: FourBar, start: float = 0.0, branch: Branch = 1) -> Linkage:
    """Roberts' figure: the three cognates as one linkage of ten bars, joined at the coupler point.

    Their third pivot is a pin of two links and not of the ground: that it stays put is Roberts' theorem (pinned
    to the ground too, the linkage counts as rigid). Bodies crank, coupler, rocker; left_crank, left_coupler,
    left_rocker; right_crank, right_coupler, right_rocker; new pins left_pin, left_rocker_pin, right_crank_pin,
    right_pin, third_pivot. Its parallelograms pass change points: move it with branch "follow" from the
    drive `start`, rad, where the given linkage stands on `branch`. DesignError as for `cognates`, and where the
    linkage is open at `start`. The figure: Roberts 1875; that it runs through change points is derived here.
    """
    a, b, c, d = four_bar.crank, four_bar.coupler, four_bar.rocker, four_bar.ground
    w = _ratio(four_bar)
    motion = move(replace(four_bar, origin=0j, ground_angle_deg=0.0), [start], branch)
    if not motion.closed[0]:
        raise DesignError("start", f"found {start:g} rad, where the linkage is open", "give a drive that it reaches")
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
    # Each body's points, the frame's origin first and a point on its x axis second.
    made_of = {
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
    # Where the coupler drives, crank and rocker close as a dyad whose second pivot is set back by the coupler.
    back = point["rocker_pivot"] - (point["rocker_pin"] - point["crank_pin"])
    point |= {"driver_back": back}
    own = {
        "crank": ("coupler", "rocker", ("crank_pin", "rocker_pin", "rocker_pivot")),
        "coupler": ("crank", "rocker", ("crank_pivot", "crank_pin", "driver_back")),
        "rocker": ("crank", "coupler", ("crank_pivot", "crank_pin", "rocker_pin")),
    }
    dyads = [
        own[four_bar.driver],
        ("left_crank", "left_coupler", ("crank_pivot", "left_pin", "coupler_point")),
        ("right_coupler", "right_rocker", ("coupler_point", "right_pin", "rocker_pivot")),
        ("left_rocker", "right_crank", ("left_rocker_pin", "third_pivot", "right_crank_pin")),
    ]
    order = ["ground", four_bar.driver]
    for one, two, (first, joint, last) in dyads:
        # "follow" starts with every joint on the left of its dyad, seen from the body named first.
        on_left = cross(point[last] - point[first], point[joint] - point[first]) >= 0
        order += [one, two] if on_left else [two, one]

    def local(body: str) -> dict[str, complex | Complex]:
        origin, ahead = (point[name] for name in made_of[body][:2])
        x_axis = (ahead - origin) / abs(complex(ahead - origin))
        return {name: (point[name] - origin) * x_axis.conjugate() for name in made_of[body]}

    return Linkage(
        bodies={body: local(body) for body in order},
        driver=four_bar.driver,
        origin=four_bar.origin,
        ground_angle_deg=four_bar.ground_angle_deg,
    )


def _ratio(four_bar: FourBar) -> complex:
    w = complex(four_bar.coupler_point / four_bar.coupler)
    for distance, pin in ((abs(w), "crank"), (abs(w - 1), "rocker")):
        if distance <= AT_PIN:
            raise DesignError(
                "coupler_point",
                f"found {four_bar.coupler_point:g} mm, at the {pin} pin, where one cognate shrinks to a point",
                "give a point away from both pins: at a pin the coupler curve is an arc, which the one link traces",
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
    """Angle of the ground line turned by a ratio, deg, within half a turn."""
    return float(np.degrees(np.angle(direction_deg(given.ground_angle_deg) * by)))

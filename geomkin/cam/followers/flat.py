"""Followers with a flat face, translating and oscillating."""

from __future__ import annotations

from dataclasses import replace
from math import fsum
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity
from ...core.records import record
from ...plane.primitives import Segment
from ...plane.vec import Complex, Pose, Real, dot
from ..program.laws import highest, largest
from ..program.program import FollowerMotion, Program
from .follower import (
    CORNER,
    AbstractFollower,
    Bars,
    Contact,
    ContactRate,
    FollowerPlate,
    Hole,
    Side,
    arm_direction,
    check_reach,
    faced_arm,
    guide_holes,
    side_sign,
    stemmed_face,
    with_rounded_corners,
)


class AbstractFace(AbstractFollower):
    """Base class of followers that touch the cam with a flat face. Such a cam must be convex everywhere.

    Notes
    -----
    Rothbart, Cams (1956), flat-faced followers.
    """

    roller_radius = 0.0
    knife_edge = None

    def outer_radius_bound(self, motion: FollowerMotion, base_radius: float, sense: int) -> Real:
        # The distance from the axis to the line of the face.
        contact = self.contact(motion, base_radius, sense)
        return dot(contact.normal, contact.point)

    def surface_between(self, pose: Pose, start: complex, end: complex) -> Segment:
        return Segment(start, end)

    def convex_radius(self, program: Program, base_radius: float, sense: int) -> tuple[Real, Real]:
        def below(angle: Real) -> Real:
            contact = self.contact(program.motion(angle), base_radius, sense)
            return -contact.profile_speed / np.abs(contact.normal_rate)

        radius, at = highest(program.breaks, below)
        return -radius, at

    def undercut_violation(self, motion: FollowerMotion, base_radius: float, sense: int, least_radius: float) -> Real:
        contact = self.contact(motion, base_radius, sense)
        return least_radius * np.abs(contact.normal_rate) - contact.profile_speed

    def contact_travel(self, program: Program, base_radius: float, sense: int) -> tuple[float, float]:
        def along(angle: Real) -> Real:
            motion = program.motion(angle)
            contact = self.contact(motion, base_radius, sense)
            return np.real(self.pose(motion.lift, base_radius).locate(contact.point))

        return -largest(program.breaks, lambda t: -along(t))[0], largest(program.breaks, along)[0]

    def face(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[float, float]:
        """Range of the face that is cut, mm along its x axis: the contact range with the overhang on both sides."""
        low, high = self.contact_travel(program, base_radius, sense)
        return low - bars.overhang, high + bars.overhang


def on_face(
    normal: Complex, distance: tuple[Real, Real, Real], normal_rate: tuple[Real, Real], pressure_angle: Real, sense: int
) -> Contact:
    """Contact of a flat face.

    distance: p, mm, from the cam's axis to the face, and its derivatives by cam angle. normal_rate: rate of the
    normal's angle phi in the cam's frame, and its derivative. The cam's support function is p(phi), so the contact is
    n (p + i dp/dphi) and the radius of curvature p + d2p/dphi2. Derived here, from the support function of a convex
    curve.
    """
    p, p1, p2 = distance
    rate, rate1 = normal_rate
    along = p1 / rate
    radius = p + (p2 - along * rate1) / rate**2
    return Contact(normal * (p + 1j * along), normal, rate, -sense * rate * radius, pressure_angle)


@record(checked=True)
class TranslatingFlat(AbstractFace):
    """A flat face that moves along y. At lift 0 it touches the base circle.

    Parameters
    ----------
    tilt_deg : float, optional
        Angle of the face from the x axis, counterclockwise, between -90 and 90 deg.

    See Also
    --------
    Cam, TranslatingRoller, OscillatingFlat

    Notes
    -----
    The pressure angle equals the tilt at every cam angle. Rothbart, Cams (1956), flat-faced follower; the tilted face
    is derived here.
    """

    tilt_deg: float = quantity(
        "angle of the face from the x axis, counterclockwise", "deg", default=0.0, above=-90, below=90
    )
    kind: Literal["translating-flat"] = "translating-flat"
    oscillates = False

    @property
    def tilt(self) -> float:
        """Angle of the face from the x axis, rad."""
        return float(np.radians(self.tilt_deg))

    @property
    def size(self) -> float:
        return 0.0

    def check(self, program: Program, base_radius: float, sense: int) -> None:
        """Accept every cam: a translating face reaches all of them."""

    def base_radius_range(self, largest_lift: float) -> tuple[float, float]:
        return 0.0, np.inf

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """p = Rb + s cos(tilt). The normal is constant; the pressure angle is the tilt times the cam's sense."""
        cosine = np.cos(self.tilt)
        lift, zero = base_radius + cosine * motion.lift, 0 * motion.lift
        distance = lift, cosine * motion.velocity, cosine * motion.acceleration
        normal = 1j * np.exp(1j * self.tilt) + zero
        return on_face(normal, distance, (zero - sense, zero), zero + sense * self.tilt, sense)

    def contact_rates(self, motion: FollowerMotion, base_radius: float, sense: int) -> dict[str, ContactRate]:
        contact, still = self.contact(motion, base_radius, sense), 0 * motion.lift
        sine = np.sin(self.tilt)
        by_tilt = 1j * contact.point - sine * contact.normal * (motion.lift - 1j * sense * motion.velocity)
        return {"base_radius": (contact.normal, still), "tilt_deg": (by_tilt, still + sense)}

    def pose(self, lift: Real, base_radius: float) -> Pose:
        """The origin is the point where the face crosses the y axis; the x axis runs along the face."""
        origin = 1j * (base_radius / np.cos(self.tilt) + lift)
        return Pose(origin, np.full(np.shape(lift), np.exp(1j * self.tilt)))

    def resting_lift(self, points: Complex, base_radius: float) -> Real:
        return np.asarray((np.imag(points * np.exp(-1j * self.tilt)) - base_radius) / np.cos(self.tilt))

    def least_base_radius(self, program: Program, least_radius: float) -> float:
        """The radius of curvature is rho = Rb + (s + s'') cos(tilt), so Rb = least_radius - min(s + s'') cos(tilt)."""

        def below(angle: Real) -> Real:
            motion = program.motion(angle)
            return -motion.lift - motion.acceleration

        return least_radius + float(np.cos(self.tilt)) * largest(program.breaks, below)[0]

    def plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """One plate: the face with its stem."""
        face, width = self.face(bars, program, base_radius, sense), bars.bar_width
        outline, end = stemmed_face(face, self.tilt, width, bars.stem_length)
        hole = Hole("pivot_bore", bars.pivot_bore, width, end)
        # The corners of a face lie outside its contact range.
        return (FollowerPlate("follower", with_rounded_corners(outline, min(CORNER, bars.overhang)), (hole,)),)

    def guided_plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """The same plate with a second hole in the stem."""
        (follower,) = self.plates(bars, program, base_radius, sense)
        return (replace(follower, holes=guide_holes(bars, 1j * np.exp(-1j * self.tilt))),)


@record(checked=True)
class OscillatingFlat(AbstractFace):
    """A flat face on an arm that swings about a pivot at (pivot_distance, 0).

    Parameters
    ----------
    pivot_distance : float
        Distance of the pivot from the cam axis, along +x, mm, above 0.
    face_offset : float, optional
        Distance of the face from the pivot, mm, positive if the pivot is on the cam's side of the face.
    side : {"above", "below"}, optional
        Side of the line from cam axis to pivot on which the face is.

    See Also
    --------
    Cam, OscillatingRoller, TranslatingFlat

    Notes
    -----
    The angle at the pivot between the line to the cam's axis and the face is psi = asin((Rb - f) / c) + lift, with
    base radius Rb, pivot distance c and face offset f. Rothbart, Cams (1956), oscillating flat-faced follower; the
    formulas are derived here.
    """

    pivot_distance: float = quantity(
        "distance of the arm's pivot from the cam axis, along +x", "mm", above=0, at_most=FARTHEST, example=100
    )
    face_offset: float = quantity(
        "distance of the face from the pivot, positive if the pivot is on the cam's side of the face", "mm",
        default=0.0, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    side: Side = entry("side of the line from cam axis to pivot on which the face is", default="above")
    kind: Literal["oscillating-flat"] = "oscillating-flat"
    oscillates = True
    # A smaller cam is undercut.
    example_base_radius: ClassVar[float] = 60.0

    @property
    def size(self) -> float:
        return max(self.pivot_distance, abs(self.face_offset))

    def check(self, program: Program, base_radius: float, sense: int) -> None:
        """Require that the face reaches the cam, and that it never swings as fast as the cam turns."""
        check_reach(self, program, base_radius, "face", "pivot_distance", "face_offset")
        tau = side_sign(self.side)
        slowest, angle = largest(program.breaks, lambda t: -sense * tau * program.motion(t).velocity)
        if slowest >= 1:
            raise DesignError(
                "program",
                f"at {np.degrees(angle):.4g} deg the face turns with the cam and {slowest:.4g} times as fast; "
                "no profile can produce that motion",
                "give a longer segment or a smaller lift there",
            )

    def base_radius_range(self, largest_lift: float) -> tuple[float, float]:
        c, f = self.pivot_distance, self.face_offset
        # At psi = -90 and 90 deg the face is perpendicular to the line of the two axes and the contact is at the pivot.
        return max(0.0, f - c), max(0.0, f + c * float(np.cos(np.clip(largest_lift, 0, np.pi))))

    def start_angle(self, base_radius: float) -> float:
        """psi at lift 0, rad."""
        c, up = self.pivot_distance, (base_radius, -self.face_offset)
        # By the tangent and exact sums: near 90 deg the sine alone has only half of the digits.
        down = -base_radius, self.face_offset
        return float(np.arctan2(fsum(up), np.sqrt(fsum((c, *up)) * fsum((c, *down)))))

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """p = c sin(psi) + f; the contact is at c cos(psi) / (1 + sense tau s') along the face."""
        tau, c = side_sign(self.side), self.pivot_distance
        psi = self.start_angle(base_radius) + motion.lift
        sine, cosine = c * np.sin(psi), c * np.cos(psi)
        v, a = motion.velocity, motion.acceleration
        distance = sine + self.face_offset, cosine * v, cosine * a - sine * v**2
        zero = 0 * psi
        normal_rate = -sense - tau * v + zero, -tau * a + zero
        along = cosine / (1 + sense * tau * v)
        pressure_angle = np.arctan2(self.face_offset + zero, along)
        return on_face(-1j * tau * arm_direction(psi, tau), distance, normal_rate, pressure_angle, sense)

    def contact_rates(self, motion: FollowerMotion, base_radius: float, sense: int) -> dict[str, ContactRate]:
        """psi changes as c sin(psi) = Rb - f at lift 0; the face turns by -tau for 1 of psi."""
        tau, c, f = side_sign(self.side), self.pivot_distance, self.face_offset
        contact, start = self.contact(motion, base_radius, sense), self.start_angle(base_radius)
        psi, slower = start + motion.lift, 1 + sense * tau * motion.velocity
        sine, cosine, along = np.sin(psi), np.cos(psi), c * np.cos(psi) / slower
        rates: dict[str, ContactRate] = {}
        # By each size: c sin(psi) at lift 0, c, and f.
        for name, (up, longer, offset) in {
            "base_radius": (1.0, 0.0, 0.0),
            "pivot_distance": (-np.sin(start), 1.0, 0.0),
            "face_offset": (-1.0, 0.0, 1.0),
        }.items():
            turned = up / (c * np.cos(start))
            distance, on_line = c * cosine * turned + sine * longer + offset, longer * cosine - c * sine * turned
            shift = distance - 1j * sense * motion.velocity / slower * on_line
            pressure = (along * offset - f * on_line / slower) / (along**2 + f**2)
            rates[name] = contact.normal * shift - 1j * tau * turned * contact.point, pressure
        return rates

    def pose(self, lift: Real, base_radius: float) -> Pose:
        """The origin is the pivot; the x axis runs along the face towards the cam."""
        direction = arm_direction(self.start_angle(base_radius) + lift, side_sign(self.side))
        return Pose(np.full(np.shape(lift), complex(self.pivot_distance)), direction)

    def resting_lift(self, points: Complex, base_radius: float) -> Real:
        from_pivot = points - self.pivot_distance
        with np.errstate(invalid="ignore"):
            along = np.sqrt(np.abs(from_pivot) ** 2 - self.face_offset**2)
        psi = -side_sign(self.side) * np.angle(-from_pivot) - np.arctan2(self.face_offset, along)
        return np.where(np.isfinite(along), psi - self.start_angle(base_radius), -np.inf)

    def plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """One plate: the arm about its pivot, with the face."""
        face, width = self.face(bars, program, base_radius, sense), bars.bar_width
        outline = faced_arm(face, self.face_offset, width, side_sign(self.side))
        hole = Hole("pivot_bore", bars.pivot_bore, width)
        # The corners of a face lie outside its contact range.
        return (FollowerPlate("arm", with_rounded_corners(outline, min(CORNER, bars.overhang)), (hole,)),)

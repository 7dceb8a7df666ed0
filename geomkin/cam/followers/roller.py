"""Roller followers, translating and oscillating."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from math import fsum, prod
from typing import Literal, Self

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, inside, quantity
from ...core.records import record
from ...core.units import mm
from ...plane.primitives import Arc, Circle, rounded_hull
from ...plane.vec import Complex, Pose, Real, cross
from ..program.laws import highest
from ..program.program import FollowerMotion, Program
from .follower import (
    AbstractFollower,
    Bars,
    Contact,
    ContactRate,
    FollowerPlate,
    Hole,
    Side,
    arm_direction,
    check_reach,
    guide_holes,
    side_sign,
)

# Derivatives by a size of a roller's centre, of its velocity by cam angle, and of the direction of its path, rad.
CentreRate = tuple[Complex, Complex, Real]


@record
class AbstractRoller(AbstractFollower):
    """Base class of followers that touch the cam with a roller or a knife edge.

    Parameters
    ----------
    roller_radius : float
        Radius of the roller, mm; 0 for a knife edge.

    Notes
    -----
    The profile is parallel to the pitch curve, the path of the roller's centre on the cam, at the distance of the
    roller's radius: Rothbart, Cams (1956), pitch curve and cam profile.
    """

    roller_radius: float = quantity("radius of the roller", "mm", at_least=0, at_most=FARTHEST, example=10)

    @property
    @abstractmethod
    def centre(self) -> complex:
        """The roller's centre in the follower's frame, mm."""

    @property
    def knife_edge(self) -> Self:
        return replace(self, roller_radius=0.0)

    def centre_rates(self, motion: FollowerMotion, base_radius: float) -> dict[str, CentreRate]:
        """Derivatives of the roller's centre by each size, by field name."""
        return {}

    def contact_rates(self, motion: FollowerMotion, base_radius: float, sense: int) -> dict[str, ContactRate]:
        contact = self.contact(motion, base_radius, sense)
        speed = contact.profile_speed - sense * self.roller_radius * contact.normal_rate
        rates: dict[str, ContactRate] = {}
        for name, (centre, velocity, path_angle) in self.centre_rates(motion, base_radius).items():
            # In `on_roller` u is -i sense |u| n, and n turns as u does.
            turned = ((velocity - 1j * sense * centre) / (-1j * sense * speed * contact.normal)).imag
            point = centre - 1j * self.roller_radius * contact.normal * turned
            point = point - contact.normal if name == "roller_radius" else point
            rates[name] = point, self.pressure_sign(sense) * (turned - path_angle)
        return rates

    def pressure_sign(self, sense: int) -> int:
        """Sign of the pressure angle for a normal that is turned counterclockwise from the path."""
        return sense

    def outer_radius_bound(self, motion: FollowerMotion, base_radius: float, sense: int) -> Real:
        return np.abs(self.knife_edge.contact(motion, base_radius + self.roller_radius, sense).point)

    def surface_between(self, pose: Pose, start: complex, end: complex) -> Arc:
        centre = complex(pose.place(self.centre))
        return Arc(centre, start, float(np.angle((end - centre) / (start - centre))))

    def convex_radius(self, program: Program, base_radius: float, sense: int) -> tuple[Real, Real]:
        knife, prime_radius = self.knife_edge, base_radius + self.roller_radius

        def curvature(angle: Real) -> Real:
            contact = knife.contact(program.motion(angle), prime_radius, sense)
            return -sense * contact.normal_rate / np.abs(contact.profile_speed)

        # The curvature is finite where the pitch curve is straight; the radius is not.
        peak, at = highest(program.breaks, curvature)
        with np.errstate(divide="ignore"):
            return np.where(peak > 0, 1 / np.maximum(peak, 0), np.inf) - self.roller_radius, at

    def undercut_violation(self, motion: FollowerMotion, base_radius: float, sense: int, least_radius: float) -> Real:
        # A profile has at least this radius if a roller that is larger by the same amount does not undercut it.
        larger = replace(self, roller_radius=self.roller_radius + least_radius) if least_radius else self
        return -larger.contact(motion, base_radius - least_radius, sense).profile_speed

    def contact_travel(self, program: Program, base_radius: float, sense: int) -> None:
        return None

    def plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """The roller; none for a knife edge. A translating roller is held by a guide that is not included."""
        radius = self.roller_radius
        hole = Hole("roller_bore", bars.roller_bore, 2 * radius)
        return (FollowerPlate("roller", Circle(0j, radius), (hole,)),) if radius else ()


def on_roller(
    centre: Complex,
    velocity: Complex,
    acceleration: Complex,
    radius: float,
    sense: int,
    direction: Complex | complex,
    sign: int,
) -> Contact:
    """Contact of a roller; velocity and acceleration of its centre are by cam angle.

    direction: unit direction in which the centre moves as the lift grows. sign: +1 or -1, of the pressure angle. With
    the centre B, the pitch curve E B has the velocity E u, u = B' - i sense B, and the roller lies to the left of it
    for sense = +1. Derived here.
    """
    u = velocity - 1j * sense * centre
    speed = np.abs(u)
    normal = 1j * sense * u / speed
    rate = cross(u, acceleration - 2j * sense * velocity - centre) / speed**2
    pressure_angle = sign * np.angle(normal * np.conj(direction))
    return Contact(centre - radius * normal, normal, rate, speed + sense * radius * rate, pressure_angle)


@record(checked=True)
class TranslatingRoller(AbstractRoller):
    """A roller or knife edge that moves along a straight line parallel to y.

    Parameters
    ----------
    roller_radius : float
        Radius of the roller, mm; 0 for a knife edge.
    offset : float, optional
        Distance of that line from the cam's axis, mm, positive to +x; smaller than the prime radius.

    See Also
    --------
    Cam, TranslatingFlat, OscillatingRoller

    Notes
    -----
    If the cam's sense times the offset is above 0, the pressure angle is smaller on the rise and larger on the return.
    Rothbart, Cams (1956), offset translating follower; the formulas are derived here.

    Examples
    --------
    >>> gk.TranslatingRoller(roller_radius=10, offset=5).size
    10
    """

    offset: float = quantity(
        "distance of the follower's line from the cam axis, positive to +x", "mm",
        default=0.0, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    kind: Literal["translating-roller"] = "translating-roller"
    oscillates = False

    @property
    def size(self) -> float:
        return max(self.roller_radius, abs(self.offset))

    @property
    def centre(self) -> complex:
        return 0j

    def check(self, program: Program, base_radius: float, sense: int) -> None:
        prime = base_radius + self.roller_radius
        if abs(self.offset) >= prime:
            problem = f"found {mm(self.offset):g}, not below the prime radius of {mm(prime):g}"
            remedy = f"give an offset below {mm(prime):down} or a larger base_radius"
            raise DesignError("follower.offset", problem, remedy, value=inside(prime, 1))

    def base_radius_range(self, largest_lift: float) -> tuple[float, float]:
        return max(0.0, abs(self.offset) - self.roller_radius), np.inf

    def start_height(self, base_radius: float) -> float:
        """Height of the roller's centre above the cam's axis at lift 0, mm."""
        # By exact factors: if the offset is close to the prime radius, the difference of squares has few digits.
        sides = (fsum((base_radius, self.roller_radius, sign * self.offset)) for sign in (1, -1))
        return float(np.sqrt(prod(sides)))

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        centre = self.offset + 1j * (self.start_height(base_radius) + motion.lift)
        velocity, acceleration = 1j * motion.velocity, 1j * motion.acceleration
        return on_roller(centre, velocity, acceleration, self.roller_radius, sense, 1j, self.pressure_sign(sense))

    def centre_rates(self, motion: FollowerMotion, base_radius: float) -> dict[str, CentreRate]:
        """The centre is at offset + i (height + lift), height^2 = prime^2 - offset^2; its velocity does not change."""
        height, still = self.start_height(base_radius), 0 * motion.lift
        raised = 1j * (base_radius + self.roller_radius) / height + still, 0j * still, still
        aside = 1 - 1j * self.offset / height + still, 0j * still, still
        return {"base_radius": raised, "roller_radius": raised, "offset": aside}

    def pose(self, lift: Real, base_radius: float) -> Pose:
        """The origin is the roller's centre; the x axis is parallel to the ground's."""
        return Pose(self.offset + 1j * (self.start_height(base_radius) + lift), np.ones(np.shape(lift), complex))

    def guided_plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """The roller and its stem, which lies between cam and base."""
        roller, width = self.plates(bars, program, base_radius, sense), bars.bar_width
        pin = (Hole("roller_bore", bars.roller_bore, width),) if roller else ()
        outline = rounded_hull([0j, 1j * bars.stem_length], width / 2)
        return *roller, FollowerPlate("follower", outline, (*pin, *guide_holes(bars, 1j)))

    def resting_lift(self, points: Complex, base_radius: float) -> Real:
        aside = points.real - self.offset
        with np.errstate(invalid="ignore"):
            lift = points.imag + np.sqrt(self.roller_radius**2 - aside**2) - self.start_height(base_radius)
        return np.where(np.isfinite(lift), lift, -np.inf)


@record(checked=True)
class OscillatingRoller(AbstractRoller):
    """A roller or knife edge on an arm that swings about a pivot at (pivot_distance, 0).

    Parameters
    ----------
    roller_radius : float
        Radius of the roller, mm; 0 for a knife edge.
    pivot_distance : float
        Distance of the pivot from the cam axis, along +x, mm, above 0.
    arm_length : float
        Distance of the roller's centre from the pivot, mm, above 0.
    side : {"above", "below"}, optional
        Side of the line from cam axis to pivot on which the roller is.

    See Also
    --------
    Cam, OscillatingFlat, TranslatingRoller

    Notes
    -----
    The angle at the pivot between the lines to the cam's axis and to the roller's centre is
    psi = acos((c^2 + L^2 - Rp^2) / 2 c L) + lift, with pivot distance c, arm length L and prime radius Rp. Rothbart,
    Cams (1956), oscillating roller follower; the formulas are derived here.
    """

    pivot_distance: float = quantity(
        "distance of the arm's pivot from the cam axis, along +x", "mm", above=0, at_most=FARTHEST, example=100
    )
    arm_length: float = quantity(
        "distance of the roller's centre from the pivot", "mm", above=0, at_most=FARTHEST, example=80
    )
    side: Side = entry("side of the line from cam axis to pivot on which the roller is", default="above")
    kind: Literal["oscillating-roller"] = "oscillating-roller"
    oscillates = True

    @property
    def size(self) -> float:
        return max(self.roller_radius, self.pivot_distance, self.arm_length)

    @property
    def centre(self) -> complex:
        return complex(self.arm_length)

    def check(self, program: Program, base_radius: float, sense: int) -> None:
        check_reach(self, program, base_radius, "arm", "arm_length", "pivot_distance")

    def base_radius_range(self, largest_lift: float) -> tuple[float, float]:
        c, arm = self.pivot_distance, self.arm_length
        # At psi = 180 deg the arm points away from the axis, the limit of its swing.
        farthest = np.sqrt(c**2 + arm**2 + 2 * c * arm * np.cos(np.clip(largest_lift, 0, np.pi)))
        return max(0.0, abs(c - arm) - self.roller_radius), max(0.0, float(farthest) - self.roller_radius)

    def start_angle(self, base_radius: float) -> float:
        """psi at lift 0, rad."""
        c, arm, prime = self.pivot_distance, self.arm_length, (base_radius, self.roller_radius)
        # By the half angle and exact sums, which keep their digits if the three points are nearly collinear.
        opposite = fsum((*prime, -c, arm)) * fsum((*prime, c, -arm))
        adjacent = fsum((c, arm, -base_radius, -self.roller_radius)) * fsum((c, arm, *prime))
        return 2 * float(np.arctan2(np.sqrt(opposite), np.sqrt(adjacent)))

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        tau = side_sign(self.side)
        arm = self.arm_length * arm_direction(self.start_angle(base_radius) + motion.lift, tau)
        # The arm rotates by -tau per unit of lift.
        velocity = -1j * tau * motion.velocity * arm
        acceleration = -1j * tau * motion.acceleration * arm - motion.velocity**2 * arm
        direction = -1j * tau * arm / self.arm_length
        centre = self.pivot_distance + arm
        return on_roller(centre, velocity, acceleration, self.roller_radius, sense, direction, tau)

    def pressure_sign(self, sense: int) -> int:
        return side_sign(self.side)

    def centre_rates(self, motion: FollowerMotion, base_radius: float) -> dict[str, CentreRate]:
        """The angle psi at lift 0 changes by the cosine rule; the arm turns by -tau for 1 of psi."""
        tau, c, length = side_sign(self.side), self.pivot_distance, self.arm_length
        prime = base_radius + self.roller_radius
        psi = self.start_angle(base_radius)
        direction, over = arm_direction(psi + motion.lift, tau), 1 / (c * length * np.sin(psi))
        # By each size: psi, the arm's length, and the pivot.
        by_prime = prime * over, 0.0, 0.0
        sizes = {
            "base_radius": by_prime,
            "roller_radius": by_prime,
            "pivot_distance": (-(c**2 - length**2 + prime**2) / (2 * c) * over, 0.0, 1.0),
            "arm_length": (-(length**2 - c**2 + prime**2) / (2 * length) * over, 1.0, 0.0),
        }
        rates: dict[str, CentreRate] = {}
        for name, (turned, longer, pivot) in sizes.items():
            arm = direction * (longer - 1j * tau * length * turned)
            rates[name] = pivot + arm, -1j * tau * motion.velocity * arm, -tau * turned + 0 * motion.lift
        return rates

    def pose(self, lift: Real, base_radius: float) -> Pose:
        """The origin is the pivot; the x axis points to the roller's centre."""
        direction = arm_direction(self.start_angle(base_radius) + lift, side_sign(self.side))
        return Pose(np.full(np.shape(lift), complex(self.pivot_distance)), direction)

    def resting_lift(self, points: Complex, base_radius: float) -> Real:
        from_pivot = points - self.pivot_distance
        arm, distance = self.arm_length, np.abs(from_pivot)
        with np.errstate(invalid="ignore", divide="ignore"):
            to_centre = np.arccos((arm**2 + distance**2 - self.roller_radius**2) / (2 * arm * distance))
        # Angles at the pivot: from the line to the axis to the line to the point, and on to the roller's centre.
        psi = -side_sign(self.side) * np.angle(-from_pivot) + to_centre
        return np.where(np.isfinite(to_centre), psi - self.start_angle(base_radius), -np.inf)

    def plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """The roller and the arm about its pivot."""
        roller, width = super().plates(bars, program, base_radius, sense), bars.bar_width
        pivot, pin = (
            Hole("pivot_bore", bars.pivot_bore, width),
            Hole("roller_bore", bars.roller_bore, width, self.centre),
        )
        outline = rounded_hull([0j, self.centre], width / 2)
        return *roller, FollowerPlate("arm", outline, (pivot, pin) if roller else (pivot,))

"""A walker on its feet: whether they hold its frame level, the forces on each leg, and the speed at which it walks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from ...core.errors import DesignError, shown
from ...core.fields import entry, to_digits
from ...core.records import record
from ...core.units import bare_mm, mm
from ...model.check import Check, Suggestion
from ...model.motor import Motor
from ...model.scene import Plot
from ...model.table import Column
from ...plane.vec import Complex, Real, without_rounding
from ...recipe.aspect import Foot, FootForces, Standing
from ..drive_limits import largest_over, moved_to
from ..dynamics.loads import DriveTable, Force
from ..dynamics.wrenches import NEWTON
from ..linkage import Linkage
from ..measures import foot_shares, foot_slip, ground_slopes, support_margin
from ..motion import Motion
from ..parts.stack import Stack
from .aspects import AbstractLinkageAspect
from .copies import Copied
from .loads import CarriedMass
from .made import MadeLinkage

# Steps in which the displacement of a centre of mass is found that lets a walker stand.
MOST_SHIFTS = 100
# Least number of feet that carry a frame.
FEWEST_FEET = 3
# Largest tilt of the frame over a turn, deg, along the path or across it. A walker that rocks more stumbles; chosen
# here.
MOST_ROCKING_DEG = 10.0
# Three pairs of legs, the middle one half a turn ahead.
SIX_LEGS = (
    "copies = [{ mirrored = true }, { phase_deg = 180 }, { phase_deg = 180, mirrored = true }, {}, { mirrored = true }]"
)
FOUR_LEGS = (
    "Four legs stand on two feet at times, whatever their phases, and the frame then tips from one pair of feet to "
    "another: give six legs, as the checks of the tilt advise, or fix feet of your own that are as wide as the body."
)
# Largest turn of a walker in a machine, rad, with which it stands on its feet.
UPRIGHT = 1e-6
UNKNOWN_STANCE = "How it stands is unknown: no rod joins two of the copies, so their distance is not given."


def foot_entry() -> Any:
    """Field for the foot of a walker."""
    return entry(
        "point that stands on the ground, which is at -y, in a linkage and at least two copies; checks then report "
        "whether the walker falls over, and how far it tilts",
        default=None,
    )


def check_foot(foot: str, linkage: Linkage, count: int = FEWEST_FEET) -> None:
    """Refuse a foot that is no point of a moving body, or too few feet. count: number of linkages that stand."""
    fixed = linkage.bodies[linkage.ground]
    points = dict.fromkeys(point for names in linkage.bodies.values() for point in names if point not in fixed)
    if foot not in points:
        raise DesignError("foot", f"found {shown(foot)}", f"give a point of a moving body: {', '.join(points)}")
    if count < FEWEST_FEET:
        problem = f"found {foot}, but {count} of them cannot stand"
        raise DesignError("foot", problem, f"give at least {FEWEST_FEET - 1} [[copies]], or omit foot", "conflict")


@record(eq=False)
class Stance:
    """The feet of a linkage and its copies over a turn, seen from above: x along the path, y along the shaft, mm.

    legs: the feet in the frame of the walker. centre: of mass, one or one for each frame; in the middle of all fixed
    pivots if no mass is known. mass: of all, kg. drive: of the first leg, rad. of: how it stands at other positions.
    carried: mass and place of what the recipe lets it carry.
    """

    legs: tuple[Foot, ...]
    centre: complex | Complex
    mass: float
    drive: Real
    of: Callable[[Real], Stance]
    carried: tuple[tuple[float, complex], ...] = ()

    @cached_property
    def feet(self) -> Complex:
        """The feet from above, (feet, frames)."""
        return np.array([foot.position.real + 1j * foot.across for foot in self.legs])

    @cached_property
    def height(self) -> Real:
        """Height of the feet, mm, (feet, frames)."""
        return np.array([foot.position.imag for foot in self.legs])

    @cached_property
    def velocity(self) -> Real:
        """Velocity of the feet in the frame along the path, mm/s, (feet, frames)."""
        return np.array([foot.velocity.real for foot in self.legs])

    def _at(self, drive: Real) -> Stance:
        return self if drive is self.drive else self.of(drive)

    @cached_property
    def margin(self) -> Real:
        """Distance of the centre inside the support polygon, mm; negative where it falls over."""
        return support_margin(self.feet, self.centre)

    @cached_property
    def slope(self) -> Complex:
        """Slope of the ground under the frame along and across the path; nan where it falls over."""
        return ground_slopes(self.feet, self.height, self.centre)

    @property
    def tilt_deg(self) -> Mapping[str, Real]:
        """Tilt of the frame along the path and across it, deg; nan where it falls over."""
        return {"along": np.degrees(np.arctan(self.slope.real)), "across": np.degrees(np.arctan(self.slope.imag))}

    @cached_property
    def shares(self) -> Real:
        """Share of the weight on each foot, (feet, frames)."""
        return foot_shares(self.feet, self.height, self.centre, self.slope)

    def ground_forces(self, weight: float, friction: float) -> tuple[Complex, Real]:
        """Force of the ground on each foot in the frame of the first linkage, and speed of the frame, mm/s.

        weight: N; friction: coefficient between feet and ground.
        """
        sense, speed = foot_slip(self.shares, self.velocity)
        return weight * (1j * self.shares + friction * sense), speed

    @cached_property
    def least_margin(self) -> tuple[float, float]:
        """Least margin, mm, also between frames, and the drive there."""
        largest, drive = largest_over(self.drive, lambda drive: -self._at(drive).margin)
        return without_rounding(-float(largest), float(np.abs(self.feet).max())), float(drive)

    @cached_property
    def tilt_range_deg(self) -> Mapping[str, tuple[float, float]]:
        """Least and largest tilt, deg, also between frames; nan if it falls over."""
        if not all(np.isfinite(tilt).all() for tilt in self.tilt_deg.values()):
            return dict.fromkeys(self.tilt_deg, (np.nan, np.nan))

        def both_ways(drive: Real) -> Real:
            return np.concatenate([(-tilt, tilt) for tilt in self._at(drive).tilt_deg.values()])

        ends = largest_over(self.drive, both_ways)[0].reshape(-1, 2).tolist()
        return {direction: (0.0 - low, high) for direction, (low, high) in zip(self.tilt_deg, ends)}

    @property
    def shift_that_stands(self) -> complex | None:
        """Displacement of the centre of mass with which it stands at all frames, mm; None if there is none nearby."""
        size, shift = float(np.abs(self.feet - self.centre).max()), 0j
        steps = np.array([0, 1, 1j]) * size * 1e-6
        for _ in range(MOST_SHIFTS):
            margins = np.array([support_margin(self.feet, self.centre + shift + step).min() for step in steps])
            if margins[0] > size * 1e-3:
                return shift
            gradient = complex(*((margins[1:] - margins[0]) / (size * 1e-6)))
            if not gradient:
                return None
            shift += (size * 2e-3 - float(margins[0])) * gradient / abs(gradient) ** 2
        return None

    def checks(self, key: str, tilt_advice: str) -> Iterator[Check]:
        """That the centre stays above the support polygon, and that the frame rocks little.

        key: of the table with `carried` in the recipe.
        """
        least, drive = self.least_margin
        at, values = float(np.degrees(drive)), dict[str, float | str]()
        advice = "give further legs at other phases, or mirrored ones, so that a foot is on each side of the frame"
        if not least >= 0 and (shift := self.shift_that_stands) is not None:
            moment = self.mass * shift
            words = f"displace what it carries, or add a mass, by {moment.real:+.4g} kg mm along the path and "
            words += f"{moment.imag:+.4g} kg mm along the shaft, its mass times the displacement"
            if self.carried:
                number, (mass, place) = max(enumerate(self.carried), key=lambda item: item[1][0])
                moved = place + moment / mass
                along, across = (to_digits(float(z), 6) for z in (moved.real, moved.imag))
                words = f"give along = {bare_mm(along):.6g} and across = {bare_mm(across):.6g} in the table of "
                words += f"{key}.carried with {mass:g} kg"
                values = {f"{key}.carried[{number}].along": along, f"{key}.carried[{number}].across": across}
            advice = f"it tips with its driver at {at:.5g} deg: {words}; or {advice}"
        name = "least distance of the frame's centre inside its feet"
        suggestions = (Suggestion(values, "mm"),) if values else ()
        yield Check(
            "support_margin", name, least, "at least", 0, "mm", advice, at=at, suggestions=suggestions
        )  # fmt: skip
        for direction, (low, high) in self.tilt_range_deg.items():
            name = f"tilt {direction} the path, largest minus least"
            yield Check(f"tilt_{direction}", name, high - low, "at most", MOST_ROCKING_DEG, "deg", tilt_advice)

    @property
    def remarks(self) -> Iterator[str]:
        """That four legs tip, and the place of the weight for which the checks hold."""
        if len(self.feet) == 4:
            yield FOUR_LEGS
        if (margin := self.least_margin[0]) > 0 and self.mass:
            centre = np.asarray(self.centre)
            x, y = centre.real, centre.imag
            yield (
                f"It stands: its centre of mass, of {self.mass:.4g} kg, is "
                f"{mm(x.min(), x.max(), between=' to '):.4g} along the path from its origin and "
                f"{mm(y.min(), y.max(), between=' to '):.4g} along the shaft from its first outer face, at least "
                f"{mm(margin):down2} inside its feet. Rods and tubes of the frame are not weighed."
            )
        elif margin > 0 and np.ndim(self.centre) == 0:
            yield (
                f"It stands if its weight is in the middle, {mm(self.centre.imag):.4g} from its first outer face: "
                f"fix the battery so that it balances there, within {mm(margin):down2}."
            )

    @property
    def summary(self) -> Mapping[str, object]:
        """Least margin and the range of the tilts."""
        tilts = {
            f"tilt_{direction}_deg": [to_digits(low), to_digits(high)]
            for direction, (low, high) in self.tilt_range_deg.items()
            if np.isfinite(low)
        }
        mass = {"mass_kg": to_digits(self.mass)} if self.mass else {}
        return {**mass, "least_margin_mm": to_digits(self.least_margin[0]), **tilts}


@record(eq=False)
class StandingAspect(AbstractLinkageAspect[str]):
    """How a walker stands on the feet of the linkage and its copies, down being -y."""

    key = "foot"

    def check(self) -> None:
        check_foot(self.given, self.mechanism.linkage.linkage, 1 + len(self.mechanism.copies))

    @cached_property
    def stance(self) -> Stance | None:
        """How it stands over a turn; None if the distances of the copies are unknown, or if a machine walks on it."""
        made, frames = self.mechanism, self.mechanism.input_range.frames
        return None if self._is_leg else stance_of(made, made.moved(np.linspace(frames[0], frames[-1], POSITIONS)))

    @property
    def _is_leg(self) -> bool:
        return self.mechanism.setting.feet is not None

    @property
    def checks(self) -> Iterator[Check]:
        advice = "a machine turns it, and its feet are at -y of its own recipe: give angle_deg = 0"
        phases = "phases by which three feet always stand, by" if len(self.mechanism.copies) >= 5 else "six legs, by"
        tilt = f"give {phases} {SIX_LEGS} above the first table in place of others, or a leg whose foot keeps level"
        for check in self.stance.checks("loads", tilt) if self.stance else ():
            yield replace(check, value=np.nan, at=None, advice=advice) if self._is_turned else check

    @property
    def _is_turned(self) -> bool:
        return abs(self.mechanism.setting.direction - 1) > UPRIGHT

    @property
    def remarks(self) -> Iterator[str]:
        if not self._is_turned and not self._is_leg:
            yield from self.stance.remarks if self.stance else (UNKNOWN_STANCE,)

    @property
    def entries(self) -> Mapping[str, object]:
        return {"stance": self.stance.summary} if self.stance else {}


def stance_of(made: MadeLinkage, first: Motion, motor: Motor | None = None) -> Stance | None:
    """How a walker stands over a turn; None if the distances of its copies are unknown.

    first: motion of the first linkage. motor: that it carries, by default the mounted one, at its shaft and at the
    outer face of the first ground.
    """
    foot, motor = made.foot, motor or made.mounted_motor
    if foot is None or not np.isfinite((standing := standing_of(made, first, foot)).height):
        return None
    motors = []
    if motor is not None and (standing.masses or made.carried):
        shaft = first.point(str(first.linkage.driver_pivot)).position[0].real
        motors.append((1e-3 * motor.mass_g, complex(shaft)))

    def standing_at(drive: Real) -> Standing:
        return standing_of(made, moved_to(first, drive), foot).at_frames(slice(1, None))

    return stance_with(standing, made.carried, motors, first.drive, standing_at)


def stance_with(
    standing: Standing,
    carried: Sequence[CarriedMass],
    motors: Sequence[tuple[float, complex]],
    drive: Real,
    standing_at: Callable[[Real], Standing],
) -> Stance:
    """How a walker stands with what it carries besides its parts.

    motors: mass, kg, and place from above, mm. drive: positions of the driver of the first leg, rad. standing_at: feet
    and masses at other ones.
    """
    middle = complex(np.mean([place.real for place in standing.pivots]), standing.height / 2)
    places = (
        complex(
            middle.real if given.along is None else given.along, middle.imag if given.across is None else given.across
        )
        for given in carried
    )
    placed = tuple(zip((given.mass_kg for given in carried), places))
    own = ((mass, place.real + 1j * across) for mass, place, across in standing.masses)
    masses: list[tuple[float, complex | Complex]] = [*own, *placed, *motors]
    mass = sum(each for each, _ in masses)
    total: complex | Complex = sum((each * place for each, place in masses), 0j)

    def of(other: Real) -> Stance:
        return stance_with(standing_at(other), carried, motors, other, standing_at)

    return Stance(standing.feet, total / mass if mass else middle, mass, drive, of, placed)


def standing_of(made: MadeLinkage, motion: Motion, foot: str) -> Standing:
    """The feet and the masses of a linkage and its copies in a motion, without a motor; foot: empty if it has none.

    The height is nan if no rod joins two of the copies.
    """
    linkage, sheet, start = motion.linkage, made.stock.thickness, 0.0
    bodies = {**made.masses, **made.given_masses}
    leg = next((name for name, points in linkage.bodies.items() if foot in points), "")
    pivots = [pin for pin, joined in linkage.pins.items() if linkage.ground in joined]
    copies = (Copied(motion, np.arange(len(motion.drive))), *made.copies_of(motion))
    feet, masses, fixed = [], [], []
    for copy, stack, room in zip(copies, made.stacks, (*(rod.room for rod in made.shared), 0.0)):
        total = (1 + max(stack.layers.values())) * sheet
        across = partial(_across, stack, total, sheet, copy.mirrored)
        if foot:
            moved = copy.motion.point(foot)
            velocity = copy.placement.vector(moved.velocity[copy.rows])
            drive = copy.motion.drive[copy.rows]
            feet.append(Foot(drive, copy.place(moved.position), velocity, start + across(leg), copy.mirrored))
        fixed += [complex(copy.place(copy.motion.point(pin).position)[0]) for pin in pivots]
        for name, own in bodies.items():
            poses = copy.motion.bodies[name]
            mass_centre = poses.origin.position + poses.direction * own.centre
            at = copy.place(np.broadcast_to(mass_centre, copy.motion.drive.shape))
            masses.append((float(own.mass), at, start + across(name)))
        start += total + room
    return Standing(tuple(feet), tuple(masses), tuple(fixed), start)


def _across(stack: Stack, total: float, sheet: float, is_mirrored: bool, body: str) -> float:
    """Middle of the plates of a body above the lower face of its stack, mm. total: height of the stack."""
    layers = [stack.layers[name] for name, plate in stack.plates.items() if plate.body == body]
    inside = (float(np.mean(layers)) + 0.5) * sheet if layers else total / 2
    return total - inside if is_mirrored else inside


# Positions over a turn, besides the frames of the table, between which the forces at the feet are interpolated. They
# jump where a foot takes over, which takes one such step.
POSITIONS = 721


@record(eq=False)
class Walking:
    """The forces of the ground on the feet of a walker, at a constant speed of its frame over short times.

    stance: at the positions of the forces. weight: N. friction: of its feet. driver_speed: of its legs, rad/s.
    """

    stance: Stance
    weight: float
    friction: float
    driver_speed: float

    @cached_property
    def _forces(self) -> tuple[Complex, Real]:
        return self.stance.ground_forces(self.weight, self.friction)

    @property
    def speed(self) -> Real:
        """Speed of the frame along the path, mm/s."""
        return self._forces[1]

    @property
    def largest(self) -> Real:
        """Largest load of each foot, N."""
        largest: Real = self.weight * self.stance.shares.max(axis=1)
        return largest

    def on_feet(self, point: str, numbers: slice = slice(None)) -> FootForces:
        """The forces on some feet, each in the frame of its leg, which is upright; point: that stands."""
        legs, forces = self.stance.legs[numbers], self._forces[0][numbers]
        own = (-np.conj(force) if foot.mirrored else force for foot, force in zip(legs, forces))
        return FootForces(point, tuple(foot.drive for foot in legs), tuple(own))

    @property
    def mean_speed(self) -> float:
        """Mean speed of the frame over a turn, mm/s."""
        drive = self.stance.drive
        return float(np.trapezoid(self.speed, drive) / (drive[-1] - drive[0]))

    @property
    def step(self) -> float:
        """Distance walked in a turn of the shaft, mm."""
        return abs(self.mean_speed * 2 * np.pi / self.driver_speed)

    @property
    def plots(self) -> tuple[Plot, Plot]:
        """Of the loads of the feet, and of the speed."""
        loads = tuple(f"foot_{k}_load" for k in range(1, 1 + len(self.stance.legs)))
        return Plot("loads of the feet", loads), Plot("speed of the walker", ("walking_speed",))

    def columns(self, drive: Real) -> Iterator[Column]:
        """Load of each foot and speed of the frame at positions of the driver."""
        stance = self.stance.of(drive)
        forces, speed = stance.ground_forces(self.weight, self.friction)
        for k, (id, force) in enumerate(zip(self.plots[0].columns, forces), 1):
            yield Column(id, "N", f"load of foot {k} by the weight of the walker", force.imag)
        yield Column("walking_speed", "mm/s", "speed of the walker along its path", speed)

    @property
    def summary(self) -> Mapping[str, object]:
        """Weight, largest load of each foot, and speed."""
        return {
            "weight_N": to_digits(self.weight),
            "largest_foot_loads_N": [to_digits(load) for load in self.largest.tolist()],
            "walking_speed_mm_per_s": to_digits(self.mean_speed),
            "step_mm": to_digits(self.step),
        }


def walking_of(made: MadeLinkage, gravity: complex, friction: float, motor: Motor | None = None) -> Walking | None:
    """The forces at the feet of a walker; None if it has no weight, is not upright, or falls over at some position.

    gravity: in its own frame, mm/s2. motor: that it carries, by default the mounted one.
    """
    if made.foot is None or gravity.real or gravity.imag >= 0:
        return None
    frames = made.input_range.frames
    positions = np.unique(np.concatenate([frames, np.linspace(frames[0], frames[-1], POSITIONS)]))
    stance = stance_of(made, made.moved(positions if frames[-1] > frames[0] else positions[::-1]), motor)
    if stance is None or not stance.mass or not np.isfinite(stance.shares).all():
        return None
    return Walking(stance, NEWTON * stance.mass * abs(gravity), friction, made.speed)


def forces_on_legs(feet: FootForces, linkage: Linkage) -> tuple[Force, ...]:
    """The forces at the feet as loads of a linkage and of its copies."""
    body, legs = next(name for name, points in linkage.bodies.items() if feet.point in points), []
    for drive, force in zip(feet.drives, feet.forces):
        order = np.argsort(drive, kind="stable")
        legs.append(Force(body, feet.point, DriveTable(drive[order], force[order], 2 * np.pi)))
    return tuple(legs)

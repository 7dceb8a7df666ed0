"""Recipe of conjugate cams, which move their follower both ways, with the cams, their plates and their loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity, rounded_up
from ...core.records import record
from ...core.units import mm
from ...making.assembly import Assembly, AssemblyBuilder, collar_across, glue_bill, pin_bill, seated, tube_bill
from ...model.check import Check
from ...model.material import hertz_pressure
from ...model.part import Part
from ...model.scene import Limit, Plot, Scene, SceneBody, SceneHandle, SceneMark, circle_handle
from ...model.table import Column, Table, xy_columns
from ...plane.curve import AbstractCurve, Moved
from ...plane.primitives import Circle, Polyline, rounded_hull, slot
from ...plane.vec import Complex, Pose, Real
from ...recipe.composed import AspectKinds
from ...recipe.recipe import Additions
from ..cam import Cam
from ..checks import cam_checks
from ..dynamics import CamForces
from ..followers.follower import FollowerPlate, Hole
from ..followers.roller import OscillatingRoller, TranslatingRoller
from ..parts import LETTERS, TIMING_STEP, cam_base, cam_plate, follower_part, unheld
from ..program.laws import largest, samples
from ..program.program import FollowerMotion, Program
from ..undercut import Undercut
from .disk_cam import CamAdditions
from .positive import FLAT_FOLLOWERS, FREE, AbstractPositiveCam, AbstractPositiveCamRecipe, PositiveLoadsAspect

# Largest angle between the two arms of a follower, rad: beyond it they leave no corner between them.
MOST_SPREAD = np.radians(170)


@record(checked=True)
class SecondCam:
    """The second of two conjugate cams, whose roller pulls the follower back.

    Parameters
    ----------
    clearance : float, optional
        How much farther apart the rollers are than both profiles require, mm.
    base_radius : float, optional
        Radius of the second cam where the lift is largest, mm; by default that of the first at lift 0.
    arm_length : float, optional
        Distance of the second roller from the pivot of an arm, mm; by default that of the first.
    """

    clearance: float = quantity(
        "how much farther apart the rollers are than both profiles require", "mm",
        default=0.1, above=0, at_most=FARTHEST,
    )  # fmt: skip
    base_radius: float | None = quantity(
        "radius of the second cam where the lift is largest; by default that of the first at lift 0", "mm",
        default=None, above=0, at_most=FARTHEST,
    )  # fmt: skip
    arm_length: float | None = quantity(
        "distance of the second roller from an arm's pivot; by default that of the first", "mm",
        default=None, above=0, at_most=FARTHEST,
    )  # fmt: skip


@record
class Complement(Program):
    """What the second cam lifts: the largest lift of the first one's programme, less its lift."""

    @cached_property
    def top(self) -> float:
        """Largest lift of the first cam, mm or rad."""
        return largest(self.breaks, lambda t: Program.motion(self, t).lift)[0]

    def motion(self, angle: ArrayLike) -> FollowerMotion:
        first = Program.motion(self, angle)
        return FollowerMotion(self.top - first.lift, -first.velocity, -first.acceleration, -first.jerk)


@record(eq=False)
class MadeConjugateCams(AbstractPositiveCam):
    """Two cams and the follower between them.

    From below: base, first cam with its roller, arm or yoke, second cam with its roller.
    """

    second: SecondCam
    pin_layers = 3

    @property
    def clearance(self) -> float:
        return self.second.clearance

    def check_walls(self) -> None:
        follower = self.roller
        if self.second.arm_length is not None and not follower.oscillates:
            problem = f"found {mm(self.second.arm_length):g}, but the follower moves straight"
            raise DesignError("second.arm_length", problem, "omit it", "conflict")
        try:
            _ = self.other
        except DesignError as error:
            raise DesignError("second.base_radius", error.problem, error.remedy, error.id) from None
        if isinstance(follower, OscillatingRoller):
            self._check_arms(follower.pivot_distance)

    def _check_arms(self, distance: float) -> None:
        """DesignError if the first cam meets the pivot, or the two arms are nearly in line."""
        radius, key = self.first_radius, "cam.follower.pivot_distance"
        least = radius + self.stock.pivot_bore / 2 + FREE
        if distance < least:
            problem = f"found {mm(distance):g}: the first cam, {mm(radius):.4g} in radius, meets the pivot"
            remedy = f"give at least {mm(least):up}, or a smaller base_radius"
            raise DesignError(key, problem, remedy, value=rounded_up(least))
        if self.spread >= MOST_SPREAD:
            problem = f"found {mm(distance):g}: both arms are {np.degrees(self.spread):.4g} deg apart"
            remedy = f"give a larger one, or a smaller base_radius, for less than {np.degrees(MOST_SPREAD):g} deg"
            raise DesignError(key, problem, remedy)

    @cached_property
    def other(self) -> Cam:
        """The second cam: that of an arm about the same pivot; that of a yoke turned by half a turn."""
        follower, second = self.roller, self.second
        program = Complement(self.cam.program.segments, self.cam.program.folder)
        base = self.cam.base_radius if second.base_radius is None else second.base_radius
        if isinstance(follower, OscillatingRoller):
            length = follower.arm_length if second.arm_length is None else second.arm_length
            side = "below" if follower.side == "above" else "above"
            return Cam(replace(follower, arm_length=length, side=side), program, base, self.cam.direction)  # type: ignore[arg-type]
        assert isinstance(follower, TranslatingRoller)
        return Cam(replace(follower, offset=-follower.offset), program, base, self.cam.direction)

    @property
    def top(self) -> float:
        """Largest lift, mm or rad."""
        program = self.other.program
        assert isinstance(program, Complement)
        return program.top

    @property
    def turned(self) -> int:
        """-1 if the second cam is turned by half a turn, 1 if not."""
        return 1 if self.roller.oscillates else -1

    @property
    def spread(self) -> float:
        """Angle between the two arms, rad."""
        first, second = self.roller, self.other.follower
        assert isinstance(first, OscillatingRoller) and isinstance(second, OscillatingRoller)
        return first.start_angle(self.cam.base_radius) + second.start_angle(self.other.base_radius) + self.top

    @property
    def second_centre(self) -> complex:
        """Centre of the second roller in the follower's frame, mm."""
        first, second = self.roller, self.other.follower
        if isinstance(first, OscillatingRoller) and isinstance(second, OscillatingRoller):
            tau = 1 if first.side == "above" else -1
            return complex(second.arm_length * np.exp(1j * tau * self.spread))
        assert isinstance(first, TranslatingRoller) and isinstance(second, TranslatingRoller)
        heights = first.start_height(self.cam.base_radius) + second.start_height(self.other.base_radius)
        return -1j * (heights + self.top)

    @cached_property
    def second_outline(self) -> AbstractCurve:
        """The second cam as cut, in the frame of both cams."""
        outline = self.narrowed(self.other)
        return outline if self.turned > 0 else Moved(outline, Pose(0j, -1 + 0j))

    @property
    def curves(self) -> tuple[tuple[AbstractCurve, complex], ...]:
        """Both cams, each with its roller."""
        return (self.cut.outline, self.roller.centre), (self.second_outline, self.second_centre)

    @cached_property
    def first_radius(self) -> float:
        """Largest radius of the first cam, mm."""
        return _largest_radius(self.cut.outline)

    @cached_property
    def bars(self) -> tuple[FollowerPlate, ...]:
        """An arm with two branches, or a yoke with a slot for the shaft."""
        stock, end = self.stock, self.second_centre
        half, pins = stock.bar_width / 2, [self.roller.centre, end]
        rollers = tuple(Hole("roller_bore", stock.roller_bore, stock.bar_width, pin) for pin in pins)
        if self.roller.oscillates:
            pivot = Hole("pivot_bore", stock.pivot_bore, stock.bar_width)
            return (FollowerPlate("arm", two_branched(self.roller.centre, end, half), (pivot, *rollers)),)
        axis = -complex(np.asarray(self.roller.pose(np.zeros(()), self.cam.base_radius).origin))
        window = slot(axis - 1j * self.top, axis, self.tube / 2 + FREE)
        wide = abs(axis.real) + self.tube / 2 + FREE + half
        outline = rounded_hull([0j, 1j * stock.stem_length, end], wide)
        guides = () if self.base is None else self.guide_pins(self.first_radius)
        return (FollowerPlate("follower", outline, (*rollers, *guides), window),)

    @property
    def tube(self) -> float:
        """Diameter reserved for the tube between the cams, mm."""
        return collar_across(self.stock.bore) if self.stock.bore else 0.0

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Both cams, the rollers, the arm or yoke, and the base or the motor's plate."""
        stock, cam = self.stock, self.cam
        letters = ("A",) if self.base else ()
        first = replace(cam_plate(cam, stock, self.cut), hole_names=letters)
        narrowest = float(np.abs(self.second_outline.point(samples(self.second_outline.breaks))).min())
        start = complex(cam.profile.point(0.0))
        bored = stock.hole(start / abs(start), 2 * narrowest, "stock")
        second = replace(first, name="second", outline=self.second_outline, holes=bored, marks=())
        roller, *_ = cam.follower.plates(stock.bars, cam.program, cam.base_radius, cam.sense)
        names = LETTERS if self.base else None
        rollers = replace(follower_part(roller, stock, names), count=2)
        plates = [first, second, rollers, *(follower_part(bar, stock, names) for bar in self.bars)]
        if self.base is None:
            return (*plates, *stock.motor_parts)
        shafts = {"bore": stock.bore, "pivot_bore": stock.pivot_bore}
        reach = max(self.first_radius, _largest_radius(self.second_outline) + 2 * self.roller.roller_radius)
        whole = replace(self.cut, outline=Circle(0j, reach))
        return (*plates, cam_base(cam, whole, self.bars, shafts, stock, self.base, self.tube))

    @cached_property
    def assembly(self) -> Assembly:
        """Shafts, pins and collars, and the assembly steps."""
        stock, thick, base = self.stock, self.stock.thickness, self.base
        builder = AssemblyBuilder("" if base is None else "base", thick, base, base is not None, stock.motor)
        layer, on = builder.lowest, "A" if base is not None else ""
        builder.shaft("A", "cam", stock, (0.0 if base is None else thick) + 3 * thick, layer + 2, keys=2)
        builder.add_step(layer, f"{seated('cam', on, stock)}, with the drawn side up")
        if stock.timing_mark:
            builder.add_step(layer, TIMING_STEP)
        for step in self._bar_steps(builder):
            builder.add_step(layer + 1, step)
        if stock.bore and not stock.motor:
            builder.buy(builder.joint_name("A", "cam"), tube_bill(stock.bore, thick))
            builder.add_step(layer + 1, f"put a tube of {mm(thick):g} on the shaft")
        builder.add_step(layer + 2, f"{seated('second', on, stock)}, turned as it is drawn over cam")
        if stock.roller_bore:
            pin = builder.joint_name("C", "its pin")
            builder.add_step(layer + 2, f"lay the other roller on {pin}; fit a collar on {pin}, with play")
        if base is None:
            builder.add_last_step(unheld(self.cam, True, stock))
        return builder.build()

    def _bar_steps(self, builder: AssemblyBuilder) -> Iterator[str]:
        stock, thick, bar = self.stock, self.stock.thickness, self.bars[0].name
        joint = builder.joint_name("C", "roller")
        builder.buy(joint, (*pin_bill(stock.roller_bore, 2 * thick), *glue_bill(1)))
        builder.pins("C", "roller", stock.roller_bore, 2 * thick)
        yield f"glue a pin into each end of {bar}, one downwards and one upwards; put a roller on the lower one"
        count = sum(hole.key == "pivot_bore" for hole in self.bars[0].holes)
        if self.base is None:
            builder.buy(bar, pin_bill(stock.pivot_bore, thick, count))
            yield f"lay {bar}, the lower roller on cam"
            return
        builder.pins("B", bar, stock.pivot_bore, 3 * thick, count, under=True)
        if stock.pivot_bore:
            builder.buy("B", tube_bill(stock.pivot_bore, thick, count))
        pins = f"{count} pins B" if count > 1 else "pin B"
        yield f"glue {pins} into {bar}, flush at the top, with a tube of {mm(thick):g} under it on each"
        where = "the slot B of base" if count > 1 else "base"
        yield f"lay {bar}, the lower roller on cam and {pins} through {where}"
        yield f"fit a collar on {'each' if count > 1 else 'B'} below base, with play"


def _largest_radius(outline: AbstractCurve) -> float:
    return float(np.abs(outline.point(samples(outline.breaks))).max())


def two_branched(one: complex, other: complex, half: float) -> Polyline:
    """Outline of an arm about a pivot at the origin with round ends at two points, mm; half: half its width."""
    if (other / one).imag < 0:
        one, other = other, one
    angle = float(np.angle(other / one))
    first, second = one / abs(one), other / abs(other)
    inner = half / np.sin(angle / 2) * first * np.exp(0.5j * angle)
    reach = half / np.tan(angle / 2)
    if min(abs(one), abs(other)) <= reach:
        problem = f"found {mm(2 * half):g}: the branches of the arm, {np.degrees(angle):.4g} deg apart, do not part"
        least = 2 * min(abs(one), abs(other)) * np.tan(angle / 2)
        raise DesignError("stock.bar_width", problem, f"give less than {mm(least):down}")
    corners: list[complex] = [
        one - 1j * half * first, one + 1j * half * first, inner, other - 1j * half * second,
        other + 1j * half * second, 1j * half * second, -1j * half * first,
    ]  # fmt: skip
    bulges = [1.0, 0.0, 0.0, 1.0, 0.0, float(np.tan((np.pi - angle) / 4)), 0.0]
    vertices: Complex = np.array(corners)
    return Polyline(vertices, np.array(bulges))


# Checks of a single cam that hold for the second one too.
OF_BOTH = ("pressure_angle_rise", "pressure_angle_return", "pitch_radius")


@record(eq=False)
class ConjugateLoadsAspect(PositiveLoadsAspect):
    """The forces of two cams and their rollers: the first cam lifts the follower, the second one pulls it back."""

    mechanism: MadeConjugateCams
    names = ("first cam", "second cam")

    def check(self) -> None:
        super().check()
        if self.given.friction:
            problem = "is given, but its effect is known for one cam only"
            raise DesignError("loads.friction", problem, "omit it", "conflict")

    def forces_at(self, angle: Real) -> CamForces:
        forces, other = super().forces_at(angle), self.mechanism.other
        reach = other.follower.arm_length if isinstance(other.follower, OscillatingRoller) else 1.0
        second = forces.stroke_force / (reach * np.cos(other.contact(angle).pressure_angle))
        return replace(forces, contact=np.where(forces.stroke_force < 0, second, forces.contact))

    def pressure(self, angle: Real) -> Real:
        """Hertz pressure on the cam that carries the follower, N/mm2; nan if it is unknown."""
        first = super().pressure(angle)
        if self.material is None:
            return first
        made, force = self.mechanism, self.contact(angle)
        curvature = 1 / made.roller.roller_radius - self.cam.sense * made.other.profile.curvature(angle)
        second = hertz_pressure(-force, made.stock.thickness, curvature, self.material, self.material)
        return np.where(force < 0, second, first)

    @property
    def carried(self) -> tuple[Complex, Complex]:
        first, second = self.cam.contact(self.angles), self.mechanism.other.contact(self.angles)
        turned, is_on_second = self.mechanism.turned, self.forces.contact < 0
        place = np.where(is_on_second, turned * second.point, first.point)
        return place, np.where(is_on_second, turned * second.normal, first.normal)


@record(kw_only=True)
class ConjugateCamsRecipe(AbstractPositiveCamRecipe):
    """Two cams on one shaft that move one follower both ways: rollers on an arm or a yoke, motion, play, plates."""

    aspect_kinds: ClassVar[AspectKinds] = (ConjugateLoadsAspect,)
    additions: ClassVar[Additions] = CamAdditions(refused=("loads.friction", *FLAT_FOLLOWERS))
    kind: Literal["conjugate-cams"] = "conjugate-cams"
    second: SecondCam = entry("the second cam and the clearance of both", default=SecondCam())

    @cached_property
    def made(self) -> MadeConjugateCams:
        """The cams in their setting."""
        return MadeConjugateCams(
            self.cam, self.drive, self.stock, self.base, self.setting, self.has_snap_pins, self.second
        )

    def wall_columns(self, angle: Real) -> Iterator[Column]:
        made = self.made
        contact = made.other.contact(angle)
        meaning = "angle between the path of the second roller and the force on it"
        yield Column("second_pressure_angle", "deg", meaning, np.degrees(contact.pressure_angle))
        words, profile = (
            "profile of the second cam, in the frame of both",
            made.turned * made.other.profile.point(angle),
        )
        yield from xy_columns("second_profile", "mm", words, profile)

    @property
    def wall_checks(self) -> Iterator[Check]:
        other = self.made.other
        whole = Undercut(other, other.profile, np.empty((0, 2)), np.empty(0, complex))
        for check in cam_checks(other, whole):
            if check.id in OF_BOTH:
                advice = check.advice.replace("base_radius", "second.base_radius")
                yield replace(
                    check, id=f"second_{check.id}", name=f"{check.name}, second cam", column="", advice=advice
                )

    def shown(self, table: Table, limits: Sequence[Limit] = ()) -> Scene:
        """The first cam and its roller, the arm or yoke, the second cam and its roller above each other."""
        scene = self.layered(table, limits, ["second"], 0, 1)
        cam, roller = (next(body for body in scene.bodies if body.name == name) for name in ("cam", "roller"))
        angle = np.radians(np.asarray(table["cam_angle"], dtype=float))
        centre = np.asarray(self.cam.follower_pose(angle).place(self.made.second_centre))
        second = tuple(part for part in self.parts if part.name == "second")
        above = (
            replace(cam, name="second", parts=second, layer=cam.layer + 2),
            SceneBody("second_roller", roller.parts, centre, roller.direction, cam.layer + 2),
        )
        mark = SceneMark("pin", centre, "construction", "second roller")
        return replace(scene, bodies=(*scene.bodies, *above), marks=(*scene.marks, mark))

    @property
    def own_scene(self) -> Scene:
        scene = super().own_scene
        plots = (Plot("pressure angle of the second cam", ("second_pressure_angle",)),)
        return replace(scene, plots=(*scene.plots, *plots))

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        made = self.made
        centre = np.asarray(self.cam.follower_pose(self.drive.angles).place(made.second_centre))
        handles = [circle_handle("second.clearance", radius=made.half_width, centre=centre, label="clearance")]
        if self.second.base_radius is not None:
            handles.append(
                circle_handle("second.base_radius", radius=self.second.base_radius, label="second base circle")
            )
        return (*super().handles, *handles)

    @property
    def quantities(self) -> Mapping[str, str]:
        made = self.made
        apart = abs(made.second_centre - made.roller.centre)
        return {**super().quantities, "distance of the rollers": f"{mm(apart):.6g}"}

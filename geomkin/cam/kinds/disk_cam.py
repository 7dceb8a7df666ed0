"""Recipe of a disk cam, and its formulas with the numbers put in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, to_digits
from ...core.names import read_text_file
from ...core.records import record
from ...core.units import UNITS, LengthUnit, mm
from ...making.assembly import Assembly, BaseStock
from ...model.check import Check, WorkedFormula, WorkedFormulas
from ...model.material import Mass
from ...model.motor import RotatingBody
from ...model.part import Part
from ...model.scene import Limit, Scene, SceneHandle
from ...model.table import Table
from ...plane.vec import Real
from ...recipe.composed import AbstractComposedRecipe, AspectKinds
from ...recipe.recipe import Additions, assembly_summary
from ...recipe.settings import BodyMass, Drive, Files
from ...recipe.template import example
from ..base_circle import least_base_circle
from ..cam import Cam
from ..checks import LEAST_CONVEX_RADIUS, cam_checks, cam_table, most_pressure_angle
from ..followers.flat import TranslatingFlat
from ..followers.follower import FOLLOWERS, side_sign
from ..followers.roller import OscillatingRoller, TranslatingRoller
from ..parts import CamStock
from ..program.laws import LAWS, largest
from ..program.placed_segments import place_segments
from ..program.program import Program
from ..program.segments import (
    Dwell,
    LiftPolynomial,
    LiftSpline,
    LiftTable,
    OptimisedPolynomial,
    OptimisedSpline,
    Return,
    Rise,
    Segment,
)
from ..scene import cam_handles, cam_scene, with_size_plot
from .made import CamLoadsAspect, CamLoadsTable, MadeCam

# Laws as formulas of x, or of the angle phi: its start and range in deg, the lift, and its derivatives by
# x. The parabolic one is that of its first half, and those in several pieces are that of the second of them.
FORMS: dict[str, tuple[tuple[float, float], str, str, str]] = {
    "uniform": ((0, 0), "{x}", "1", "0"),
    "parabolic": ((0, 0), "2 {x}^2", "(4 {x})", "4"),
    "harmonic": ((0, 180), "(1 - cos({phi} deg)) / 2", "{pi} sin({phi} deg) / 2", "{pi}^2 cos({phi} deg) / 2"),
    "cycloidal": ((0, 360), "({x} - sin({phi} deg) / (2 {pi}))", "(1 - cos({phi} deg))", "2 {pi} sin({phi} deg)"),
    "modified-trapezoid": (
        (0, 0),
        "8 {pi} (({x} - 1 / 8)^2 / 2 + ({x} - 1 / 8) / (4 {pi}) + 1 / (32 {pi}) - 1 / (16 {pi}^2)) / (2 + {pi})",
        "8 {pi} ({x} - 1 / 8 + 1 / (4 {pi})) / (2 + {pi})",
        "8 {pi} / (2 + {pi})",
    ),
    "modified-sine": (
        (60, 240),
        "(2 + {pi} {x} - 9 sin({phi} deg) / 4) / (4 + {pi})",
        "{pi} (1 - 3 cos({phi} deg)) / (4 + {pi})",
        "4 {pi}^2 sin({phi} deg) / (4 + {pi})",
    ),
    "3-4-5": (
        (0, 0),
        "(10 {x}^3 - 15 {x}^4 + 6 {x}^5)",
        "(30 {x}^2 - 60 {x}^3 + 30 {x}^4)",
        "(60 {x} - 180 {x}^2 + 120 {x}^3)",
    ),
    "4-5-6-7": (
        (0, 0),
        "(35 {x}^4 - 84 {x}^5 + 70 {x}^6 - 20 {x}^7)",
        "(140 {x}^3 - 420 {x}^4 + 420 {x}^5 - 140 {x}^6)",
        "(420 {x}^2 - 1680 {x}^3 + 2100 {x}^4 - 840 {x}^5)",
    ),
}
# Where the pieces of these end, as shares of the segment.
PIECES = {"modified-trapezoid": (1 / 8, 3 / 8), "modified-sine": (1 / 8, 7 / 8)}
# Place in a segment of the frame whose numbers are put in: near the peak of its acceleration, and in the first half.
PLACE = 0.3


def cam_formulas(cam: Cam, angles: Real, rates: tuple[float, float], unit: LengthUnit) -> tuple[WorkedFormula, ...]:
    """Lift, velocity, acceleration and pressure angle in a frame of the first segment whose law is a plain formula.

    angles: of the cam in all frames, deg. rates: its speed and acceleration, rad/s and rad/s2.
    """
    placed = place_segments(cam.program.segments, cam.program.folder)
    found = next((p for p in placed if isinstance(p.segment, Rise | Return) and p.segment.law in FORMS), None)
    if found is None:
        return ()
    is_arm, law = cam.follower.oscillates, str(getattr(found.segment, "law", ""))
    size, length = (float(np.radians(1.0)), "rad") if is_arm else (float(unit.of(1.0)), unit.name)
    wanted = (found.start + PLACE * (found.end - found.start)) % 360
    row = int(np.argmin(np.abs(angles - wanted)))
    x = float((angles[row] - found.start) % 360) / (found.end - found.start)
    low, high = PIECES.get(law, (0.0, 0.5))
    if not low < x < high:
        return ()
    (start_deg, range_deg), *forms = FORMS[law]
    worked = WorkedFormulas(f"VDI 2143 Blatt 1, the law {law}")
    worked.give("theta", "cam angle in this frame", angles[row], "deg")
    worked.give("theta_0", "cam angle at the start of the segment", found.start % 360, "deg")
    worked.give("beta", "range of the segment", found.end - found.start, "deg")
    start = worked.give("s_0", "lift at the start of the segment", found.lift * size, length)
    rise = worked.give("h", "change of the lift in the segment", (found.end_lift - found.lift) * size, length)
    rate = worked.give("omega", "angular velocity of the cam", rates[0], "rad/s")
    alpha = worked.give("alpha", "angular acceleration of the cam", rates[1], "rad/s2")
    worked.add("place in the segment, from 0 to 1", "x", "({theta} - {theta_0}) / {beta}", x)
    width = worked.add("range of the segment", "B", "{beta} {pi} / 180", found.radians, "rad")
    if range_deg:
        template = f"{start_deg:g} + {range_deg:g} {{x}}" if start_deg else f"{range_deg:g} {{x}}"
        worked.add("angle of the law", "phi", template, start_deg + range_deg * x, "deg")
    values = np.asarray(LAWS[law](np.array([x])))[:, 0] * rise
    words = "angle of the arm from its start" if is_arm else "lift"
    lift = worked.add(words, "s", f"{{s_0}} + {{h}} {forms[0]}", start + values[0], length)
    first = worked.add(
        "its derivative by the cam angle", "s_1", f"{{h}} {forms[1]} / {{B}}", values[1] / width, f"{length}/rad"
    )
    second = worked.add(
        "its second derivative", "s_2", f"{{h}} {forms[2]} / {{B}}^2", values[2] / width**2, f"{length}/rad2"
    )
    worked.add("velocity", "v", "{s_1} {omega}", first * rate, f"{length}/s")
    value = second * rate**2 + first * alpha
    worked.add("acceleration", "a", "{s_2} {omega}^2 + {s_1} {alpha}", value, f"{length}/s2")
    return (*worked.formulas, *_pressure(cam, unit, worked.numbers, lift, first, second))


def _pressure(
    cam: Cam, unit: LengthUnit, numbers: dict[str, float], lift: float, first: float, second: float
) -> tuple[WorkedFormula, ...]:
    """The pressure angle of a roller, or the radius of curvature under a flat face that moves straight."""
    worked = WorkedFormulas("Norton, Design of Machinery, chapter 8", numbers)
    base = worked.give("R_b", "radius of the base circle", unit.of(cam.base_radius), unit.name)
    if roller := cam.follower.roller_radius:
        worked.give("R_r", "radius of the roller", unit.of(roller), unit.name)
    else:
        worked.numbers["R_r"] = 0.0
    prime = float(unit.of(cam.prime_radius))
    match cam.follower:
        case TranslatingRoller(offset=offset):
            e = worked.give("e", "offset, positive where it helps the rise", cam.sense * unit.of(offset), unit.name)
            template, value = "sqrt(({R_b} + {R_r})^2 - {e}^2) + {s}", np.sqrt(prime**2 - e * e) + lift
            height = worked.add("height of the roller's centre above the cam's axis", "H", template, value, unit.name)
            template, value = "atan2({s_1} - {e}, {H})", np.degrees(np.arctan2(first - e, height))
            worked.add("pressure angle", "mu", template, value, "deg")
        case OscillatingRoller(pivot_distance=distance, arm_length=arm, side=side):
            c = worked.give("c", "distance of the pivot from the cam's axis", unit.of(distance), unit.name)
            reach = worked.give("L", "length of the arm", unit.of(arm), unit.name)
            tau = worked.give("tau", "1 or -1, by the direction of the cam and the side", cam.sense * side_sign(side))
            template = "arccos(({c}^2 + {L}^2 - ({R_b} + {R_r})^2) / (2 {c} {L})) + {s} 180 / {pi}"
            value = np.degrees(np.arccos((c * c + reach**2 - prime**2) / (2 * c * reach)) + lift)
            psi = np.radians(worked.add("angle of the arm at its pivot", "psi", template, value, "deg"))
            template = "atan2({L} (1 + {tau} {s_1}) - {c} cos({psi} deg), {c} sin({psi} deg))"
            value = np.degrees(np.arctan2(reach * (1 + tau * first) - c * np.cos(psi), c * np.sin(psi)))
            worked.add("pressure angle", "mu", template, value, "deg")
        case TranslatingFlat():
            template, value = "{R_b} + {s} + {s_2}", base + lift + second
            worked.add("radius of curvature of the profile", "rho", template, value, unit.name)
    return tuple(worked.formulas)


# Rows of a cycloidal rise, so that the curve through them rests at both ends.
ROWS = ((120.0, 0.0), (140.0, 0.577), (160.0, 3.91), (180.0, 10.0), (200.0, 16.09), (220.0, 19.423), (240.0, 20.0))
# For each kind of segment, an example that lifts a follower from rest at 120 deg to rest at 240 deg.
LIFTS: dict[str, Segment] = {
    "rise": Rise("3-4-5", rise=20, end_deg=240),
    "polynomial": LiftPolynomial(
        rise=20, end_deg=240, start_velocity_per_rad=0, start_acceleration_per_rad2=0,
        end_velocity_per_rad=0, end_acceleration_per_rad2=0,
    ),
    "optimised-polynomial": OptimisedPolynomial(rise=20, end_deg=240),
    "optimised-spline": OptimisedSpline(rise=20, end_deg=240),
    "spline": LiftSpline(points=ROWS),
    "table": LiftTable(3, rows=ROWS),
}  # fmt: skip


class CamAdditions(Additions):
    """A further segment of the programme."""

    def changes(self, recipe: AbstractCamRecipe, key: str) -> Iterator[Mapping[str, Any]]:
        segments = recipe.cam.program.segments
        if key == "cam.program" and (whole := getattr(segments[-1], "end_deg", None)) is not None:
            # The last segment gets shorter, and a dwell fills its end.
            *_, start, end = recipe.cam.program.breaks
            middle = to_digits(np.degrees(start + end) / 2)
            dwell = {"kind": "dwell", "end_deg": whole}
            yield {f"{key}[{len(segments) - 1}].end_deg": middle, f"{key}[{len(segments)}]": dwell}


@record(kw_only=True)
class AbstractCamRecipe(AbstractComposedRecipe):
    """Base class of recipes of a cam and its follower."""

    can_be_scaled: ClassVar[bool] = True
    aspect_kinds: ClassVar[AspectKinds] = (CamLoadsAspect,)
    additions: ClassVar[Additions] = CamAdditions()
    kind: str
    cam: Cam
    drive: Drive = entry("how the cam turns", default=Drive())
    loads: CamLoadsTable | None = entry(
        "mass, spring, force and friction of the follower; the table then has the contact force and the torque",
        default=None,
    )
    stock: CamStock = entry("sheet, bores and bars of cam and follower", default=CamStock())
    base: BaseStock | None = entry(
        "a base plate that holds the shaft, and the pivot of an arm or the guide of a stem; none if omitted",
        default=None,
    )
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        speed = self.drive.speed_rpm
        if speed < 0:
            other = "counterclockwise" if self.cam.direction == "clockwise" else "clockwise"
            remedy = f'give {-speed:g}, and direction = "{other}" in [cam]'
            problem = f"found {speed:g}; cam.direction sets the direction instead"
            raise DesignError("drive.speed_rpm", problem, remedy, "out-of-range")
        self.drive.check_rows()
        for aspect in self.aspects:
            aspect.check()

    @property
    def design(self) -> Cam:
        return self.cam

    @cached_property
    def made(self) -> MadeCam:
        """The cam in its setting."""
        return MadeCam(self.cam, self.drive, self.stock, self.base, self.setting, self.has_snap_pins)

    @property
    def own_table(self) -> Table:
        made = self.made
        return cam_table(self.cam, made.speed, self.drive.angles, made.cut, made.acceleration)

    @property
    def own_checks(self) -> tuple[Check, ...]:
        return cam_checks(self.cam, self.made.cut)

    @property
    def parts(self) -> tuple[Part, ...]:
        return self.made.parts

    @property
    def body_masses(self) -> Mapping[str, Mass]:
        return self.made.masses

    @property
    def assembly(self) -> Assembly:
        """Shafts, pins and collars of cam and follower, and the steps of assembly."""
        return self.made.assembly

    @property
    def own_scene(self) -> Scene:
        """Cam and follower in contact."""
        scene = cam_scene(self.cam, self.table, self.parts, self.made.cut, self._limits())
        return with_size_plot(scene, self.cam)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """The cam, whose angle counts in its own direction."""
        return {"cam": RotatingBody(0j, Fraction(self.cam.sense))}

    def scene_at(self, turn: Real) -> Scene:
        table = cam_table(self.cam, self.made.speed, np.remainder(turn, 2 * np.pi), self.made.cut)
        return cam_scene(self.cam, table, self.parts, self.made.cut)

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(cam_handles(self.cam, self.drive.angles))

    @property
    def quantities(self) -> Mapping[str, str]:
        """Largest lift, range of the pressure angle, and the lift lost to undercut."""
        unit, size = self.cam.follower.lift_unit
        lost, breaks = self.made.cut.worst[0] * size, self.cam.program.breaks
        lift = largest(breaks, lambda angle: self.cam.program.motion(angle).lift)[0] * size

        def extreme_deg(sign: int) -> float:
            value = largest(breaks, lambda angle: sign * self.cam.contact(angle).pressure_angle)[0]
            # Smaller angles are rounding; adding 0 removes the sign of -0.
            return round(sign * float(np.degrees(value)), 9) + 0.0

        return {
            "largest lift": f"{mm(lift, unit=unit):.4g}",
            "pressure angle": f"{extreme_deg(-1):.3g} to {extreme_deg(1):.3g} deg",
            "undercut": f"loses {mm(lost, unit=unit):.3g} of lift" if lost else "none",
        }

    def _limits(self) -> tuple[Limit, ...]:
        most, roller = most_pressure_angle(self.cam), self.cam.follower.roller_radius
        curvature = (
            Limit("pitch_curvature", 1 / roller, "1 / roller radius: undercut above")
            if roller
            else Limit("profile_curvature", 1 / LEAST_CONVEX_RADIUS, "sharper edges wear")
        )
        angles = (Limit("pressure_angle", side * most, f"at most {most:g} deg") for side in (1.0, -1.0))
        return (*angles, curvature)

    @property
    def sources(self) -> Mapping[str, str]:
        program = self.cam.program
        names = [segment.file for segment in program.segments if isinstance(segment, LiftTable) and segment.file]
        return {name: read_text_file(name, program.folder, "a CSV file") for name in names}

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """Lift, velocity, acceleration and pressure angle in one frame, if a segment's law is a plain formula."""
        rates, angles = (self.made.speed, self.made.acceleration), self.table.columns[0].values
        return cam_formulas(self.cam, angles, rates, UNITS[self.units])

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        """Peaks of each segment, least base circle for the usual pressure angle, optimised segments and undercut."""
        cam = self.cam
        notes: dict[str, object] = {"peaks": self._peaks()}
        try:
            least = least_base_circle(cam.follower, cam.program, cam.direction, most_pressure_angle(cam))
            notes["least_base_circle"] = {"radius_mm": to_digits(least.radius), "limit": least.limit}
        except DesignError as error:
            notes["least_base_circle"] = {"none": error.problem}
        if cam.program.optima:
            notes["optimised_segments"] = [
                {
                    "segment": k + 1,
                    "peak_acceleration": to_digits(best.peak_acceleration),
                    "proven_least": to_digits(best.bound),
                    "peak_jerk": to_digits(best.peak_jerk),
                    "units": "rad/rad2, rad/rad3" if cam.follower.oscillates else "mm/rad2, mm/rad3",
                }
                for k, best in sorted(cam.program.optima.items())
            ]
        return notes, {**assembly_summary(self), **({"undercut": self._undercut()} if self.made.cut.found else {})}

    def _peaks(self) -> dict[str, dict[str, object]]:
        """For each segment that moves: the peaks of its derivatives by cam angle, and its peak factors."""
        unit = "rad" if self.cam.follower.oscillates else "mm"
        entries: dict[str, dict[str, object]] = {}
        for k, peaks in self.cam.program.peaks.items():
            segment = self.cam.program.segments[k]
            law = getattr(segment, "law", segment.kind)
            sizes = {"velocity": peaks.velocity, "acceleration": peaks.acceleration, "jerk": peaks.jerk}
            sizes |= dict(zip(("Cv", "Ca", "Cj"), peaks.factors))
            entries[f"segment_{k + 1}"] = (
                {"law": law if isinstance(law, str) else "given", "units": f"{unit}/rad, {unit}/rad2, {unit}/rad3"}
                | {name: to_digits(value) for name, value in sizes.items()}
            )  # fmt: skip
        return entries

    @property
    def facts(self) -> tuple[str, ...]:
        """Peak factors of each segment whose lifts at start and end differ."""
        factors = "Cv {Cv:.4g}, Ca {Ca:.4g}, Cj {Cj:.4g}"
        return tuple(
            f"{name.replace('_', ' ')}, {peaks['law']}: {factors.format(**peaks)}"
            for name, peaks in self._peaks().items()
            if peaks["Cv"] == peaks["Cv"]
        )

    @property
    def forces_missing(self) -> str:
        return "" if self.loads else "Contact force and camshaft torque are computed with the table loads."

    def _undercut(self) -> Mapping[str, object]:
        (lost, at), (unit, size) = self.made.cut.worst, self.cam.follower.lift_unit
        return {
            f"lost_lift_{unit}": to_digits(lost * size),
            "worst_at_deg": to_digits(np.degrees(at), 5),  # the angle of a flat peak has no more certain digits
            "spans_deg": [[to_digits(np.degrees(a)) for a in span] for span in self.made.cut.spans],
        }

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """Follower and programme of the requested kinds; lifts of an arm are as many degrees as the others are mm."""
        follower = example(FOLLOWERS[tables.get("cam.follower", "translating-roller")])
        lift = LIFTS.get(tables.get("cam.program", "rise"), LIFTS["rise"])
        if follower.oscillates:
            values = vars(lift)
            in_mm = [field.name for field in fields(lift) if f"{field.name}_deg" in values]
            in_degrees: dict[str, Any] = dict.fromkeys(in_mm) | {f"{name}_deg": values[name] for name in in_mm}
            lift = replace(lift, **in_degrees)
        loads = {"loads": CamLoadsTable(BodyMass(0.4))} if "loads" in tables else {}
        return {
            **loads,
            "cam.base_radius": follower.example_base_radius,
            "cam.follower": follower,
            "cam.program": Program((Dwell(end_deg=120), lift, Return("cycloidal", end_deg=360))),
        }


@record(kw_only=True)
class DiskCamRecipe(AbstractCamRecipe):
    """A disk cam and its follower, roller or flat face, straight or on an arm: plates, motion, profile coordinates."""

    takes_snap_pins: ClassVar[bool] = True
    kind: Literal["disk-cam"] = "disk-cam"

"""Recipes of linkages: the motion of every body, the plates, and how they are stacked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, ClassVar

from ...core.errors import DesignError
from ...core.field_visitor import key_parts
from ...core.fields import entry
from ...core.records import record
from ...core.units import UNITS, mm
from ...gear.checks import mesh_checks
from ...gear.kinds.helical import gear_notes, mesh_notes
from ...making.attachments import hub_thickness
from ...making.materials import MATERIALS
from ...making.motors import engagement_check
from ...model.check import Check
from ...model.material import Mass
from ...model.motor import RotatingBody
from ...model.part import Part
from ...model.scene import Limit, Scene, SceneHandle
from ...model.table import Table
from ...plane.vec import Complex, Real
from ...recipe.aspect import Setting, Standing
from ...recipe.composed import AbstractComposedRecipe, AspectKinds
from ...recipe.recipe import Additions, mass_summary
from ...recipe.settings import STANDARD_GRAVITY, Files, Stroke, Turn
from ..checks import LEAST_TRANSMISSION_ANGLE_DEG, collision_advice, collision_check, hole_check, linkage_checks
from ..joints.slide import are_equal
from ..linkage import AbstractLinkage
from ..measures import steady_bodies
from ..motion import motion_table
from ..parts.gears import gear_pair
from ..parts.layers import passed_attachments
from ..parts.rotating_masses import Flywheel, RoundEnd
from ..parts.stack import MOTOR_PLATE
from ..parts.stock import LinkStock
from ..scene import linkage_scene, motion_plots
from ..scene_handles import size_columns, size_plot
from .aspects import (
    BothModesAspect,
    ComponentsAspect,
    CopiesAspect,
    DwellAspect,
    DwellBand,
    StraightLineAspect,
    StraightLineTable,
    moving_points,
    other_mode_scene,
    straight_line_entry,
)
from .copies import Copy, copies_entry, is_whole_turn
from .loaded import LoadsAspect
from .loads import LoadsTable, loads_entry
from .made import DrivenLinkage, MadeLinkage
from .moved import (
    AbstractMovedRecipe,
    Branches,
    JointAdditions,
    SideOrFollow,
    both_modes_entry,
    branch_entry,
    branch_of,
    branches_entry,
    coefficients_entry,
    components_entry,
)
from .stance import StandingAspect, check_foot, standing_of
from .tolerances import TolerancesAspect, TolerancesTable, tolerances_entry


class LinkageAdditions(JointAdditions):
    """Names of bodies, points and slides, and the stroke of a slide that the driver moves."""

    def names(self, recipe: AbstractLinkageRecipe) -> Mapping[str, Sequence[Any]]:
        linkage = recipe.linkage.linkage
        moving = [*linkage.bodies][:0:-1]
        points = list(dict.fromkeys(point for body in moving for point in linkage.bodies[body]))
        pivoted = [body for body in moving if {*linkage.bodies[body]} & {*linkage.bodies[linkage.ground]}]
        return {
            "body": moving,
            "point": points,
            "to_body": [linkage.ground],
            "pin": list(linkage.pins),
            "slide": [slider.name for slider in linkage.sliders],
            "bodies": [[body] for body in pivoted],
            "base": [[*linkage.bodies[body]][:2] for body in moving if len(linkage.bodies[body]) > 1],
            "loads.masses": moving,
        }

    def unavailable(self, recipe: AbstractLinkageRecipe) -> Iterator[str]:
        yield from super().unavailable(recipe)
        linkage, names = recipe.linkage.linkage, self.names(recipe)
        if recipe.made.foot is None:
            yield "loads.carried"
        if linkage.driver_pivot is None:
            yield from ("loads.motor", "loads.motors", "loads.run", "stock.motor")
        if linkage.driven_slider is None:
            yield "loads.actuator"
        if not names["bodies"]:
            yield "loads.counterweights"
        if not moving_points(linkage):
            yield "straight_line"
        if not names["slide"]:
            yield from ("loads.slide_forces", "loads.slide_friction")


class AbstractLinkageRecipe(AbstractMovedRecipe, AbstractComposedRecipe):
    """Base class of recipes whose linkage is moved, checked, stacked and cut."""

    aspect_kinds: ClassVar[AspectKinds] = (
        ComponentsAspect,
        DwellAspect,
        StraightLineAspect,
        LoadsAspect,
        TolerancesAspect,
        BothModesAspect,
        StandingAspect,
        CopiesAspect,
    )
    additions: ClassVar[Additions] = LinkageAdditions()
    takes_snap_pins: ClassVar[bool] = True
    stock: LinkStock

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_stroke()
        if self.has_snap_pins and any(getattr(self, key, None) for key in ("copies", "foot")):
            problem = "found snap, but copies share rods"
            raise DesignError("printing.pins", problem, 'give "bought", or omit copies and foot', "conflict")
        self.input_range.check_rows(self.made.most_columns + sum(aspect.most_columns for aspect in self.aspects))
        try:
            for aspect in self.aspects:
                aspect.check()
        except DesignError as error:
            name = key_parts(error.field)[0]
            if name in self.__dataclass_fields__:
                raise
            # The motion, which some of them need, names a field of the linkage.
            key = f"linkage.{error.field}" if hasattr(self.linkage, str(name)) else "linkage"
            raise error.named(key) from None

    @cached_property
    def made(self) -> MadeLinkage:
        """The linkage in its setting, with its copies as plates in layers."""
        branch, given = branch_of(self.branch, self.branches), partial(getattr, self)
        columns = given("coefficients", False), given("effective_components", False)
        driven = (self.linkage, branch, self.input_range, self.setting, *columns, UNITS[self.units])
        plates = given("copies", ()), given("foot", None), self._round_ends, self._flywheel
        made = MadeLinkage(*driven, self.stock.snapped if self.has_snap_pins else self.stock, *plates)
        loads = given("loads", None)
        return replace(made, given_masses=loads.given_masses, carried=loads.carried) if loads else made

    def _round_ends(self) -> dict[str, RoundEnd]:
        return {body: end for aspect in self.aspects for body, end in aspect.round_ends.items()}

    def _flywheel(self) -> Flywheel | None:
        return next((wheel for aspect in self.aspects if (wheel := aspect.flywheel)), None)

    @property
    def assembly(self) -> MadeLinkage:
        """Items to buy and assembly steps."""
        return self.made

    @property
    def attached(self) -> Iterator[tuple[str, Any, float, int]]:
        """None: the assembly of the plates has them."""
        return iter(())

    @property
    def further_handles(self) -> Iterator[SceneHandle]:
        """The ends of a stroke, and the places of the aspects."""
        yield from super().further_handles
        for aspect in self.aspects:
            yield from aspect.handles

    @property
    def own_table(self) -> Table:
        return self.made.table_of(self.motion)

    @property
    def own_scene(self) -> Scene:
        """The moving plates; also the other assembly mode, if there is one."""
        least = LEAST_TRANSMISSION_ANGLE_DEG
        limit = Limit("transmission_angle", least, f"at least {least:g} deg")
        # Only the page shows the effects of sizes, no file of numbers.
        effects = size_columns(self.motion)
        plots = (*motion_plots(self.motion, self.table, [limit]), *size_plot(effects))
        table, layers = Table((*self.table.columns, *effects)), {MOTOR_PLATE: -1, **self.made.stack.layers}
        return linkage_scene(self.motion, table, self.made.own_parts, layers, plots, other_mode_scene(self.made))

    @property
    def own_checks(self) -> tuple[Check, ...]:
        collisions = [collision for stack in dict.fromkeys(self.made.stacks) for collision in stack.collisions]
        hole = hole_check(self.stock.hole_diameter, self.stock.thickness)
        meshes = self.linkage.linkage.meshes
        pairs = ((mesh.name, gear_pair(mesh, self.linkage.linkage, self.stock)) for mesh in meshes)
        gears = (check for name, pair in pairs for check in mesh_checks(pair, name))
        checks = (*self.motion_checks, hole, collision_check(len(collisions), collision_advice(collisions)), *gears)
        return (*checks, _attachment_check(self.made)) if self.stock.attachments else checks

    @property
    def engagement_checks(self) -> Iterator[Check]:
        """Whether the crank, or a hub on it, engages the shaft of the motor."""
        stock, stack, linkage = self.stock, self.made.stack, self.linkage.linkage
        if stock.motor is not None:
            crank, pivot = linkage.driver, complex(linkage.bodies[linkage.driver][str(linkage.driver_pivot)])
            layers = [layer for name, layer in stack.layers.items() if stack.plates[name].body == crank]
            attached = (item for item, middle in stack.plates[crank].attached if are_equal(middle, pivot))
            below = (min(layers) + stack.motor_plates) * stock.thickness
            yield engagement_check(stock.motor, len(layers) * stock.thickness + hub_thickness(attached), below)
        if self.has_snap_pins:
            yield from self.made.snap_checks

    @property
    def motion_checks(self) -> tuple[Check, ...]:
        return (*linkage_checks(self.motion), *self.input_range.checks)

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        """Range of the driver and links that turn fully; masses and the stack of plates."""
        swung = {"swings_deg": {name: ends.entry("swing") for name, ends in self.made.swings.items()}}
        slid = {"strokes_mm": {name: ends.entry("stroke") for name, ends in self.made.strokes.items()}}
        moved = {key: each for key, each in (swung | slid).items() if each}
        before = {**self.made.reaches(self.made.branch), **moved, **self.turning, **_gear_notes(self.made)}
        return before, {**mass_summary(self), "stack": self.made.stack_summary}

    @property
    def facts(self) -> tuple[str, ...]:
        """How far bodies swing and slides move."""
        swung = (
            f"{name.replace('_', ' ')} swings by {ends.between:.5g} deg, "
            f"from {ends.least:.5g} to {ends.largest:.5g} deg{ends.ratio_text}"
            for name, ends in self.made.swings.items()
        )
        slid = (
            f"{name.replace('_', ' ')} moves by {mm(ends.between):.5g}, "
            f"from {mm(ends.least, ends.largest, between=' to '):.5g}{ends.ratio_text}"
            for name, ends in self.made.strokes.items()
        )
        return (*swung, *slid)

    @cached_property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        pivot = self.linkage.linkage.driver_pivot if is_whole_turn(self.input_range) else None
        return steady_bodies(self.motion) if pivot and self.motion.assembled.all() else {}

    def scene_at(self, turn: Real) -> Scene:
        motion, rows = self.made.moved_at(turn)
        made = self.made
        scene = linkage_scene(motion, motion_table(motion), made.own_parts, made.stack.layers, rates=False)
        for aspect in self.aspects:
            scene = aspect.with_bodies(scene, motion)
        return scene.at_frames(rows)

    def shaking_at(self, turn: Real) -> tuple[Complex, Real] | None:
        loads: LoadsAspect | None = self.aspect(LoadsAspect.key)
        return loads.shaking_at(turn) if loads else None

    @property
    def standing_point(self) -> str:
        foot, loads = getattr(self, "foot", None), getattr(self, "loads", None)
        return "" if foot is None or (loads and loads.pushes(foot)) else foot

    def number_of_feet(self, foot: str) -> int:
        check_foot(foot, self.linkage.linkage)
        loads = getattr(self, "loads", None)
        if loads and loads.pushes(foot):
            problem = f"found one at {foot}, which carries its share of the weight of the machine"
            raise DesignError("recipe.loads.forces", problem, "omit it, or foot of this mechanism", "conflict")
        for key in ("carried", "foot_friction"):
            if loads and getattr(loads, key):
                problem = "is given, but the feet of the machine carry it all"
                raise DesignError(
                    f"recipe.loads.{key}", problem, f"give walker.{key} of the machine instead", "conflict"
                )
        if loads and loads.gravity_m_per_s2 != STANDARD_GRAVITY:
            problem = f"found {list(loads.gravity_m_per_s2)}, but the ground carries the weight of the machine"
            raise DesignError("recipe.loads.gravity_m_per_s2", problem, "omit it", "conflict")
        return 1 + len(self.made.copies)

    def standing_at(self, turn: Real, foot: str, speed: float) -> Standing:
        driven = DrivenLinkage(self.linkage, self.made.branch, self.input_range, Setting(speed, 0.0))
        motion, rows = driven.moved_at(turn)
        return standing_of(self.made, motion, foot).at_frames(rows)

    @property
    def parts(self) -> tuple[Part, ...]:
        return self.made.parts

    @property
    def body_masses(self) -> Mapping[str, Mass]:
        return self.made.masses

    @property
    def forces_missing(self) -> str:
        if getattr(self, LoadsAspect.key, None) is not None:
            return ""
        takes_loads = LoadsAspect.key in self.__dataclass_fields__
        words = "Driver effort and joint forces are computed with the table loads."
        return words if takes_loads else super().forces_missing

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        copies = {"copies": (Copy(180.0),)} if "copies" in tables else {}
        return {**copies, **({"stock.material": MATERIALS["steel-S235"]} if "loads" in tables else {})}

    @property
    def turning(self) -> Mapping[str, object]:
        """Summary of the links that turn fully, if there is a rule."""
        return {}


def _attachment_check(made: MadeLinkage) -> Check:
    passing = list(passed_attachments(made.fine_motion, made.stock, made.stack.plates, made.stack.layers))
    pairs = ", ".join(f"{plate} over the {item}" for item, plate in passing)
    advice = f"{pairs}: give another place, thinner screws, or screws with sunk heads and no nuts"
    name = "plates that pass over attachments and their screws"
    return Check("attachments_passed", name, len(passing), "at most", 0, "", advice)


def _gear_notes(made: MadeLinkage) -> Mapping[str, object]:
    """Data of the gears of meshes by their plates, and of the meshes."""
    wheels = {name: plate for name, plate in made.stack.plates.items() if plate.wheel}
    names = {plate.body: name for name, plate in wheels.items()}
    linkage = made.linkage.linkage
    meshes = {
        "_and_".join(names[body] for body in mesh.bodies): mesh_notes(gear_pair(mesh, linkage, made.stock))
        for mesh in linkage.meshes
    }
    measures = {name: gear_notes(plate.wheel.gear) for name, plate in wheels.items() if plate.wheel}
    return {**meshes, "measures_mm": measures} if meshes else {}


@record(kw_only=True)
class TurningLinkageRecipe(AbstractLinkageRecipe):
    """A linkage whose driver turns."""

    kind: str
    linkage: AbstractLinkage
    branch: SideOrFollow = branch_entry()
    branches: Branches = branches_entry()
    coefficients: bool = coefficients_entry()
    effective_components: bool = components_entry()
    both_modes: bool = both_modes_entry()
    dwell: DwellBand | None = entry("longest dwell of an output", default=None)
    straight_line: StraightLineTable | None = straight_line_entry()
    drive: Turn = entry("how the driver turns", default=Turn())
    loads: LoadsTable | None = loads_entry()
    tolerances: TolerancesTable | None = tolerances_entry()
    copies: tuple[Copy, ...] = copies_entry()
    stock: LinkStock = entry("sheet and pins of the links", default=LinkStock())
    files: Files = entry("what is written", default=Files())


@record(kw_only=True)
class SlidingLinkageRecipe(AbstractLinkageRecipe):
    """A linkage whose driver turns or slides."""

    # The order of the fields is that of templates and summaries.
    kind: str
    linkage: AbstractLinkage
    branch: SideOrFollow = branch_entry()
    branches: Branches = branches_entry()
    coefficients: bool = coefficients_entry()
    effective_components: bool = components_entry()
    both_modes: bool = both_modes_entry()
    dwell: DwellBand | None = entry("longest dwell of an output", default=None)
    straight_line: StraightLineTable | None = straight_line_entry()
    drive: Turn = entry("how the driver turns", default=Turn())
    stroke: Stroke | None = entry("how the driver slides, if a slide drives", default=None)
    loads: LoadsTable | None = loads_entry()
    tolerances: TolerancesTable | None = tolerances_entry()
    stock: LinkStock = entry("sheet and pins of the links", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    # Values of the example in which a slide drives.
    sliding: ClassVar[Mapping[str, object]]

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        # A sliding driver has no shaft that copies could share.
        none = {"copies": ()} if "copies" in tables else {}
        values = super().example_values(tables)
        return {**values, **none, **cls.sliding} if "stroke" in tables else values

"""Recipes of a body's instantaneous motion in a linkage of any kind: its inflection circle, its two centrodes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field, fields, make_dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Annotated, Any, Literal, get_type_hints

import numpy as np

from ...core.arguments import ArgumentType
from ...core.errors import DesignError, shown
from ...core.field_visitor import WrittenForm
from ...core.fields import FARTHEST, ComplexPoint, entry, quantity
from ...core.records import record
from ...core.units import marked, mm
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Scene, SceneHandle, circle_handle
from ...model.table import Column, Table, finite, xy_columns
from ...plane.curve import AbstractCurve
from ...plane.primitives import Arc, Circle, Segment
from ...recipe.settings import Files, Stroke, Turn
from ..checks import LARGEST_DRAWN, assembly_failure, reached
from ..coupler_curve import CouplerCurve
from ..instant.centres import pin_between, slider_between
from ..instant.centrodes import CentrodeCurve, Centrodes
from ..instant.curvature import path_curvature
from ..instant.inflection import inflection_circle
from ..linkage import LINKAGES, AbstractLinkage
from ..motion import Motion, is_translating, on_ground
from ..moving import move
from ..named_linkages import FourBar, SliderCrank
from ..parts.stock import PlateStock, arrow, engraved, skeleton
from ..scene_handles import body_point
from ..scene_instants import centrodes_scene, inflection_scene
from . import linkage_kinds
from .moved import AbstractMovedRecipe, Branches, SideOrFollow, branch_entry, branches_entry

# The kinds that such a table may have. A scotch yoke has no body that turns and is not on a ground pivot.
OF = (
    linkage_kinds.FourBarRecipe,
    linkage_kinds.SliderCrankRecipe,
    linkage_kinds.InvertedSliderCrankRecipe,
    linkage_kinds.StephensonSixBarRecipe,
    linkage_kinds.WattSixBarRecipe,
    linkage_kinds.ShaperRecipe,
    linkage_kinds.EllipticTrammelRecipe,
    linkage_kinds.OldhamCouplingRecipe,
    linkage_kinds.LinkageRecipe,
)
PLAIN: dict[str, type[AbstractLinkage]] = {recipe.kind: get_type_hints(recipe)["linkage"] for recipe in OF}
DEFAULT_KIND = linkage_kinds.FourBarRecipe.kind
for _kind, _plain in PLAIN.items():
    _own = [("kind", Literal[_kind], field(default=_kind))]
    _about = {"__doc__": _plain.__doc__, "__module__": __name__}
    LINKAGES[_kind] = make_dataclass(
        f"{_plain.__name__}Table", _own, bases=(_plain,), namespace=_about, frozen=True, kw_only=True, repr=False
    )


def with_kind(linkage: AbstractLinkage) -> AbstractLinkage:
    """The linkage as the table of a recipe, which has its `kind`."""
    kind = next(kind for kind, plain in PLAIN.items() if isinstance(linkage, plain))
    return LINKAGES[kind](**_values(linkage, PLAIN[kind]))


def without_kind(table: AbstractLinkage) -> AbstractLinkage:
    """The linkage of a table, as the library has it."""
    plain = type(table).__mro__[1]
    return plain(**_values(table, plain))  # type: ignore[no-any-return]


def _values(linkage: AbstractLinkage, plain: type[Any]) -> dict[str, Any]:
    return {f.name: getattr(linkage, f.name) for f in fields(plain)}


class AnyKind(ArgumentType, WrittenForm):
    """Marks a linkage of any kind in `LINKAGES`; in a recipe a table with its `kind`, in Python the linkage itself."""

    def __init__(self) -> None:
        def fits(value: Any) -> bool:
            return any(isinstance(value, plain) and not value.linkage.is_batch for plain in PLAIN.values())

        super().__init__(fits, f"one linkage: {', '.join(plain.__name__ for plain in PLAIN.values())}")

    def read(self, given: Any, folder: Any) -> Any:
        return {"kind": DEFAULT_KIND, **given} if isinstance(given, dict) else given

    def finished(self, value: Any) -> Any:
        return without_kind(value)

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        return {"kind": "", **write(with_kind(value))}

    def schema(self, of_type: dict[str, Any]) -> dict[str, Any]:
        for choice in of_type["allOf"]:
            if choice["if"]["properties"]["kind"]["const"] == DEFAULT_KIND:
                choice["if"]["required"] = []
        return of_type | {"required": []}


# The example in templates.
EXAMPLE = with_kind(FourBar(100, 30, 90, 70, 40 + 25j))


class AbstractBodyRecipe(AbstractMovedRecipe):
    """Base class of recipes about the motion of one body of any linkage."""

    body: str

    def __post_init__(self) -> None:
        super().__post_init__()
        general = self.linkage.linkage
        moving = [name for name in general.bodies if name != general.ground]
        if self.body not in moving:
            raise DesignError("body", f"found {shown(self.body)}", f"give one of {', '.join(moving)}", "unknown-key")

    @property
    def drive_column(self) -> Column:
        """First column of the table."""
        if self.stroke:
            return Column("drive_place", "mm", "displacement of the driver along its line", self.motion.drive)
        words = "angle of the driver from the ground line"
        return Column("drive_angle", "deg", words, np.degrees(self.motion.drive))

    @property
    def what(self) -> str:
        """Name of the driver's range, for the check that it is reached."""
        return f"driver's {'stroke' if self.stroke else 'turn'}"

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        if "stroke" in tables:
            slider_crank = SliderCrank(30, 40, coupler_point=20 + 15j, driver="slider")
            return {"linkage": with_kind(slider_crank), "stroke": Stroke(start=50, end=68)}
        if "linkage" not in tables:
            return {}
        from ...recipe.template import example

        linkage: AbstractLinkage = example(LINKAGES[tables["linkage"]])
        general = linkage.linkage
        free = [name for name in general.bodies if name not in {*on_ground(general), general.ground}]
        return {"linkage": linkage, "body": "coupler" if "coupler" in general.bodies else free[0]}


# Range of the drawn path on each side of the position: rad of the driver, or a share of its stroke.
NEAR, NEAR_OF_STROKE = np.pi / 4, 0.25
# Length of the arc that shows the path's curvature, to both sides, in longest links.
ARC = 0.15
# Distance of a drawn path from its point, in longest links, beyond which it belongs to another branch.
MISSED = 1e-6


@record(kw_only=True)
class InflectionCircleRecipe(AbstractBodyRecipe):
    """A linkage at one position with a body's instant centre, inflection circle and centres of curvature."""

    kind: Literal["inflection-circle"] = "inflection-circle"
    linkage: Annotated[AbstractLinkage, AnyKind()] = entry("the linkage", example=EXAMPLE)
    body: str = entry("the body whose motion is shown", default="coupler")
    point: ComplexPoint | None = entry(
        "point of the body whose path is shown, [x, y] in mm in the body's frame; by default its last named point",
        default=None,
    )
    position_deg: float | None = quantity(
        "driver's angle that is drawn; by default 15", "deg", default=None, at_least=-360, at_most=360
    )
    position_mm: float | None = quantity(
        "driver's displacement that is drawn, if a slide drives; by default the middle of its stroke", "mm",
        default=None, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    branch: SideOrFollow = branch_entry()
    branches: Branches = branches_entry()
    drive: Turn = entry("how the driver turns, for the table", default=Turn())
    stroke: Stroke | None = entry("how the driver slides, if a slide drives", default=None)
    stock: PlateStock = entry("the plate", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        wrong, other, does = ("deg", "mm", "slides") if self.stroke else ("mm", "deg", "turns")
        if (given := getattr(self, f"position_{wrong}")) is not None:
            problem = f"found {given:g}, but the driver {does}"
            raise DesignError(f"position_{wrong}", problem, f"give position_{other} instead", "conflict")

    @property
    def position_key(self) -> str:
        """The key of the drawn position."""
        return "position_mm" if self.stroke else "position_deg"

    @property
    def place(self) -> float:
        """The driver at the drawn position, rad or mm."""
        if self.stroke:
            middle = (self.stroke.start + self.stroke.end) / 2
            return middle if self.position_mm is None else self.position_mm
        return float(np.radians(15.0 if self.position_deg is None else self.position_deg))

    @cached_property
    def position(self) -> Motion:
        """The linkage at the drawn position, on the branch that leads there from the table's first frame."""
        general = self.linkage.linkage
        motion = move(general, [float(self.input_range.frames[0]), self.place], self.made.branch)
        if not motion.assembled[1]:
            alone = move(general, [self.place], self.made.branch)
            given = self.place if self.stroke else np.degrees(self.place)
            problem = f"found {given:g}, which is not reached: {marked(str(assembly_failure(alone)))}"
            raise DesignError(self.position_key, problem, "give another", "does-not-assemble")
        if general.estimate:
            pins = {pin: complex(motion.point(pin).position[1]) for pin in general.pins}
            general = replace(general, estimate=pins)
        return move(general, [self.place], {joint: int(sign[1]) or 1 for joint, sign in motion.solution.signs.items()})

    @cached_property
    def local(self) -> complex:
        """The point whose path is shown, in the body's frame."""
        if self.point is not None:
            return self.point
        named = list(self.linkage.linkage.bodies[self.body].values())
        return complex(named[-1]) if named else 0j

    @cached_property
    def longest(self) -> float:
        """Longest link, mm: between two pins of a body."""
        general = self.linkage.linkage
        pins = ([z for name, z in points.items() if name in general.pins] for points in general.bodies.values())
        links = [abs(complex(a) - complex(b)) for row in pins for a, b in combinations(row, 2)]
        return max(links, default=float(general.size))

    @cached_property
    def table(self) -> Table:
        motion, body = self.motion, self.body
        circle = inflection_circle(motion, body)
        path = path_curvature(motion, body, self.local)
        centre = finite(circle.instant_centre.position)
        return Table(
            (
                self.drive_column,
                *xy_columns("instant_centre", "mm", f"instant centre of the {body}", centre),
                *xy_columns("inflection_pole", "mm", "inflection pole", finite(circle.pole)),
                Column("inflection_diameter", "mm", "diameter of the inflection circle", finite(circle.diameter)),
                *xy_columns("centrode_tangent", "", "direction of the centrode tangent", finite(circle.tangent)),
                *xy_columns(f"{body}_point", "mm", f"{body} point", path.position),
                Column("path_curvature", "1/mm", "curvature of its path, left +", finite(path.curvature)),
                *xy_columns("centre_of_curvature", "mm", "centre of curvature of its path", finite(path.centre)),
            )
        )

    @cached_property
    def scene(self) -> Scene:
        """The circle while the linkage moves."""
        return inflection_scene(self.motion, self.table, self.body, self.local)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        size = inflection_circle(self.position, self.body).diameter[0] / self.longest
        remedy = f"give another {self.position_key}"
        advice = f"near a position with parallel cranks the circle does not fit a plate; {remedy}"
        if is_translating(self.position, self.body):
            advice = f"the {self.body} does not turn, and has no such circle; give another body"
        at = self.place if self.stroke else float(np.degrees(self.place))
        name, column = "inflection diameter to longest link", "inflection_diameter"
        check = Check("inflection_diameter", name, size, "at most", LARGEST_DRAWN, "", advice, column, at)
        return (check, *self.input_range.checks)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        motion, stock = self.position, self.stock
        circle = inflection_circle(motion, self.body)
        centre, pole = complex(circle.instant_centre.position[0]), complex(circle.pole[0])
        diameter = circle.diameter[0]
        marks = skeleton(motion, 0, stock)
        if 0 < diameter <= LARGEST_DRAWN * self.longest:
            tangent, dot = complex(circle.tangent[0]), stock.pin_diameter / 4
            marks += [Circle((centre + pole) / 2, float(diameter) / 2), Circle(centre, dot), Circle(pole, dot)]
            marks += [*arrow(centre, pole), Segment(centre - tangent * diameter / 2, centre + tangent * diameter / 2)]
        return (engraved("inflection-circle", marks + self._path(), stock),)

    def _path(self) -> list[AbstractCurve]:
        """The point, its path nearby, and the osculating arc about its centre of curvature."""
        path = path_curvature(self.position, self.body, self.local)
        point = complex(path.position[0])
        marks = self._near(point)
        centre, radius = complex(path.centre[0]), abs(float(path.radius[0]))
        if 1e-3 < radius < LARGEST_DRAWN * self.longest:
            half = min(np.pi, ARC * self.longest / radius)
            marks += [Arc(centre, centre + (point - centre) * np.exp(-1j * half), 2 * half)]
            marks += [Circle(centre, self.stock.pin_diameter / 4), Segment(centre, point)]
        return [*marks, Circle(point, self.stock.pin_diameter / 4)]

    def _near(self, point: complex) -> list[AbstractCurve]:
        """The path near the position, on the branch of the linkage; none if it opens there."""
        position, name = self.position, "traced"
        general = position.linkage
        while any(name in points for points in general.bodies.values()):
            name += "_"
        bodies = {**general.bodies, self.body: {**general.bodies[self.body], name: self.local}}
        half = NEAR_OF_STROKE * (self.stroke.end - self.stroke.start) if self.stroke else NEAR
        try:
            span = (self.place - half, self.place + half)
            curve = CouplerCurve(replace(general, bodies=bodies), name, position.solution.spec, span)
        except DesignError:
            return []
        missed = abs(complex(curve.point(self.place)) - point)
        return [curve] if missed <= MISSED * self.longest else []


@record(kw_only=True)
class CentrodesRecipe(AbstractBodyRecipe):
    """Fixed and moving centrode of a linkage's body on two plates: the second curve rolls on the first."""

    kind: Literal["centrodes"] = "centrodes"
    linkage: Annotated[AbstractLinkage, AnyKind()] = entry("the linkage", example=EXAMPLE)
    body: str = entry("the body whose centrodes are drawn", default="coupler")
    branch: SideOrFollow = branch_entry()
    branches: Branches = branches_entry()
    reach: float = quantity(
        "largest distance from the body's origin (of a coupler its crank pin) to which the centrodes are drawn", "mm",
        default=200.0, above=0, at_most=10_000,
    )  # fmt: skip
    drive: Turn = entry("how the driver turns", default=Turn())
    stroke: Stroke | None = entry("how the driver slides, if a slide drives", default=None)
    stock: PlateStock = entry("the plates", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        general = self.linkage.linkage
        pair = general, general.ground, self.body
        if pin_between(*pair) or slider_between(*pair):
            does = "turns about a pin of" if pin_between(*pair) else "slides on"
            problem = f"found {self.body}, which {does} the {general.ground} and has no centrodes"
            raise DesignError("body", problem, "give a body that is not joined to the ground", "conflict")

    @cached_property
    def centrodes(self) -> Centrodes:
        """Both curves over the frames."""
        return Centrodes(self.motion, self.body)

    @cached_property
    def runs(self) -> list[tuple[float, float]]:
        """Ranges of the drive over which the centrodes are unbroken."""
        drive = self.motion.drive
        runs = [drive[run] for run in self.centrodes.runs(self.reach)]
        if not runs and self.motion.assembled.any() and is_translating(self.motion, self.body):
            raise DesignError(
                "body", f"found {self.body}, which does not turn and has no centrodes", "give another", "conflict"
            )
        if not runs:
            raise DesignError(
                "reach", f"found {mm(self.reach):g}, within which no centrode lies", "give a larger one", "out-of-range"
            )
        return [(float(part.min()), float(part.max())) for part in runs]

    @cached_property
    def table(self) -> Table:
        centrodes = self.centrodes
        run = np.zeros(len(self.motion.drive), dtype=int)
        for k, part in enumerate(centrodes.runs(self.reach)):
            run[part] = k + 1
        return Table(
            (
                self.drive_column,
                Column("run", "", "number of the unbroken run of the frame, 0 for none", run),
                *xy_columns("fixed_centrode", "mm", "instant centre on the ground", finite(centrodes.fixed)),
                *xy_columns("moving_centrode", "mm", f"instant centre on the {self.body}", finite(centrodes.moving)),
            )
        )

    @cached_property
    def curves(self) -> tuple[list[AbstractCurve], list[AbstractCurve]]:
        """The fixed centrode and the moving one, each as its runs."""
        linkage, start = self.linkage.linkage, float(self.motion.drive[0])
        fixed, moving = (
            [CentrodeCurve(linkage, self.body, run, moving, self.made.branch, start) for run in self.runs]
            for moving in (False, True)
        )
        return list(fixed), list(moving)

    @cached_property
    def scene(self) -> Scene:
        """The moving centrode, on its body, rolling on the fixed one."""
        drawn = np.asarray(self.table["run"]) > 0
        centre = np.where(drawn, self.centrodes.fixed, np.nan)
        return centrodes_scene(self.motion, self.table, self.body, *self.curves, centre)

    @property
    def further_handles(self) -> Iterator[SceneHandle]:
        """The circle on the body within which the centrodes are drawn."""
        yield from super().further_handles
        yield circle_handle("reach", radius=self.reach, centre=body_point(self.motion, self.body, 0j))

    @property
    def design_checks(self) -> tuple[Check, ...]:
        return (reached(self.motion, self.what), *self.input_range.checks)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        linkage, parts = self.linkage.linkage, []
        for name, moving, body in (("fixed-centrode", False, linkage.ground), ("moving-centrode", True, self.body)):
            places = [z for pin, z in linkage.bodies[body].items() if pin in linkage.pins]
            if not moving:
                ground = self.motion.bodies[body]
                places = [complex(ground.point(z).position[0]) for z in places]
            pins = [Circle(complex(z), self.stock.pin_diameter / 2) for z in places]
            parts.append(engraved(name, [*self.curves[moving], *pins], self.stock))
        return tuple(parts)

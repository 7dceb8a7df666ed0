"""Points of a path in a file beside the recipe: a CSV of x and y, or the first path of an SVG drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from ...core.errors import DesignError, printable, shown
from ...core.fields import FARTHEST, AsWritten, PointXY, entry, quantity
from ...core.names import csv_cells, text_beside
from ...core.records import record
from ...core.reprs import clipped
from ...linkage.coupler_curve import CouplerCurve
from ...linkage.moving import move
from ...linkage.parts.engraved import PlateStock, engraved, skeleton
from ...linkage.parts.stock import LinkStock
from ...model.check import Check
from ...model.part import Part
from ...model.scene import SceneCurve
from ...plane.curve import AbstractCurve
from ...plane.primitives import Segment
from ...plane.vec import Complex, Real
from ...recipe.settings import Drive, Files
from ..found import size_entries, ten_digits
from ..path.path import LONGEST_RATIO, MOST_POINTS, TOGGLE_DEG, path_generator
from ..path.points import svg_path_points
from ..path.search import PathFound
from ..path.svg_drawings import drawing_points
from .linkage_goals import AbstractLinkageGoal, Search, choose_entry


class FileName:
    """The name of a file that lies beside a recipe or below; without a folder, as from a script, anywhere.

    No dataclass, since a recipe has the plain name and no table. Where a text lay is no part of what it says: the same
    recipe read from two folders is equal.
    """

    __slots__ = ("folder", "name")

    def __init__(self, name: str, folder: str | Path | None = None):
        self.name, self.folder = name, folder

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FileName) and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)

    def __repr__(self) -> str:
        return clipped(f"FileName({shown(self.name)})")

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """A recipe gives the name alone; the folder comes with the context it is validated in."""
        from pydantic_core import core_schema

        return core_schema.with_info_after_validator_function(
            lambda name, info: cls(name, (info.context or {}).get("folder", ".")),
            core_schema.str_schema(strict=True),
            serialization=core_schema.plain_serializer_function_ser_schema(lambda file: file.name),
        )

    def points(self, count: int) -> Complex:
        """The points, of a drawing so many."""
        text = text_beside(self.name, self.folder, "a CSV or an SVG file")
        if self.name.lower().endswith(".svg"):
            try:
                return drawing_points(text, count)
            except DesignError as error:
                raise DesignError("file", f"{printable(self.name)}: {error.problem}", error.remedy) from None
        return _rows(text, printable(self.name))


def as_field(name: str, path: str, count: int) -> Complex:
    """Points of a path's text, refused under the name of the field that holds it."""
    try:
        return svg_path_points(path, count)[0]
    except DesignError as error:
        raise DesignError(name, f"its path {error.problem}", error.remedy) from None


def _rows(text: str, name: str) -> Complex:
    """The rows of two numbers; a first line of words is their heading."""
    count = text.count("\n")
    if count > MOST_POINTS + 1:
        raise DesignError("file", f"{name} has {count:,} lines", f"give at most {MOST_POINTS:,} points")
    lines = [line for line in csv_cells(text, name) if "".join(line).strip()]
    points = []
    for k, line in enumerate(lines, 1):
        try:
            x, y = (float(cell) for cell in line)
        except ValueError:
            if k == 1:
                continue
            problem = f"row {k} of {name} holds {printable(repr(','.join(line)), 30)}"
            raise DesignError(
                "file", problem, "give two numbers in each row, x and y in mm, separated by a comma or a semicolon"
            ) from None
        if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
            raise DesignError("file", f"row {k} of {name} holds {x:g}, {y:g}", f"give places within {FARTHEST:g} of 0")
        points.append(complex(x, y))
    return np.array(points, dtype=complex)


# mm: arms of the crosses that stand for wanted points on the drawing. Longer ones run into each other.
CROSS = 1.0
# How far a point may be from its place, as a share of the width of all: a path that is farther away is not the one
# that was wanted. Derived here, of paths laid over each other by eye.
NEAR = 0.05

# Where a recipe has the arguments of the search that do not stand under `wanted`.
TABLES = {
    "search": ("seed", "time_limit"),
    "limits": ("least_transmission_angle_deg", "largest_ratio"),
    "bounds": ("bounds",),
}

Pair = tuple[Annotated[float, AsWritten()], Annotated[float, AsWritten()]]


@record(checked=True, kw_only=True)
class WantedPath:
    """The points, by one of points, file and svg, and how they are to be met."""

    points: tuple[Annotated[complex, PointXY()], ...] | None = entry(
        "the points, [x, y] in mm each",
        default=None,
        # Ten: fewer are met exactly by many linkages, and which is found hangs on the last bit.
        example=tuple(
            complex(*point)
            for point in [
                *((0, 0), (5.2, 8.3), (7.3, 14.5), (5.9, 18.1), (1.8, 19.2)),
                *((-3.6, 17.7), (-9.4, 14), (-14.6, 8.6), (-18.8, 2.3), (-21.7, -4.3)),
            ]
        ),
    )
    file: FileName | None = entry(
        "a CSV file of x and y in mm, or an SVG drawing, whose first path is taken (in mm unless its width has a "
        "unit): beside the recipe or below",
        default=None,
    )
    svg: str | None = entry("the text of an SVG path, as M 0 0 L 10 5; one unit is 1 mm, y goes down", default=None)
    count: int = quantity("points that are taken of an SVG path", default=60, at_least=3, at_most=1000, whole=True)
    closed: bool = entry("whether they lie on a closed curve, in any order, which a full turn draws", default=False)
    slides: bool = entry("whether a slider-crank is wanted instead of a four-bar", default=False)
    drive_deg: tuple[Annotated[float, AsWritten()], ...] | None = entry(
        "the crank's angles at the points, rising or falling, of which the differences count; any where left out",
        default=None,
    )
    step_deg: float | None = quantity(
        "the same from point to point in equal steps", "deg", default=None, at_least=-180, at_most=180
    )

    def __post_init__(self) -> None:
        given = [name for name in ("points", "file", "svg") if getattr(self, name) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise DesignError("points", f"of points, file and svg found {found}", "give one of them")
        if self.drive_deg is not None and self.step_deg is not None:
            raise DesignError("step_deg", "is given, and drive_deg too", "give one of them")

    @cached_property
    def places(self) -> Complex:
        """The points, mm."""
        if self.file is not None:
            return self.file.points(self.count)
        if self.svg is not None:
            return as_field("svg", self.svg, self.count)
        return np.array(self.points, dtype=complex)

    def at_scale(self, scale: float) -> WantedPath:
        """The same with its points multiplied, those of a file or an SVG path too."""
        return replace(self, points=tuple((scale * self.places).tolist()), file=None, svg=None)

    @property
    def turns_deg(self) -> Real | None:
        """The crank's angles, deg; None where they are free."""
        if self.step_deg is not None:
            return self.step_deg * np.arange(len(self.places))
        return None if self.drive_deg is None else np.array(self.drive_deg, dtype=float)


@record(checked=True, kw_only=True)
class PathLimits:
    """What the linkage must keep; what is left out is 5 deg and a ratio of 100, or none where all links are bounded."""

    least_transmission_angle_deg: float | None = quantity(
        "least transmission angle over the way", "deg", default=None, at_least=0, at_most=89, example=30
    )
    largest_ratio: float | None = quantity(
        "longest link over the shortest", default=None, at_least=1, at_most=1e6, example=10
    )


MM = ("mm", "mm")


@record(checked=True, kw_only=True)
class PathBounds:
    """Sizes and places between two limits, [low, high]; they hold exactly."""

    ground: Pair | None = entry("least and greatest distance of the ground pivots, mm", default=None, units=MM)
    offset: Pair | None = entry("least and greatest offset of a slider-crank, mm", default=None, units=MM)
    crank: Pair | None = entry("least and greatest length of the crank, mm", default=None, units=MM)
    coupler: Pair | None = entry("least and greatest length of the coupler, mm", default=None, units=MM)
    rocker: Pair | None = entry("least and greatest length of the rocker, mm", default=None, units=MM)
    coupler_point_x: Pair | None = entry(
        "least and greatest x of the coupler point in the coupler's frame, mm", default=None, units=MM
    )
    coupler_point_y: Pair | None = entry(
        "least and greatest y of the coupler point in the coupler's frame, mm", default=None, units=MM
    )
    origin_x: Pair | None = entry("least and greatest x of the crank's ground pivot, mm", default=None, units=MM)
    origin_y: Pair | None = entry("least and greatest y of the crank's ground pivot, mm", default=None, units=MM)
    ground_angle_deg: Pair | None = entry(
        "least and greatest direction of the ground line or of the slide line, deg", default=None
    )
    start_deg: Pair | None = entry(
        "least and greatest first angle of the crank from the ground line, deg", default=None
    )

    @property
    def given(self) -> dict[str, Pair] | None:
        """Those that are given."""
        named = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: pair for name, pair in named.items() if pair is not None} or None


@record(kw_only=True)
class PathGeneratorRecipe(AbstractLinkageGoal[PathFound]):
    """The four-bar or slider-crank whose coupler point goes through given points, and a drawing of both paths."""

    kind: Literal["path-generator"] = "path-generator"
    wanted: WantedPath
    limits: PathLimits = entry("what the linkage must keep", default=PathLimits())
    bounds: PathBounds = entry("limits of sizes and places", default=PathBounds())
    search: Search = entry("how long to look, and from where", default=Search())
    choose: int = choose_entry()
    drive: Drive = entry("how the driver turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    advice: ClassVar[str] = "Without limits the best linkage is often one that jams: see `usable` in summary.json."

    def __post_init__(self) -> None:
        # Before any search: no way is longer than a turn.
        self.drive.check_rows()

    @cached_property
    def best(self) -> PathFound:
        """The best linkage, which knows the others."""
        wanted = self.wanted
        try:
            return path_generator(
                wanted.places,
                wanted.turns_deg,
                wanted.closed,
                self.limits.least_transmission_angle_deg,
                self.limits.largest_ratio,
                self.bounds.given,
                self.search.seed,
                self.search.time_limit,
                wanted.slides,
            )
        except DesignError as error:
            table = next((name for name, fields in TABLES.items() if error.field in fields), "wanted")
            key = (
                error.field if error.field == table or error.field.startswith(f"{table}.") else f"{table}.{error.field}"
            )
            raise DesignError(key, error.problem, error.remedy) from None

    @property
    def ranked(self) -> Sequence[PathFound]:
        return self.best.ranked

    @property
    def way(self) -> tuple[float, float]:
        """A whole turn where the path is closed, else from the first point to the last."""
        return (0.0, 360.0) if self.wanted.closed else super().way

    @property
    def size_bounds(self) -> Mapping[str, Pair]:
        return self.bounds.given or {}

    @property
    def search_limits(self) -> tuple[float, float]:
        least, largest = self.limits.least_transmission_angle_deg, self.limits.largest_ratio
        return TOGGLE_DEG if least is None else least, LONGEST_RATIO if largest is None else largest

    def met_by(self, found: PathFound) -> tuple[Check, ...]:
        wide = float(np.abs(self.wanted.places[:, None] - self.wanted.places).max()) if len(self.wanted.places) else 0.0
        advice = "give more room by wider bounds, lower limits or fewer points"
        return (
            Check(
                "largest distance of a point from the path",
                found.largest_distance,
                "at most",
                NEAR * wide,
                "mm",
                advice,
            ),
        )

    @property
    def crosses(self) -> list[AbstractCurve]:
        """The points, each as two short lines."""
        return [Segment(z - CROSS * arm, z + CROSS * arm) for z in self.wanted.places.tolist() for arm in (1, 1j)]

    @property
    def shown(self) -> Sequence[SceneCurve]:
        return [SceneCurve(line, "wanted", "wanted points" if not k else "") for k, line in enumerate(self.crosses)]

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        plate = PlateStock(thickness=self.stock.thickness, pin_diameter=self.stock.pin_diameter)
        found = self.found
        marks: list[AbstractCurve] = self.crosses
        span = (float(np.radians(self.way[0])), float(np.radians(self.way[1])))
        if not found.defects and span[1] > span[0]:
            marks.append(CouplerCurve(found.linkage, "coupler_point", found.branch, span))
        at = move(found.linkage, np.array([found.drive[0]]), found.branch)
        return (*super().parts, engraved("path", [*marks, *skeleton(at, 0, plate)], plate))

    @property
    def remarks(self) -> tuple[str, ...]:
        """That linkages through nine points may be missing."""
        if not self.best.may_be_incomplete:
            return ()
        why = "its time was over" if self.best.cut_short else "new starts brought nothing new"
        listed = f"{len(self.ranked)} linkages through the nine points are listed"
        return (f"The list of linkages may be incomplete: {listed}, and the search ended because {why}.",)

    @property
    def notes(self) -> Mapping[str, object]:
        best, usable = self.best, self.best.usable
        cognates = [{**size_entries(one.linkage), "driver": one.linkage.driver} for one in self.found.cognates]
        told: dict[str, object] = {
            "points": len(self.wanted.places),
            "method": "least squares" if best.least_squares else "as many unknowns as conditions, or more",
            "cut_short": best.cut_short,
            "may_be_incomplete": best.may_be_incomplete,
            "drive_at_points_deg": [ten_digits(q) for q in self.found.drive_deg],
            "usable": None if usable is None else self.shortened(usable).summary(),
            "cognates": cognates,
        }
        return told | dict(super().notes)

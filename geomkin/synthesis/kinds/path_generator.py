"""Recipe of a linkage whose coupler point passes through given points, from a list, a CSV file or an SVG drawing."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from ...core.errors import DesignError, printable, shown
from ...core.field_visitor import WrittenForm
from ...core.fields import FARTHEST, ComplexPoint, Length, Ratio, clipped, entry, point_of, quantity, to_digits
from ...core.names import Folder, csv_cells, read_text_file
from ...core.records import record
from ...core.units import INCH, marked
from ...linkage.coupler_curve import CouplerCurve
from ...linkage.moving import move
from ...linkage.parts.stock import LinkStock, PlateStock, engraved, skeleton
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Scene, SceneHandle, SceneMark, list_handles
from ...plane.curve import AbstractCurve
from ...plane.primitives import Segment
from ...plane.vec import Complex, Real
from ...recipe.settings import Drive, Files
from ..found import size_entries, ten_digits
from ..path.path import MOST_POINTS, WEIGHTS, path_generator, usual_limits
from ..path.path_found import PathFound
from ..path.svg_drawings import drawing_points, svg_path_points
from .linkage_goals import CUT_SHORT, AbstractLinkageGoal, Search, choose_entry, recipe_of

# Endings of files of pictures, which are not read.
PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".bmp", ".webp", ".tif", ".tiff")


class NameOfFile(WrittenForm):
    """Marks a file that a recipe names."""

    def read(self, given: Any, folder: Any) -> Any:
        return FileName(given, folder) if isinstance(given, str) else given

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        return value.name

    def schema(self, plain: dict[str, Any]) -> dict[str, Any]:
        return {"type": "string"}


class FileName:
    """Name of a file next to the recipe or below; without a folder, as in a script, any file.

    It is not a record, since a recipe contains the plain name. The folder does not count for equality: the same recipe
    read from two folders is equal.
    """

    __slots__ = ("folder", "name")

    def __init__(self, name: str, folder: Folder = None):
        self.name, self.folder = name, folder

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FileName) and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)

    def __repr__(self) -> str:
        return clipped(f"FileName({shown(self.name)})")

    @property
    def text(self) -> str:
        """The text of the file."""
        what = "a CSV or an SVG file"
        if self.name.lower().endswith(PICTURES):
            what = "the outline of the picture as an SVG file, which drawing programs trace, or a CSV file"
        return read_text_file(self.name, self.folder, what)

    def points(self, count: int) -> Complex:
        """Points of the file, mm; `count` applies to drawings."""
        text = self.text
        if self.name.lower().endswith(".svg"):
            try:
                return drawing_points(text, count)
            except DesignError as error:
                raise DesignError(
                    "file", f"{printable(self.name)}: {marked(error.problem)}", error.remedy, error.id
                ) from None
        return _rows(text, printable(self.name))


def as_field(name: str, path: str, count: int) -> Complex:
    """Points of a path's text; errors name the field that holds it."""
    try:
        return svg_path_points(path, count)[0]
    except DesignError as error:
        raise DesignError(name, f"its path {marked(error.problem)}", error.remedy, error.id) from None


def _rows(text: str, name: str) -> Complex:
    """The rows of two numbers of a CSV text; the first row may be a heading, which states inches as `x_in,y_in`."""
    count = text.count("\n")
    if count > MOST_POINTS + 1:
        raise DesignError(
            "file", f"{name} has {count:,} lines", f"give at most {MOST_POINTS:,} points", "too-much-work"
        )
    lines = [line for line in csv_cells(text, name) if "".join(line).strip()]
    points, unit = [], 1.0
    for k, line in enumerate(lines, 1):
        try:
            x, y = (unit * float(cell) for cell in line)
        except ValueError:
            if k == 1:
                unit = INCH if all(cell.strip().endswith("_in") for cell in line) else 1.0
                continue
            problem = f"row {k} of {name} holds {printable(repr(','.join(line)), 30)}"
            raise DesignError(
                "file",
                problem,
                "give two numbers in each row, x and y in mm, separated by a comma or a semicolon",
                "wrong-type",
            ) from None
        if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
            problem = f"row {k} of {name} holds {x:g}, {y:g}"
            raise DesignError("file", problem, f"give coordinates within {FARTHEST:g} of 0", "out-of-range")
        points.append(complex(x, y))
    return np.array(points, dtype=complex)


# Half the width of the crosses that mark wanted points, mm; longer ones overlap.
CROSS = 1.0
# Largest distance of a point from the path, as a share of the width of all points. A path farther away is visibly
# a different one; derived here by comparing drawn paths.
NEAR = 0.05

# Tables of a recipe that hold arguments of the search outside `wanted`.
TABLES = {
    "search": ("seed", "time_limit", "effort"),
    "limits": ("least_transmission_angle_deg", "largest_ratio"),
    "bounds": ("bounds",),
}

Pair = tuple[float, float]
LengthPair = tuple[Length, Length]


@record(checked=True, kw_only=True)
class WeightedStretch:
    """Points of a wanted path whose distances count more or less than those of the others."""

    first: int = quantity("number of its first point, the first of all being 1", at_least=1, whole=True, example=1)
    last: int = quantity(
        "number of its last point; on a closed path it may be less than first", at_least=1, whole=True, example=3
    )
    weight: float = quantity(
        "weight of the squared distances; other points have 1", at_least=WEIGHTS[0], at_most=WEIGHTS[1], example=10
    )


@record(checked=True, kw_only=True)
class WantedPath:
    """The points, given by one of points, file and svg, with the conditions of the path."""

    points: tuple[ComplexPoint, ...] | None = entry(
        "points of the path, [x, y] in mm each",
        default=None,
        # Ten points, since many linkages pass exactly through fewer, and rounding would decide which one is found.
        example=tuple(
            complex(*point)
            for point in [
                *((0, 0), (5.2, 8.3), (7.3, 14.5), (5.9, 18.1), (1.8, 19.2)),
                *((-3.6, 17.7), (-9.4, 14), (-14.6, 8.6), (-18.8, 2.3), (-21.7, -4.3)),
            ]
        ),
    )
    file: Annotated[FileName, NameOfFile()] | None = entry(
        "a CSV file of x and y in mm, or an SVG drawing, whose first path is used (in mm unless its width has a "
        "unit), next to the recipe or below",
        default=None,
    )
    svg: str | None = entry("the text of an SVG path, as M 0 0 L 10 5; one unit is 1 mm, y goes down", default=None)
    count: int = quantity("number of points taken from an SVG path", default=60, at_least=3, at_most=1000, whole=True)
    closed: bool = entry(
        "whether the points lie, in any order, on a closed curve that a full turn draws", default=False
    )
    bars: Literal[4, 5, 6, 7, 8] = entry(
        "largest number of bars; more than 4 follow paths that few four-bars follow", default=4
    )
    geared: bool = entry("whether five- and seven-bars with two geared cranks are searched for too", default=False)
    weights: tuple[WeightedStretch, ...] = entry(
        "stretches that matter more or less, each with first, last and weight; of two that overlap the later counts",
        default=(),
    )
    slides: bool = entry("true for a slider-crank, false for a four-bar", default=False)
    drive_deg: tuple[float, ...] | None = entry(
        "crank angles at the points, rising or falling; only differences count; free if left out", default=None
    )
    step_deg: float | None = quantity(
        "equal steps of the crank angle from point to point, instead of drive_deg", "deg", default=None,
        at_least=-180, at_most=180,
    )  # fmt: skip

    def __post_init__(self) -> None:
        given = [name for name in ("points", "file", "svg") if getattr(self, name) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise DesignError("points", f"of points, file and svg found {found}", "give one of them", "conflict")
        if self.drive_deg is not None and self.step_deg is not None:
            raise DesignError("step_deg", "is given, and drive_deg too", "give one of them", "conflict")

    @cached_property
    def places(self) -> Complex:
        """The points, mm."""
        if self.file is not None:
            return self.file.points(self.count)
        if self.svg is not None:
            return as_field("svg", self.svg, self.count)
        return np.array(self.points, dtype=complex)

    def at_scale(self, scale: float) -> WantedPath:
        """A copy with all points multiplied, including those of a file or an SVG path."""
        return replace(
            self, points=tuple(point_of(z.real, z.imag) for z in (scale * self.places).tolist()), file=None, svg=None
        )

    @property
    def weights_of_points(self) -> Real | None:
        """The weights (n,) of the points; None if all are alike."""
        if not self.weights:
            return None
        count = len(self.places)
        number, weights = np.arange(1, count + 1), np.ones(count)
        for k, stretch in enumerate(self.weights):
            first, last = stretch.first, stretch.last
            for name in ("first", "last"):
                if getattr(stretch, name) > count:
                    key, problem = f"weights[{k}].{name}", f"found {getattr(stretch, name):,}"
                    raise DesignError(
                        key, f"{problem}, and the path has {count:,} points", "give its number", "conflict"
                    )
            if first > last and not self.closed:
                problem, remedy = f"found {last:,}, and first is {first:,}", "give the lower number first"
                raise DesignError(f"weights[{k}].last", problem, f"{remedy}, or closed = true", "conflict")
            after, before = number >= first, number <= last
            weights[after & before if first <= last else after | before] = stretch.weight
        return weights

    @property
    def turns_deg(self) -> Real | None:
        """The crank angles, deg; None if they are free."""
        if self.step_deg is not None:
            return self.step_deg * np.arange(len(self.places))
        return None if self.drive_deg is None else np.array(self.drive_deg, dtype=float)


@record(checked=True, kw_only=True)
class PathLimits:
    """Limits of the linkage; by default 5 deg and a ratio of 100, or none if all links are bounded.

    For more than four bars the defaults are 20 deg and a ratio of 10.
    """

    least_transmission_angle_deg: float | None = quantity(
        "least transmission angle over the motion", "deg", default=None, at_least=0, at_most=89, example=30
    )
    largest_ratio: Ratio | None = quantity(
        "longest link over the shortest", default=None, at_least=1, at_most=1e6, example=10
    )


MM = ("mm", "mm")


@record(checked=True, kw_only=True)
class PathBounds:
    """Exact bounds [low, high] of sizes and positions."""

    ground: LengthPair | None = entry("least and greatest distance of the ground pivots, mm", default=None, units=MM)
    offset: Pair | None = entry("least and greatest offset of a slider-crank, mm", default=None, units=MM)
    crank: LengthPair | None = entry("least and greatest length of the crank, mm", default=None, units=MM)
    coupler: LengthPair | None = entry("least and greatest length of the coupler, mm", default=None, units=MM)
    rocker: LengthPair | None = entry("least and greatest length of the rocker, mm", default=None, units=MM)
    coupler_point_x: Pair | None = entry(
        "least and greatest x of the coupler point in the coupler's frame, mm", default=None, units=MM
    )
    coupler_point_y: Pair | None = entry(
        "least and greatest y of the coupler point in the coupler's frame, mm", default=None, units=MM
    )
    origin_x: Pair | None = entry("least and greatest x of the crank's ground pivot, mm", default=None, units=MM)
    origin_y: Pair | None = entry("least and greatest y of the crank's ground pivot, mm", default=None, units=MM)
    pivots_x: Pair | None = entry(
        "for closed paths or more bars, least and greatest x of all other ground pivots, mm", default=None, units=MM
    )
    pivots_y: Pair | None = entry(
        "for closed paths or more bars, least and greatest y of all other ground pivots, mm", default=None, units=MM
    )
    links: LengthPair | None = entry(
        "for closed paths or more bars, least and greatest distance of the pins of each link, mm, to limit its size",
        default=None,
        units=MM,
    )
    ground_angle_deg: Pair | None = entry(
        "least and greatest direction of the ground line or of the slide line, deg", default=None
    )
    start_deg: Pair | None = entry(
        "least and greatest first angle of the crank from the ground line, deg", default=None
    )

    @property
    def given(self) -> dict[str, Pair] | None:
        """The bounds that are given, by name."""
        named = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: pair for name, pair in named.items() if pair is not None} or None


@record(checked=True)
class PathEffort(Search):
    """Seed, time limit and effort of a search."""

    effort: int = quantity(
        "work of the search for closed paths and for more than four bars: 3 takes three times as long and comes nearer",
        default=1, at_least=1, at_most=100, whole=True,
    )  # fmt: skip


@record(kw_only=True)
class PathGeneratorRecipe(AbstractLinkageGoal[PathFound]):
    """A linkage whose traced point passes through given points or follows a closed path, with a drawing of both."""

    kind: Literal["path-generator"] = "path-generator"
    wanted: WantedPath
    limits: PathLimits = entry("limits of the linkage", default=PathLimits())
    bounds: PathBounds = entry("bounds of sizes and positions", default=PathBounds())
    search: PathEffort = entry("seed, time limit and effort of the search", default=PathEffort())
    choose: int = choose_entry()
    drive: Drive = entry("how the driver turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    advice: ClassVar[str] = "Without limits the best linkage often jams: choose the one under `usable` in summary.json."

    @property
    def sources(self) -> Mapping[str, str]:
        file = self.wanted.file
        return {} if file is None else {file.name: file.text}

    def __post_init__(self) -> None:
        super().__post_init__()
        # Checked before any search; no motion is longer than a turn.
        self.drive.check_rows()

    @cached_property
    def best(self) -> PathFound:
        """The best linkage, with the others in `ranked`."""
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
                wanted.bars,
                wanted.geared,
                self.search.effort,
                wanted.weights_of_points,
            )
        except DesignError as error:
            raise self._of_recipe(error) from None

    def _of_recipe(self, error: DesignError) -> DesignError:
        """An error of the search that names the key of the recipe."""
        wanted, field = self.wanted, error.field
        if field.startswith("bounds"):
            return error.named(field)
        if table := next((name for name, names in TABLES.items() if field in names), ""):
            return error.named(f"{table}.{field}")
        given = {name for name in ("points", "file", "svg", "step_deg") if getattr(wanted, name) is not None}
        if field == "drive_deg" and "step_deg" in given:
            return error.named("wanted.step_deg")
        if hasattr(wanted, field.partition("[")[0]):
            return error.named(f"wanted.{field}")
        # A size of a linkage that was found.
        key = f"wanted.{(given - {'step_deg'}).pop()}"
        problem = f"the linkage through them has {field}: {marked(error.problem)}"
        return DesignError(key, problem, "give a smaller path, nearer to the origin", "out-of-range")

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        """The wanted points, unless they are those of a file or an SVG path."""
        return tuple(list_handles("wanted.points", self.wanted.points or (), "wanted point"))

    @property
    def ranked(self) -> Sequence[PathFound]:
        return self.best.ranked

    @property
    def further(self) -> Sequence[PathFound]:
        usable = self.best.usable
        return () if usable is None or usable is self.best else (usable,)

    @property
    def size_bounds(self) -> Mapping[str, Pair]:
        return self.bounds.given or {}

    @property
    def search_limits(self) -> tuple[float, float]:
        least, largest = self.limits.least_transmission_angle_deg, self.limits.largest_ratio
        usual = usual_limits(self.wanted.bars)
        return usual[0] if least is None else least, usual[1] if largest is None else largest

    def met_by(self, found: PathFound) -> tuple[Check, ...]:
        places = found.points
        width = float(np.abs(places[:, None] - places).max()) if len(places) else 0.0
        advice = "give wider bounds, lower limits or fewer points"
        if found.closed:
            advice = f"{advice}, or more bars" if self.wanted.bars < 8 else "give wider bounds or lower limits"
        return (
            Check(
                "point_distance",
                (
                    "largest distance of the paths, both ways"
                    if found.closed
                    else "largest distance of a point from the path"
                )
                + (", weighted" if found.weights is not None else ""),
                found.deviation,
                "at most",
                NEAR * width,
                "mm",
                advice,
            ),
        )

    @property
    def marked(self) -> Complex:
        """Wanted points that are drawn."""
        return self.best.points if self.best.given else self.wanted.places

    @property
    def crosses(self) -> list[AbstractCurve]:
        """The points as crosses."""
        return [Segment(z - CROSS * arm, z + CROSS * arm) for z in self.marked.tolist() for arm in (1, 1j)]

    @cached_property
    def scene(self) -> Scene:
        """The moving linkage with the wanted points."""
        found = super().scene
        still = np.ones(len(found.time))
        points = (
            SceneMark("point", still * z, "wanted", "" if k else "wanted points")
            for k, z in enumerate(self.marked.tolist())
        )
        return replace(found, marks=(*found.marks, *points))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        plate = PlateStock(thickness=self.stock.thickness, pin_diameter=self.stock.pin_diameter)
        design = self.found
        marks: list[AbstractCurve] = self.crosses
        span = tuple(np.radians(self.range_of(self.found)).tolist())
        if not design.defects and span[1] > span[0]:
            marks.append(CouplerCurve(design.linkage, "coupler_point", design.branch, span))
        at = move(design.linkage, np.array([design.drive[0]]), design.branch)
        return (*super().parts, engraved("path", [*marks, *skeleton(at, 0, plate)], plate))

    def listed(self, found: PathFound) -> Mapping[str, object]:
        """With more than four bars also the number of places where plates and pins collide."""
        entries = super().listed(found)
        if found.bars == 4:
            return entries
        low, high = (float(np.degrees(end)) for end in found.drive_range)
        design = recipe_of(found.linkage, found.branch, (low, high), self.drive, self.stock, self.files)
        return {**entries, "collisions": len(design.made.stack.collisions)}

    @property
    def cut_short(self) -> bool:
        return self.best.cut_short

    @property
    def remarks(self) -> tuple[str, ...]:
        """Whether all linkages through nine points are listed, and what the result states of the points."""
        best = self.best
        if best.cut_short:
            return (CUT_SHORT, *best.remarks)
        if best.remarks:
            return best.remarks
        if best.special:
            return (f"Nine points of which {best.special} have no finite number of linkages; these are some.",)
        if (count := best.path_count) is None or count.is_complete:
            return ()
        missing = f"{count.lost + count.repeated} of {count.total}"
        reason = "since the points are in a special position"
        return (f"The list of linkages may be incomplete: {missing} paths did not end at a solution, {reason}.",)

    @property
    def notes(self) -> Mapping[str, object]:
        best, usable = self.best, self.best.usable
        rank = 1 if usable is best else len(self.ranked) + 1
        cognates = [
            {**size_entries(cognate.linkage), "driver": cognate.linkage.driver} for cognate in self.found.cognates
        ]
        entries: dict[str, object] = {
            "points": len(self.wanted.places),
            "method": "least squares" if best.least_squares else "as many unknowns as conditions, or more",
            "cut_short": self.cut_short,
            "drive_at_points_deg": [ten_digits(q) for q in self.found.drive_deg],
            "usable": None if usable is None else {"choose": rank, **self.shortened(usable).summary()},
            "cognates": cognates,
        }
        if self.wanted.bars > 4:
            # By rank in the list of linkages.
            entries["front"] = [
                {"choose": 1 + next(k for k, one in enumerate(best.ranked) if one is found), "bars": found.bars}
                | {f"{name}_mm": value for name, value in found.errors.items() if name.endswith("largest_distance")}
                | {"transmission_angle_deg": to_digits(found.transmission_angle_deg, 6)}
                | {"extent": to_digits(found.extent, 6)}
                for found in best.front
            ]
        if best.path_count is not None:
            entries["paths"] = asdict(best.path_count)
        return entries | dict(super().notes)

"""Recipe of Burmester's curves of four poses, engraved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity
from ...core.records import record
from ...core.units import mm
from ...linkage.parts.stock import PlateStock, engraved, pose_axes
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Plot, Scene, SceneCurve, SceneHandle, SceneMark, circle_handle, pose_handles
from ...model.table import Column, Table, xy_columns
from ...plane.curve import AbstractCurve, Moved, SubCurve
from ...plane.primitives import Circle
from ...plane.vec import Complex, Pose, Real, without_rounding
from ...recipe.recipe import AbstractRecipe
from ...recipe.settings import Files
from ..found import ten_digits
from ..guidance.burmester import Burmester, BurmesterCurve, burmester_curves
from ..guidance.poses import distinct_poses, poles

# Default extent of the drawing, in sizes of the poses. With a larger one the poses are a dot on the plate.
REACH = 3.0
# Largest error of a listed dyad at a pose, in sizes of the poses: far below manufacturing accuracy. Derived here.
MISSED = 1e-6
# Lengths of the drawn axes of a pose and of a dash, as shares of the extent of the curves.
AXIS, DASH = 0.06, 0.02
# Samples of a piece for its length. With this number dashes and rows are even to a thousandth.
SAMPLES = 2000
# Duration of the animation of the wandering pivot, s.
DURATION = 12.0


@record(checked=True)
class FourWanted:
    """Four poses of a body."""

    poses: tuple[tuple[float, float, float], ...] = entry(
        "four positions of the body's origin with its angle, [x, y, angle] in mm and deg",
        example=((0.0, 0.0, 0.0), (40.0, 20.0, 30.0), (60.0, 60.0, 80.0), (40.0, 90.0, 110.0)),
        units=("mm", "mm", "deg"),
    )
    reach: float | None = quantity(
        "largest distance of the curves from the middle of the poses; three times the farthest pose if left out",
        "mm", default=None, above=0, at_most=FARTHEST,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if len(self.poses) != 4:
            raise DesignError("poses", f"found {len(self.poses)}", "give four", "out-of-range")

    @cached_property
    def pairs(self) -> list[tuple[complex, float]]:
        """The poses as the library takes them."""
        return [(complex(x, y), float(np.radians(angle))) for x, y, angle in self.poses]

    @cached_property
    def size(self) -> float:
        """Distance of the farthest origin from the middle, mm."""
        origins = distinct_poses(self.pairs, 4, 4)[0]
        return float(np.abs(origins - origins.mean()).max())

    @property
    def middle(self) -> complex:
        """Middle of the poses' origins, mm."""
        return complex(np.mean([place for place, _ in self.pairs]))


@record(checked=True, kw_only=True)
class BurmesterCurvesRecipe(AbstractRecipe):
    """The possible pivots and pins of four poses: the centre-point curve, and dashed the circle-point curve."""

    can_be_scaled: ClassVar[bool] = True
    kind: Literal["burmester-curves"] = "burmester-curves"
    wanted: FourWanted
    rows: int = quantity(
        "number of dyads in the table, evenly spaced along the centre-point curve", default=200, at_least=2,
        at_most=20_000, whole=True,
    )  # fmt: skip
    stock: PlateStock = entry("the plate", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    @property
    def reach(self) -> float:
        """Largest distance of the curves from the middle, mm."""
        wanted = self.wanted
        if wanted.reach is None and not wanted.size:
            raise DesignError(
                "wanted.reach", "is missing where all poses have one origin", "give it, in mm", "missing-key"
            )
        return REACH * wanted.size if wanted.reach is None else wanted.reach

    @cached_property
    def design(self) -> Burmester:
        curves = burmester_curves(self.wanted.pairs, self.reach)
        if not curves.fixed:
            raise DesignError(
                "wanted.reach", f"found {mm(self.reach):g}, within which no pivot lies", "give more", "out-of-range"
            )
        return curves

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        """The poses, and the circle round the curves if it is given."""
        wanted, handles = self.wanted, tuple(pose_handles("wanted.poses", self.wanted.poses))
        if wanted.reach is None:
            return handles
        return (*handles, circle_handle("wanted.reach", radius=wanted.reach, centre=wanted.middle))

    @cached_property
    def dyads(self) -> tuple[Real, Complex, Complex]:
        """Number of the piece (rows,), from 1, pivots (rows,) and pins (rows,) in the body's frame, mm."""
        pieces = self.design.fixed
        lengths = np.array([_length(piece)[1][-1] for piece in pieces])
        shares = np.maximum(1, np.rint(self.rows * lengths / lengths.sum())).astype(int)
        entries: list[tuple[Real, Complex, Complex]] = []
        for k, (piece, count) in enumerate(zip(pieces, shares)):
            t = _at_shares_of_length(piece, np.linspace(0, 1, count, endpoint=not piece.closed))
            entries.append((np.full(count, k + 1), piece.point(t), piece.partner(t)))
        number, fixed, moving = (np.concatenate(part) for part in zip(*entries))
        return number, fixed, moving

    @cached_property
    def pins(self) -> Complex:
        """Positions of the pins at each pose, (4, rows), mm."""
        origins, directions = distinct_poses(self.wanted.pairs, 4, 4)
        return origins[:, None] + directions[:, None] * self.dyads[2]

    @cached_property
    def table(self) -> Table:
        number, fixed, moving = self.dyads
        return Table(
            (
                Column("dyad", "", "number of the dyad", np.arange(1, len(number) + 1)),
                Column("piece", "", "number of the piece of the centre-point curve", number),
                *xy_columns("fixed", "mm", "pivot on the ground", fixed),
                *xy_columns("moving", "mm", "its pin in the body's own frame", moving),
                *xy_columns("moving_at_first", "mm", "the pin at the first pose", self.pins[0]),
                Column("length", "mm", "crank from pivot to pin", np.abs(self.pins[0] - fixed)),
            )
        )

    @property
    def design_checks(self) -> tuple[Check, ...]:
        """Compares distances, which the curves were not computed from."""
        lengths = np.abs(self.pins - self.dyads[1])
        missed = without_rounding(np.max(np.ptp(lengths, axis=0) / (self.reach + lengths[0])), 1.0)
        advice = "the poses are so close together that rounding decides the curves; move them apart"
        name = "largest miss of a pose by a dyad, to its length"
        return (Check("pose_miss", name, missed, "at most", MISSED, "", advice),)

    @property
    def at_first(self) -> Pose:
        """The body's frame at the first pose."""
        place, angle = self.wanted.pairs[0]
        return Pose(place, complex(np.exp(1j * angle)))

    @property
    def axes(self) -> list[AbstractCurve]:
        """The poses as the body's axes."""
        return pose_axes(self.wanted.pairs, AXIS * self.reach)

    @cached_property
    def scene(self) -> Scene:
        """A pivot moving along the centre-point curve, with its pin at each pose.

        Pins beyond the extent of the circle-point curve are not shown.
        """
        fixed, count = self.dyads[1], len(self.dyads[1])
        origins, directions = distinct_poses(self.wanted.pairs, 4, 4)
        # The circle-point curve is limited about the middle of the poses' origins as seen from the body.
        middle = ((origins.mean() - origins) / directions).mean()
        shown = np.where(np.abs(self.dyads[2] - middle) <= self.reach * (1 + 1e-9), self.pins, np.nan)
        curves = [
            SceneCurve(curve, "traced", "centre points" if not k else "") for k, curve in enumerate(self.design.fixed)
        ]
        moving = [Moved(piece, self.at_first) for piece in self.design.moving]
        curves += [SceneCurve(c, "pitch", "circle points, at pose 1" if not k else "") for k, c in enumerate(moving)]
        curves += [SceneCurve(curve, "wanted", f"pose {k + 1}") for k, curve in enumerate(self.axes)]
        marks = [SceneMark("line", fixed, "construction", vector=pins - fixed) for pins in shown]
        marks += [SceneMark("pin", pins, "construction") for pins in shown]
        marks.append(SceneMark("fixed pin", fixed, "construction", "pivot"))
        plots = (Plot("pivot on the ground", ("fixed_x", "fixed_y")), Plot("length of the crank", ("length",)))
        time, closed = np.linspace(0, DURATION, count), np.ones(count, dtype=bool)
        return Scene(self.table, time, closed, (), tuple(curves), tuple(marks), plots, cyclic=False)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        reach = self.reach
        dashes = [dash for piece in self.design.moving for dash in _dashes(piece, DASH * reach)]
        marks: list[AbstractCurve] = [*self.design.fixed, *(Moved(dash, self.at_first) for dash in dashes), *self.axes]
        for pole in poles(self.wanted.pairs).values():
            at = complex(pole.position)
            if abs(at - self.wanted.middle) <= reach:
                marks.append(Circle(at, self.stock.pin_diameter / 4))
        return (engraved("burmester-curves", marks, self.stock),)

    @property
    def notes(self) -> Mapping[str, object]:
        """Positions or directions of the poles, and the dyads with a slide."""
        poles_mm: dict[str, object] = {}
        for (j, k), pole in poles(self.wanted.pairs).items():
            position = complex(pole.position)
            direction = {"at_infinity_deg": ten_digits(float(np.degrees(np.angle(complex(pole.direction)))))}
            poles_mm[f"{j + 1} and {k + 1}"] = (
                [ten_digits(position.real), ten_digits(position.imag)] if np.isfinite(position) else direction
            )
        slides, slides_by_name = self.design.slides, {}
        for k, is_sliding_pin in enumerate(slides.fixed_far):
            pin, directions = (slides.moving, slides.fixed) if is_sliding_pin else (slides.fixed, slides.moving)
            slides_by_name["pin_that_slides" if is_sliding_pin else "pivot_that_is_slid_over"] = {
                "place_mm": [ten_digits(pin[k].real), ten_digits(pin[k].imag)],
                "direction_deg": ten_digits(np.degrees(np.angle(directions[k])) % 180),
            }
        return {"poles_mm": poles_mm, "slides": slides_by_name}


def _length(piece: BurmesterCurve) -> tuple[Real, Real]:
    """Parameters of a piece and its length up to each, mm."""
    t = np.linspace(piece.start, piece.end, SAMPLES)
    return t, np.concatenate([[0.0], np.cumsum(np.abs(np.diff(piece.point(t))))])


def _at_shares_of_length(piece: BurmesterCurve, share: Real) -> Real:
    """Parameters at shares of a piece's length."""
    t, length = _length(piece)
    parameters: Real = np.interp(share * length[-1], length, t)
    return parameters


def _dashes(piece: BurmesterCurve, length: float) -> Iterator[AbstractCurve]:
    """Every other part of a piece."""
    count = 2 * max(1, round(_length(piece)[1][-1] / (2 * length))) + 1
    ends = _at_shares_of_length(piece, np.linspace(0, 1, count + 1))
    for start, end in zip(ends[::2], ends[1::2]):
        yield SubCurve(piece, np.array([start, end]))

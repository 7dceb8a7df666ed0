"""Goals of rockers and sliders: the crank-rocker of a swing, two rockers that swing together, and a slider's stroke."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..check import Check
from ..errors import DesignError
from ..recipe.settings import Drive
from ..sizes import FARTHEST, check_sizes, entry, quantity
from ..synthesis.rockers import strokes
from ..synthesis.rockers.crank_rockers import CrankRocker, check_turn, crank_rocker
from ..synthesis.rockers.double_rockers import DoubleRocker, double_rocker
from ..synthesis.rockers.strokes import StrokeCrank, slider_crank_stroke
from .families import MISSED_DEG, AbstractFamilyGoal, AbstractTimed, missed, ratio_entry, time_ratio_entry, turn_entry

# Share of the stroke that the simulated one may miss: rounding is less. Derived here.
MISSED = 1e-6


@dataclass(frozen=True, kw_only=True)
class WantedSwing(AbstractTimed):
    """How a rocker swings, and how far a crank turns meanwhile; one length sets the size."""

    swing_deg: float = quantity("of the rocker, there and back", "deg", example=50, at_least=0.1, at_most=179)
    crank_turn_deg: float | None = turn_entry(200)
    time_ratio: float | None = time_ratio_entry()
    sense: Literal["same", "opposite"] = entry("of the rocker in that stroke, against the crank's", default="same")
    ground: float | None = quantity(
        "distance of the ground pivots; give one length", "mm", default=None, example=100, above=0, at_most=FARTHEST
    )
    crank: float | None = quantity("length of the crank, or this", "mm", default=None, above=0, at_most=FARTHEST)
    coupler: float | None = quantity("length of the coupler, or this", "mm", default=None, above=0, at_most=FARTHEST)
    rocker: float | None = quantity("length of the rocker, or this", "mm", default=None, above=0, at_most=FARTHEST)
    free_angle_deg: float | None = quantity(
        "another than the best: the angle whose tangent is crank over coupler", "deg", default=None, above=0, below=45
    )
    largest_ratio: float | None = ratio_entry("6 where left out, more for swings below 39 deg")

    def __post_init__(self) -> None:
        check_sizes(self)
        check_turn(self.swing_deg, self.turn_deg, self.sense, self.turn_key)
        if all(length is None for length in (self.ground, self.crank, self.coupler, self.rocker)):
            raise DesignError("ground", "no length is given", "give one of ground, crank, coupler, rocker, in mm")

    @property
    def is_free(self) -> bool:
        """Whether the best is looked for."""
        return self.free_angle_deg is None

    def search(self, free_angle_deg: float | None = None) -> CrankRocker:
        """The best or the one at the angle that is given, or the one at a free angle."""
        return crank_rocker(
            self.swing_deg,
            self.turn_deg,
            self.ground,
            self.sense,
            crank=self.crank,
            coupler=self.coupler,
            rocker=self.rocker,
            free_angle_deg=self.free_angle_deg if free_angle_deg is None else free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@dataclass(frozen=True, kw_only=True)
class CrankRockerRecipe(AbstractFamilyGoal[CrankRocker]):
    """The crank-rocker of a swing and a time ratio that drives best, found and made: plates and motion."""

    kind: Literal["crank-rocker"] = "crank-rocker"
    wanted: WantedSwing

    @property
    def remedy(self) -> str:
        return f"give a smaller swing_deg{', or a time ratio nearer to 1' if self.wanted.turn_deg != 180 else ''}"

    def met_by(self, found: CrankRocker) -> tuple[Check, ...]:
        wanted = self.wanted
        swing, turn = missed(found.swing_deg, wanted.swing_deg), missed(found.crank_turn_deg, wanted.turn_deg)
        return (
            Check("missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check("missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )


@dataclass(frozen=True, kw_only=True)
class WantedSwings:
    """Where two rockers begin and how far they swing, deg from the ground line, counterclockwise positive."""

    crank_start_deg: float = quantity(
        "driving rocker's direction at the start, from its pivot", "deg", example=60, at_least=-360, at_most=360
    )
    crank_swing_deg: float = quantity("its swing, signed", "deg", example=60, at_least=-359, at_most=359)
    rocker_start_deg: float = quantity(
        "driven rocker's direction at the start, from its pivot", "deg", example=80, at_least=-360, at_most=360
    )
    rocker_swing_deg: float = quantity("its swing, signed", "deg", example=40, at_least=-359, at_most=359)
    ground: float = quantity("distance of the ground pivots", "mm", example=100, above=0, at_most=FARTHEST)
    crank: float | None = quantity(
        "length of the driving rocker, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    rocker: float | None = quantity(
        "length of the driven rocker, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    largest_ratio: float | None = ratio_entry("100 where left out")

    def __post_init__(self) -> None:
        check_sizes(self)

    @property
    def is_free(self) -> bool:
        """Whether the best is looked for."""
        return self.crank is None and self.rocker is None

    def search(self, free_angle_deg: float | None = None) -> DoubleRocker:
        """The best or the one with the length that is given, or, where none is, the one at a free angle."""
        return double_rocker(
            self.crank_start_deg,
            self.crank_swing_deg,
            self.rocker_start_deg,
            self.rocker_swing_deg,
            self.ground,
            crank=self.crank,
            rocker=self.rocker,
            free_angle_deg=free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@dataclass(frozen=True, kw_only=True)
class DoubleRockerRecipe(AbstractFamilyGoal[DoubleRocker]):
    """Two rockers that swing together from given places, as the four-bar that drives best: found and made."""

    kind: Literal["double-rocker"] = "double-rocker"
    wanted: WantedSwings
    drive: Drive = entry("how the driving rocker turns", default=Drive())

    remedy = "give smaller swings or other starts"

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows(abs(self.wanted.crank_swing_deg) / 360)

    def rank(self, one: DoubleRocker) -> tuple[float, ...]:
        # As the search does: those that go beyond their places come behind those that do not.
        return one.overshoot_deg > MISSED_DEG, *super().rank(one)

    @property
    def way(self) -> tuple[float, float]:
        """The crank's, as it was given."""
        start, end = self.wanted.crank_start_deg, self.wanted.crank_start_deg + self.wanted.crank_swing_deg
        return min(start, end), max(start, end)

    def met_by(self, found: DoubleRocker) -> tuple[Check, ...]:
        swing, beyond = missed(found.rocker_swing_deg, self.wanted.rocker_swing_deg), missed(found.overshoot_deg, 0.0)
        return (
            Check("missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check("rocker's way beyond its places", beyond, "at most", MISSED_DEG, "deg"),
        )


@dataclass(frozen=True, kw_only=True)
class WantedStroke(AbstractTimed):
    """How far a slider goes, and how far the crank turns, counterclockwise, while it goes towards +x."""

    stroke: float = quantity("of the slider, there and back", "mm", example=80, above=0, at_most=FARTHEST)
    crank_turn_deg: float | None = turn_entry(190)
    time_ratio: float | None = time_ratio_entry()
    offset: float | None = quantity(
        "height of the slide line above the crank's pivot, instead of the best",
        "mm",
        default=None,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )
    crank: float | None = quantity(
        "length of the crank, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    coupler: float | None = quantity(
        "length of the connecting rod, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    largest_ratio: float | None = ratio_entry()

    def __post_init__(self) -> None:
        check_sizes(self)
        strokes.check_turn(self.turn_deg, self.turn_key)

    @property
    def is_free(self) -> bool:
        """Whether the best is looked for."""
        return self.offset is None and self.crank is None and self.coupler is None

    def search(self, free_angle_deg: float | None = None) -> StrokeCrank:
        """The best or the one with the size that is given, or, where none is, the one at a free angle."""
        return slider_crank_stroke(
            self.stroke,
            self.turn_deg,
            offset=self.offset,
            crank=self.crank,
            coupler=self.coupler,
            free_angle_deg=free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@dataclass(frozen=True, kw_only=True)
class SliderCrankStrokeRecipe(AbstractFamilyGoal[StrokeCrank]):
    """The slider-crank of a stroke and a time ratio that drives best, found and made: plates and motion."""

    kind: Literal["slider-crank-stroke"] = "slider-crank-stroke"
    wanted: WantedStroke

    remedy = "give a time ratio nearer to 1"

    def met_by(self, found: StrokeCrank) -> tuple[Check, ...]:
        wanted = self.wanted
        stroke = missed(found.stroke / wanted.stroke, 1.0) * wanted.stroke
        turn = missed(found.crank_turn_deg, wanted.turn_deg)
        return (
            Check("missed stroke", stroke, "at most", MISSED * wanted.stroke, "mm"),
            Check("missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )

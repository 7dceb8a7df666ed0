"""The goal of a stroke: the slider-crank of a stroke and a crank's turn that drives best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from ..check import Check
from ..recipe.settings import Drive, Files
from ..scene import Choice
from ..shop.linkage.stock import LinkStock
from ..sizes import FARTHEST, check_sizes, entry, quantity
from ..synthesis.rockers.strokes import StrokeCrank, check_turn, slider_crank_stroke
from .families import family_choice
from .linkage_goals import AbstractLinkageGoal, choose_entry
from .rocker_goals import (
    MISSED_DEG,
    by_transmission,
    crank_turn_of,
    missed,
    ratio_entry,
    spread,
    time_ratio_entry,
    told_family,
    turn_entry,
)

# Share of the stroke that the simulated one may miss: rounding is less. Derived here.
MISSED = 1e-6


@dataclass(frozen=True, kw_only=True)
class WantedStroke:
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
        check_turn(self.turn_deg, "crank_turn_deg" if self.time_ratio is None else "time_ratio")

    @property
    def turn_deg(self) -> float:
        """The crank's, in the stroke towards +x."""
        return crank_turn_of(self.crank_turn_deg, self.time_ratio)

    @property
    def is_free(self) -> bool:
        """Whether the best is looked for."""
        return self.offset is None and self.crank is None and self.coupler is None

    def search(self, free_angle_deg: float | None = None) -> StrokeCrank:
        """The best or the one with the size that is given, or the one at a free angle."""
        asked = free_angle_deg is None
        return slider_crank_stroke(
            self.stroke,
            self.turn_deg,
            offset=self.offset if asked else None,
            crank=self.crank if asked else None,
            coupler=self.coupler if asked else None,
            free_angle_deg=free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@dataclass(frozen=True, kw_only=True)
class SliderCrankStrokeRecipe(AbstractLinkageGoal[StrokeCrank]):
    """The slider-crank of a stroke and a time ratio that drives best, found and made: plates and motion."""

    kind: Literal["slider-crank-stroke"] = "slider-crank-stroke"
    wanted: WantedStroke
    choose: int = choose_entry()
    drive: Drive = entry("how the crank turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows()

    @cached_property
    def ranked(self) -> Sequence[StrokeCrank]:
        best = self.wanted.search()
        if not self.wanted.is_free:
            return (best,)
        others = [self.wanted.search(angle) for angle in spread(best.family)]
        return best, *by_transmission(others, self.wanted.largest_ratio)

    @property
    def way(self) -> tuple[float, float]:
        """The full turn."""
        return 0.0, 360.0

    @property
    def met(self) -> tuple[Check, ...]:
        found, wanted = self.found, self.wanted
        stroke = missed(found.stroke / wanted.stroke, 1.0) * wanted.stroke
        turn = missed(found.crank_turn_deg, wanted.turn_deg)
        return (
            Check("missed stroke", stroke, "at most", MISSED * wanted.stroke, "mm"),
            Check("missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )

    @property
    def choice(self) -> Choice:
        return family_choice(self.found, self.wanted.largest_ratio)

    @property
    def notes(self) -> Mapping[str, object]:
        return {"family": told_family(self.ranked[0].family), **super().notes}

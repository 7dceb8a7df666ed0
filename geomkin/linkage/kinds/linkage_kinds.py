"""Recipes of named linkages, and of any linkage of bodies."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import ClassVar, Literal

from ...core.fields import to_digits
from ...core.records import record
from ...core.units import UNITS
from ...model.check import WorkedFormula
from ...recipe.recipe import Additions
from ...recipe.settings import Stroke
from ..measures import grashof
from ..named_linkages import (
    EllipticTrammel,
    FourBar,
    InvertedSliderCrank,
    OldhamCoupling,
    ScotchYoke,
    Shaper,
    SliderCrank,
)
from ..six_bars import StephensonSixBar, WattSixBar
from .copies import Copy, copies_entry
from .linkages import LinkageAdditions, SlidingLinkageRecipe, TurningLinkageRecipe
from .moved import WITH_SLIDER, BodyList, shown_joints
from .stance import foot_entry
from .worked_formulas import four_bar_formulas, slider_crank_formulas


@record(kw_only=True)
class FourBarRecipe(TurningLinkageRecipe):
    """A four-bar linkage: plates with pin holes, and the motion of every link and of a coupler point."""

    kind: Literal["four-bar"] = "four-bar"
    linkage: FourBar

    @property
    def turning(self) -> Mapping[str, object]:
        result = grashof(self.linkage)
        links = {"shortest": result.shortest, "longest": result.longest}
        sums = {"shortest_and_longest_mm": result.shortest_and_longest, "other_two_mm": result.other_two}
        return {
            "grashof_type": result.type,
            "grashof": links | {name: to_digits(length, 10) for name, length in sums.items()},
        }

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """The position and the rates in one frame, a sixth of the drive's range from its start, if the crank drives."""
        if self.linkage.driver != "crank":
            return ()
        return four_bar_formulas(self.linkage, self.table, self.drive, UNITS[self.units])


@record(kw_only=True)
class SliderCrankRecipe(SlidingLinkageRecipe):
    """A slider-crank, driven by crank, connecting rod or slider."""

    kind: Literal["slider-crank"] = "slider-crank"
    linkage: SliderCrank
    copies: tuple[Copy, ...] = copies_entry()
    sliding: ClassVar = {"linkage.driver": "slider", "stroke": Stroke(start=70, end=110)}

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """The position and the rates in one frame, a sixth of the drive's range from its start, if the crank drives."""
        if self.linkage.driver != "crank":
            return ()
        return slider_crank_formulas(self.linkage, self.table, self.drive, UNITS[self.units])


@record(kw_only=True)
class InvertedSliderCrankRecipe(TurningLinkageRecipe):
    """A slotted lever, a Whitworth quick return, or a rod that slides through a rocking block."""

    kind: Literal["inverted-slider-crank"] = "inverted-slider-crank"
    linkage: InvertedSliderCrank


@record(kw_only=True)
class StephensonSixBarRecipe(TurningLinkageRecipe):
    """A four-bar whose coupler point drives an output, which can dwell."""

    kind: Literal["stephenson-six-bar"] = "stephenson-six-bar"
    linkage: StephensonSixBar


@record(kw_only=True)
class WattSixBarRecipe(TurningLinkageRecipe):
    """Two four-bars in series: the first one's rocker drives the second."""

    kind: Literal["watt-six-bar"] = "watt-six-bar"
    linkage: WattSixBar


@record(kw_only=True)
class ShaperRecipe(TurningLinkageRecipe):
    """A crank shaper: a slotted lever that drives a ram with a slow forward stroke and a quick return."""

    kind: Literal["shaper"] = "shaper"
    linkage: Shaper


@record(kw_only=True)
class EllipticTrammelRecipe(SlidingLinkageRecipe):
    """A rod whose pins run in two crossing slots: its points draw ellipses."""

    kind: Literal["elliptic-trammel"] = "elliptic-trammel"
    linkage: EllipticTrammel
    sliding: ClassVar = {"linkage.driver": "shuttle", "stroke": Stroke(start=-45, end=45)}


@record(kw_only=True)
class ScotchYokeRecipe(TurningLinkageRecipe):
    """A crank pin in a slotted yoke: exactly harmonic motion along a line."""

    kind: Literal["scotch-yoke"] = "scotch-yoke"
    linkage: ScotchYoke


@record(kw_only=True)
class OldhamCouplingRecipe(TurningLinkageRecipe):
    """Two slotted hubs and a disc between them: equal rotation of two offset shafts."""

    # All its points are pivots.
    additions: ClassVar[Additions] = LinkageAdditions(refused=("straight_line",))
    kind: Literal["oldham-coupling"] = "oldham-coupling"
    linkage: OldhamCoupling


@record(kw_only=True)
class LinkageRecipe(SlidingLinkageRecipe):
    """Any linkage, as a list of bodies: where two name the same point, a pin joins them."""

    kind: Literal["linkage"] = "linkage"
    linkage: BodyList
    copies: tuple[Copy, ...] = copies_entry()
    foot: str | None = foot_entry()
    sliding: ClassVar = {
        "linkage": dataclasses.replace(WITH_SLIDER, driver="block"),
        "stroke": Stroke(start=70, end=110),
    }

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        values = super().example_values(tables)
        return {"linkage": shown_joints(tables), **values} if set(tables) - {"copies", "loads"} else values

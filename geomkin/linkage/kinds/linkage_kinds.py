"""Recipes of named linkages, and of any linkage of bodies."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from ...core.fields import to_digits
from ...core.records import record
from ...core.units import UNITS
from ...model.check import WorkedFormula, WorkedFormulas
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
from .linkages import SlidingLinkageRecipe, TurningLinkageRecipe
from .moved import WITH_SLIDER, BodyList, shown_joints
from .stance import foot_entry


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
        return four_bar_formulas(self) if self.linkage.driver == "crank" else ()


def four_bar_formulas(recipe: FourBarRecipe) -> tuple[WorkedFormula, ...]:
    """The formulas of a four-bar in one frame of its table; empty if it cannot be assembled there."""
    unit, linkage, table = UNITS[recipe.units], recipe.linkage, recipe.table
    row, mm = len(table.columns[0].values) // 6, unit.name
    g, a, b, c = (float(unit.of(v)) for v in (linkage.ground, linkage.crank, linkage.coupler, linkage.rocker))
    p, q = float(unit.of(linkage.coupler_point.real)), float(unit.of(linkage.coupler_point.imag))
    theta_deg, omega = float(table.columns[0].values[row]), recipe.drive.speed_rpm * np.pi / 30
    theta, sign = np.radians(theta_deg), float(table["rocker_pin_branch"][row])
    numbers = {"g": g, "a": a, "b": b, "c": c, "x_B": p, "y_B": q, "theta": theta_deg, "omega": omega}
    s, k, m, longest = sorted((g, a, b, c))
    worked = WorkedFormulas(
        "Norton, Design of Machinery, chapters 4 and 6", {**numbers, "s": s, "l": longest, "k": k, "m": m}
    )
    worked.add(
        "Grashof: a link turns fully if this is at most 0", "G", "{s} + {l} - {k} - {m}", s + longest - k - m, mm
    )
    value = np.sqrt(g * g + a * a - 2 * g * a * np.cos(theta))
    d = worked.add("diagonal", "d", "sqrt({g}^2 + {a}^2 - 2 {g} {a} cos({theta} deg))", value, mm)
    between = (b * b + c * c - d * d) / (2 * b * c)
    if not np.isfinite(sign) or abs(between) >= 1:
        return ()
    template = "arccos(({b}^2 + {c}^2 - {d}^2) / (2 {b} {c}))"
    worked.add("angle between coupler and rocker", "mu", template, np.degrees(np.arccos(between)), "deg")
    template = "atan2({a} sin({theta} deg), {a} cos({theta} deg) - {g})"
    value = np.degrees(np.arctan2(a * np.sin(theta), a * np.cos(theta) - g))
    delta = worked.add("direction of the diagonal from the pivot of the rocker", "delta", template, value, "deg")
    value = np.degrees(np.arccos((c * c + d * d - b * b) / (2 * c * d)))
    template = "arccos(({c}^2 + {d}^2 - {b}^2) / (2 {c} {d}))"
    psi = worked.add("angle between rocker and diagonal", "psi", template, value, "deg")
    template = "{delta} - {psi}" if sign > 0 else "{delta} + {psi}"
    phi = np.radians(worked.add("rocker angle", "phi", template, delta - sign * psi, "deg"))
    value = np.arctan2(c * np.sin(phi) - a * np.sin(theta), g + c * np.cos(phi) - a * np.cos(theta))
    template = "atan2({c} sin({phi} deg) - {a} sin({theta} deg), {g} + {c} cos({phi} deg) - {a} cos({theta} deg))"
    beta = np.radians(worked.add("coupler angle", "beta", template, np.degrees(value), "deg"))
    template = "{omega} {a} sin({theta} deg - {beta} deg) / ({c} sin({phi} deg - {beta} deg))"
    value = omega * a * np.sin(theta - beta) / (c * np.sin(phi - beta))
    worked.add("angular velocity of the rocker", "omega_c", template, value, "rad/s")
    template = "{omega} {a} sin({phi} deg - {theta} deg) / ({b} sin({beta} deg - {phi} deg))"
    value = omega * a * np.sin(phi - theta) / (b * np.sin(beta - phi))
    worked.add("angular velocity of the coupler", "omega_b", template, value, "rad/s")
    template = "{a} cos({theta} deg) + {x_B} cos({beta} deg) - {y_B} sin({beta} deg)"
    value = a * np.cos(theta) + p * np.cos(beta) - q * np.sin(beta)
    worked.add("coupler point, along the ground", "x", template, value, mm)
    template = "{a} sin({theta} deg) + {x_B} sin({beta} deg) + {y_B} cos({beta} deg)"
    value = a * np.sin(theta) + p * np.sin(beta) + q * np.cos(beta)
    worked.add("coupler point, across the ground", "y", template, value, mm)
    return tuple(worked.formulas)


@record(kw_only=True)
class SliderCrankRecipe(SlidingLinkageRecipe):
    """A slider-crank, driven by crank, connecting rod or slider."""

    kind: Literal["slider-crank"] = "slider-crank"
    linkage: SliderCrank
    copies: tuple[Copy, ...] = copies_entry()
    sliding: ClassVar = {"linkage.driver": "slider", "stroke": Stroke(start=70, end=110)}


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

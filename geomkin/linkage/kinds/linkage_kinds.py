"""Recipes of named linkages and of any linkage of bodies, and their formulas with the numbers put in."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from ...core.fields import to_digits
from ...core.records import record
from ...core.units import UNITS, LengthUnit
from ...model.check import WorkedFormula, WorkedFormulas
from ...model.table import Table
from ...recipe.recipe import Additions
from ...recipe.settings import Stroke, Turn
from ..measures import grashof
from ..named_linkages import EllipticTrammel, FourBar, InvertedSliderCrank, OldhamCoupling, ScotchYoke, SliderCrank
from ..six_bars import Pantograph, Shaper, StephensonSixBar, WattSixBar
from .copies import Copy, copies_entry
from .linkages import LinkageAdditions, SlidingLinkageRecipe, TurningLinkageRecipe
from .moved import WITH_SLIDER, BodyList, shown_joints
from .stance import foot_entry


def four_bar_formulas(linkage: FourBar, table: Table, drive: Turn, unit: LengthUnit) -> tuple[WorkedFormula, ...]:
    """The formulas of a four-bar in one frame of its table; empty if it cannot be assembled there."""
    row, mm = len(table.columns[0].values) // 6, unit.name
    worked = WorkedFormulas("Norton, Design of Machinery, chapters 4, 6 and 7")
    sizes = {"g": linkage.ground, "a": linkage.crank, "b": linkage.coupler, "c": linkage.rocker}
    names = "ground", "crank", "coupler", "rocker"
    g, a, b, c = (worked.give(key, name, unit.of(sizes[key]), mm) for key, name in zip(sizes, names))
    s, k, m, longest = sorted((g, a, b, c))
    for symbol, name, length in zip("slkm", ("shortest", "longest", "third", "second"), (s, longest, k, m)):
        worked.give(symbol, f"{name} length", length, mm)
    worked.give("x_B", "coupler point from the crank pin, along the coupler", unit.of(linkage.coupler_point.real), mm)
    worked.give("y_B", "coupler point across the coupler, to its left", unit.of(linkage.coupler_point.imag), mm)
    theta = np.radians(
        worked.give("theta", "crank angle in this frame, from the ground", table.columns[0].values[row], "deg")
    )
    worked.give("omega", "angular velocity of the crank", drive.speed_rpm * np.pi / 30, "rad/s")
    worked.give("alpha", "angular acceleration of the crank", drive.acceleration_rad_per_s2, "rad/s2")
    sign = float(table["rocker_pin_branch"][row])
    worked.add(
        "Grashof: a link turns fully if this is at most 0", "G", "{s} + {l} - {k} - {m}", s + longest - k - m, mm
    )
    _extreme_transmission_angles(worked)
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
    worked.add("coupler angle", "beta", template, np.degrees(value), "deg")
    _four_bar_rates(worked, mm)
    return tuple(worked.formulas)


def _extreme_transmission_angles(worked: WorkedFormulas) -> None:
    """The transmission angles of a four-bar with its crank along the ground, which one that turns fully reaches."""
    g, a, b, c = (worked.numbers[key] for key in "gabc")
    for place, side, symbol in (("towards", "-", "mu_1"), ("away from", "+", "mu_2")):
        between = (b * b + c * c - (g - a if side == "-" else g + a) ** 2) / (2 * b * c)
        if abs(between) < 1:
            name = f"transmission angle, least or largest, with the crank {place} the rocker's pivot"
            template = f"arccos(abs({{b}}^2 + {{c}}^2 - ({{g}} {side} {{a}})^2) / (2 {{b}} {{c}}))"
            worked.add(name, symbol, template, np.degrees(np.arccos(abs(between))), "deg")


def _four_bar_rates(worked: WorkedFormulas, mm: str) -> None:
    """Velocities and accelerations of a four-bar, and place and velocity of its coupler point, from its angles."""
    a, b, c, p, q, omega, alpha = (worked.numbers[key] for key in ("a", "b", "c", "x_B", "y_B", "omega", "alpha"))
    theta, phi, beta = (np.radians(worked.numbers[key]) for key in ("theta", "phi", "beta"))
    template = "{omega} {a} sin({theta} deg - {beta} deg) / ({c} sin({phi} deg - {beta} deg))"
    value = omega * a * np.sin(theta - beta) / (c * np.sin(phi - beta))
    omega_c = worked.add("angular velocity of the rocker", "omega_c", template, value, "rad/s")
    template = "{omega} {a} sin({phi} deg - {theta} deg) / ({b} sin({beta} deg - {phi} deg))"
    value = omega * a * np.sin(phi - theta) / (b * np.sin(beta - phi))
    omega_b = worked.add("angular velocity of the coupler", "omega_b", template, value, "rad/s")
    template = (
        "({a} {alpha} sin({theta} deg - {beta} deg) + {a} {omega}^2 cos({theta} deg - {beta} deg) + {b} {omega_b}^2"
        " - {c} {omega_c}^2 cos({phi} deg - {beta} deg)) / ({c} sin({phi} deg - {beta} deg))"
    )
    value = a * alpha * np.sin(theta - beta) + a * omega**2 * np.cos(theta - beta) + b * omega_b**2
    value = (value - c * omega_c**2 * np.cos(phi - beta)) / (c * np.sin(phi - beta))
    worked.add("angular acceleration of the rocker", "alpha_c", template, value, "rad/s2")
    template = (
        "({c} {omega_c}^2 - {a} {alpha} sin({theta} deg - {phi} deg) - {a} {omega}^2 cos({theta} deg - {phi} deg)"
        " - {b} {omega_b}^2 cos({beta} deg - {phi} deg)) / ({b} sin({beta} deg - {phi} deg))"
    )
    value = c * omega_c**2 - a * alpha * np.sin(theta - phi) - a * omega**2 * np.cos(theta - phi)
    value = (value - b * omega_b**2 * np.cos(beta - phi)) / (b * np.sin(beta - phi))
    worked.add("angular acceleration of the coupler", "alpha_b", template, value, "rad/s2")
    template = "{a} cos({theta} deg) + {x_B} cos({beta} deg) - {y_B} sin({beta} deg)"
    value = a * np.cos(theta) + p * np.cos(beta) - q * np.sin(beta)
    x = worked.add("coupler point, along the ground", "x", template, value, mm)
    template = "{a} sin({theta} deg) + {x_B} sin({beta} deg) + {y_B} cos({beta} deg)"
    value = a * np.sin(theta) + p * np.sin(beta) + q * np.cos(beta)
    y = worked.add("coupler point, across the ground", "y", template, value, mm)
    template = "-{omega} {a} sin({theta} deg) - {omega_b} ({y} - {a} sin({theta} deg))"
    value = -omega * a * np.sin(theta) - omega_b * (y - a * np.sin(theta))
    worked.add("velocity of the coupler point, along the ground", "v_x", template, value, f"{mm}/s")
    template = "{omega} {a} cos({theta} deg) + {omega_b} ({x} - {a} cos({theta} deg))"
    value = omega * a * np.cos(theta) + omega_b * (x - a * np.cos(theta))
    worked.add("velocity of the coupler point, across the ground", "v_y", template, value, f"{mm}/s")


def slider_crank_formulas(
    linkage: SliderCrank, table: Table, drive: Turn, unit: LengthUnit
) -> tuple[WorkedFormula, ...]:
    """The formulas of a slider-crank in one frame of its table; empty if it cannot be assembled there."""
    row, mm = len(table.columns[0].values) // 6, unit.name
    worked = WorkedFormulas("Norton, Design of Machinery, chapters 4, 6 and 7")
    a = worked.give("a", "crank", unit.of(linkage.crank), mm)
    b = worked.give("b", "rod", unit.of(linkage.coupler), mm)
    e = worked.give("e", "height of the line of the slider's pin above the crank's pivot", unit.of(linkage.offset), mm)
    angle = table.columns[0].values[row]
    theta = np.radians(worked.give("theta", "crank angle in this frame, from the direction of the slide", angle, "deg"))
    omega = worked.give("omega", "angular velocity of the crank", drive.speed_rpm * np.pi / 30, "rad/s")
    alpha = worked.give("alpha", "angular acceleration of the crank", drive.acceleration_rad_per_s2, "rad/s2")
    sign = float(table["slider_pin_branch"][row])
    sine = (e - a * np.sin(theta)) / b
    if not np.isfinite(sign) or abs(sine) >= 1:
        return ()
    if b - a > abs(e):
        template = "sqrt(({b} + {a})^2 - {e}^2) - sqrt(({b} - {a})^2 - {e}^2)"
        value = np.sqrt((b + a) ** 2 - e * e) - np.sqrt((b - a) ** 2 - e * e)
        worked.add("stroke, between the positions with crank and rod in line", "S", template, value, mm)
    template = "arcsin(({e} - {a} sin({theta} deg)) / {b})"
    first = worked.add("inclination of the rod", "gamma", template, np.degrees(np.arcsin(sine)), "deg")
    template = "{gamma}" if sign > 0 else "180 - {gamma}"
    beta = np.radians(worked.add("angle of the rod", "beta", template, first if sign > 0 else 180 - first, "deg"))
    value = 90 - abs(first)
    worked.add(
        "transmission angle, between the rod and the normal of the slide", "mu", "90 - abs({gamma})", value, "deg"
    )
    template, value = "{a} cos({theta} deg) + {b} cos({beta} deg)", a * np.cos(theta) + b * np.cos(beta)
    worked.add("displacement of the slider", "x", template, value, mm)
    template = "-{omega} {a} cos({theta} deg) / ({b} cos({beta} deg))"
    value = -omega * a * np.cos(theta) / (b * np.cos(beta))
    omega_b = worked.add("angular velocity of the rod", "omega_b", template, value, "rad/s")
    template = "-{omega} {a} sin({theta} deg) - {omega_b} {b} sin({beta} deg)"
    value = -omega * a * np.sin(theta) - omega_b * b * np.sin(beta)
    worked.add("velocity of the slider", "v", template, value, f"{mm}/s")
    template = (
        "({omega}^2 {a} sin({theta} deg) - {alpha} {a} cos({theta} deg) + {omega_b}^2 {b} sin({beta} deg))"
        " / ({b} cos({beta} deg))"
    )
    turning = omega**2 * a * np.sin(theta) - alpha * a * np.cos(theta) + omega_b**2 * b * np.sin(beta)
    value = turning / (b * np.cos(beta))
    alpha_b = worked.add("angular acceleration of the rod", "alpha_b", template, value, "rad/s2")
    template = (
        "-{omega}^2 {a} cos({theta} deg) - {alpha} {a} sin({theta} deg)"
        " - {omega_b}^2 {b} cos({beta} deg) - {alpha_b} {b} sin({beta} deg)"
    )
    value = -(omega**2) * a * np.cos(theta) - alpha * a * np.sin(theta)
    value -= omega_b**2 * b * np.cos(beta) + alpha_b * b * np.sin(beta)
    worked.add("acceleration of the slider", "A", template, value, f"{mm}/s2")
    return tuple(worked.formulas)


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


@record(kw_only=True)
class PantographRecipe(TurningLinkageRecipe):
    """A pantograph: its pen copies the tracer's path, enlarged."""

    kind: Literal["pantograph"] = "pantograph"
    linkage: Pantograph

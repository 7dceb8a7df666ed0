"""Formulas of linkages with the numbers put in, for one frame of their table."""

from __future__ import annotations

import numpy as np

from ...core.units import LengthUnit
from ...model.check import WorkedFormula, WorkedFormulas
from ...model.table import Table
from ...recipe.settings import Turn
from ..named_linkages import FourBar, SliderCrank


def four_bar_formulas(linkage: FourBar, table: Table, drive: Turn, unit: LengthUnit) -> tuple[WorkedFormula, ...]:
    """The formulas of a four-bar in one frame of its table; empty if it cannot be assembled there."""
    row, mm = len(table.columns[0].values) // 6, unit.name
    g, a, b, c = (float(unit.of(v)) for v in (linkage.ground, linkage.crank, linkage.coupler, linkage.rocker))
    p, q = float(unit.of(linkage.coupler_point.real)), float(unit.of(linkage.coupler_point.imag))
    theta_deg, omega = float(table.columns[0].values[row]), drive.speed_rpm * np.pi / 30
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


def slider_crank_formulas(
    linkage: SliderCrank, table: Table, drive: Turn, unit: LengthUnit
) -> tuple[WorkedFormula, ...]:
    """The formulas of a slider-crank in one frame of its table; empty if it cannot be assembled there."""
    row, mm = len(table.columns[0].values) // 6, unit.name
    a, b, e = (float(unit.of(value)) for value in (linkage.crank, linkage.coupler, linkage.offset))
    theta_deg, omega = float(table.columns[0].values[row]), drive.speed_rpm * np.pi / 30
    alpha, sign = drive.acceleration_rad_per_s2, float(table["slider_pin_branch"][row])
    theta = np.radians(theta_deg)
    numbers = {"a": a, "b": b, "e": e, "theta": theta_deg, "omega": omega, "alpha": alpha}
    worked = WorkedFormulas("Norton, Design of Machinery, chapters 4, 6 and 7", numbers)
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

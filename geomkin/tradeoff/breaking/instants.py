"""Where methods for a body's motion at an instant fail: cranks that are nearly parallel."""

from __future__ import annotations

from typing import Any

from ...linkage.instant.centres import instant_centre
from ...linkage.instant.curvature import path_curvature
from ...linkage.instant.inflection import inflection_circle
from ..cell import Cell, Sizes
from .linkages import POINT, bars, cross, of_four_bar, rates, two_unknowns


def _parallel(distance: float) -> Sizes:
    return 80.0, 30.0, 80 * (1 + distance), 30.0, 1.0


def _centre(ctx: Any, *sizes: Any) -> Any:
    """Where the lines of crank and rocker cross."""
    pin, _, arm = bars(ctx, *sizes)
    return two_unknowns(pin, arm, ctx.mpc(sizes[0]))[0] * pin


def _diameter(ctx: Any, *sizes: Any) -> Any:
    pin, bar, arm = bars(ctx, *sizes)
    h, _, h2, _ = rates(ctx, pin, bar, arm)
    i = ctx.mpc(0, 1)
    return abs(-h * pin - i * pin * h2 + h * h * pin) / abs(h) ** 3


def _bend(ctx: Any, *sizes: Any) -> Any:
    pin, bar, arm = bars(ctx, *sizes)
    h, _, h2, _ = rates(ctx, pin, bar, arm)
    i, out = ctx.mpc(0, 1), bar / sizes[2] * ctx.mpc(POINT.real, POINT.imag)
    velocity = i * (pin + h * out)
    return cross(velocity, -pin + (i * h2 - h * h) * out) / abs(velocity) ** 3


CELLS = (
    Cell(
        "instant centre",
        "parallel cranks",
        "place",
        "what coupler and ground differ by",
        _parallel,
        _centre,
        lambda *sizes: instant_centre(of_four_bar(*sizes), "coupler", "ground").position,
        "sizes, nan",
        "the centre's distance; `weight` is 0 where it is at infinity",
    ),
    Cell(
        "inflection circle",
        "parallel cranks",
        "diameter",
        "what coupler and ground differ by",
        _parallel,
        _diameter,
        lambda *sizes: inflection_circle(of_four_bar(*sizes), "coupler").diameter,
        "sizes, nan",
        "the diameter itself: inf where the circle is a line",
    ),
    Cell(
        "path curvature",
        "parallel cranks",
        "curvature",
        "what coupler and ground differ by",
        _parallel,
        _bend,
        lambda *sizes: path_curvature(of_four_bar(*sizes), "coupler", POINT).curvature,
        "all",
    ),
)

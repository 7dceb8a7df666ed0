"""Where methods for linkages fail: toggles, change points, limits, transmission angles of 0, many turns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...linkage.instant.centres import instant_centre
from ...linkage.instant.curvature import path_curvature
from ...linkage.instant.inflection import inflection_circle
from ...linkage.motion import Motion
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar, InvertedSliderCrank, SliderCrank
from ...linkage.six_bars import StephensonSixBar
from ...linkage.solve.branch import Branch
from ..cell import Cell, Sizes

POINT = 40 + 25j
RESULTS = ("direction", "rate", "second rate")


def scaled_lengths(lengths: Sizes, power: int, *others: float) -> Callable[[float], Sizes]:
    """Lengths times the distance or over it, and what is no length."""
    return lambda x: (*(length * x**power for length in lengths), *others)


def cross(a: Any, b: Any) -> Any:
    """z of the vector product."""
    return (a.conjugate() * b).imag


def two_unknowns(a: Any, b: Any, right: Any) -> tuple[Any, Any]:
    """Real x and y with x a + y b = right."""
    return cross(right, b) / cross(a, b), cross(a, right) / cross(a, b)


def bars(ctx: Any, ground: Any, crank: Any, coupler: Any, rocker: Any, angle: Any, branch: int = 1) -> Any:
    """Crank, coupler and rocker of a four-bar as vectors, by two circles that meet."""
    pin = crank * ctx.expj(angle)
    return pin, *triangle(ctx, ground - pin, coupler, rocker, branch)


def triangle(ctx: Any, way: Any, one: Any, two: Any, branch: int = 1) -> Any:
    """Two bars that go from the start of a way to their pin, and from its end."""
    square = abs(way) ** 2
    along = (square + one * one - two * two) / (2 * square)
    bar = (along + ctx.mpc(0, branch) * ctx.sqrt(one * one / square - along**2)) * way
    return bar, bar - way


def rates(ctx: Any, pin: Any, one: Any, two: Any) -> tuple[Any, Any, Any, Any]:
    """First and second derivatives of the angles of two bars by that of a crank: one - two = end - crank."""
    h, k = two_unknowns(one, -two, -pin)
    i = ctx.mpc(0, 1)
    return h, k, *two_unknowns(i * one, -i * two, pin + h * h * one - k * k * two)


def four_bar_rates(result: str, branch: int = 1) -> Callable[..., Any]:
    """The textbook's direction of the coupler, and rates of the rocker."""

    def formula(ctx: Any, ground: Any, crank: Any, coupler: Any, rocker: Any, angle: Any) -> Any:
        pin, bar, arm = bars(ctx, ground, crank, coupler, rocker, angle, branch)
        if result == "direction":
            return bar / coupler
        return rates(ctx, pin, bar, arm)[1 if result == "rate" else 3]

    return formula


def moved_four_bar(result: str, start: float | None = None) -> Callable[..., Any]:
    """The library's, followed from a first drive where that is given."""

    def library(ground: float, crank: float, coupler: float, rocker: float, angle: float) -> Any:
        drive, branch = ([angle], 1) if start is None else ([start, angle], "follow")
        return rate_of(_moved(FourBar(ground, crank, coupler, rocker), drive, branch), "coupler", "rocker", result)

    return library


def rate_of(motion: Motion, first: str, second: str, result: str) -> Any:
    """The direction of one body, or the first or second derivative of the other's angle."""
    if result == "direction":
        return motion.bodies[first].direction
    return motion.bodies[second].first if result == "rate" else motion.bodies[second].second


def _moved(linkage: Any, drive: list[float], branch: Any = 1) -> Motion:
    chosen: Branch = branch
    return move(linkage, np.array(drive), chosen)


def rate_condition(motion: Callable[..., Motion], result: str) -> Callable[..., Any]:
    """What the condition says of a result: of rates, which go by the inverse of the angle's sine, its square."""
    return lambda *sizes: motion(*sizes).error_amplification ** (1 if result == "direction" else 2)


def slider_crank(result: str) -> Callable[..., Any]:
    """The textbook's direction and rates of a slider-crank's coupler."""

    def formula(ctx: Any, crank: Any, coupler: Any, offset: Any, angle: Any) -> Any:
        pin = crank * ctx.expj(angle)
        rise = offset - pin.imag
        bar = ctx.mpc(ctx.sqrt(coupler * coupler - rise * rise), rise)
        if result == "direction":
            return bar / coupler
        i = ctx.mpc(0, 1)
        h, _ = two_unknowns(i * bar, ctx.mpc(-1), -i * pin)
        return h if result == "rate" else two_unknowns(i * bar, ctx.mpc(-1), pin + h * h * bar)[0]

    return formula


def moved_slider_crank(result: str) -> Callable[..., Any]:
    """The library's."""
    return lambda crank, coupler, offset, angle: rate_of(
        _moved(SliderCrank(crank, coupler, offset), [angle]), "coupler", "coupler", result
    )


def slider_driven(result: str) -> Callable[..., Any]:
    """The textbook's direction and rates of a crank that its slider drives."""

    def formula(ctx: Any, crank: Any, coupler: Any, offset: Any, place: Any) -> Any:
        pin, arm = triangle(ctx, ctx.mpc(place, offset), crank, coupler)
        if result == "direction":
            return pin / crank
        i = ctx.mpc(0, 1)
        h, k = two_unknowns(i * pin, i * arm, ctx.mpc(1))
        return h if result == "rate" else two_unknowns(i * pin, i * arm, h * h * pin - k * k * arm)[0]

    return formula


def _driven(crank: float, coupler: float, offset: float, place: float) -> Motion:
    return _moved(SliderCrank(crank, coupler, offset, driver="slider"), [place])


def moved_by_slider(result: str) -> Callable[..., Any]:
    """The library's."""
    return lambda *sizes: rate_of(_driven(*sizes), "crank", "crank", result)


def six_bar(result: str) -> Callable[..., Any]:
    """The textbook's direction of a Stephenson six-bar's link, and rate of its output."""

    def formula(ctx: Any, *sizes: Any) -> Any:
        ground, crank, coupler, rocker, x, y, link, output, pivot_x, pivot_y, angle = sizes
        pin, bar, arm = bars(ctx, ground, crank, coupler, rocker, angle)
        out = bar / coupler * ctx.mpc(x, y)
        one, two = triangle(ctx, ctx.mpc(pivot_x, pivot_y) - pin - out, link, output)
        if result == "direction":
            return one / link
        way = pin + rates(ctx, pin, bar, arm)[0] * out
        return two_unknowns(one, -two, -way)[1]

    return formula


def moved_six_bar(result: str) -> Callable[..., Any]:
    """The library's."""
    return lambda *sizes: rate_of(_moved_six_bar(*sizes), "link", "output", result)


def _moved_six_bar(*sizes: float) -> Motion:
    ground, crank, coupler, rocker, x, y, link, output, pivot_x, pivot_y, angle = sizes
    frame = FourBar(ground, crank, coupler, rocker, complex(x, y))
    return _moved(StephensonSixBar(frame, link, output, complex(pivot_x, pivot_y)), [angle])


def _near_toggle(distance: float) -> Sizes:
    """A Stephenson six-bar whose output dyad is nearly stretched at 1 rad."""
    four = _moved(FourBar(100, 30, 90, 70, POINT), [1.0])
    apart = float(abs(150 - 20j - four.point("coupler_point").position[0]))
    return 100.0, 30.0, 90.0, 70.0, POINT.real, POINT.imag, 60.0, apart * (1 + distance) - 60, 150.0, -20.0, 1.0


def of_four_bar(ground: float, crank: float, coupler: float, rocker: float, angle: float) -> Motion:
    """The library's motion of a four-bar with POINT, at one crank angle."""
    return _moved(FourBar(ground, crank, coupler, rocker, POINT), [angle])


def _lever(ctx: Any, ground: Any, crank: Any, angle: Any) -> Any:
    way = crank * ctx.expj(angle) - ground
    return way / abs(way)


def _moved_lever(ground: float, crank: float, angle: float) -> Any:
    direction = _moved(InvertedSliderCrank(ground, crank), [angle]).rocker.direction
    # The line of the slide has no sense.
    return direction * np.sign((direction * np.conj(crank * np.exp(1j * angle) - ground)).real)


LIMIT = float(np.arccos((16 + 9 - 4.5**2) / 24))
REACH = float(np.sqrt(120.0**2 - 12.0**2))
BY_CONDITION = "`motion.condition`"

CELLS = (
    *(
        cell
        for result in RESULTS
        for cell in (
            Cell(
                "four-bar",
                "toggle gap",
                result,
                "what the links are short of a toggle",
                lambda x: (3.0, 1.0, 4 - x, 2.0, x**0.5),
                four_bar_rates(result),
                moved_four_bar(result),
                "all",
            ),
            Cell(
                "four-bar",
                "near-miss of a change point",
                result,
                "what the links are longer than at a change point",
                lambda x: (4.0, 1.0, 3 + x, 2.0, np.pi - x**0.5),
                four_bar_rates(result),
                moved_four_bar(result),
                "all",
            ),
            Cell(
                "four-bar",
                "change point, followed",
                result,
                "crank angle beyond the change point, rad",
                lambda x: (4.0, 1.0, 3.0, 2.0, np.pi + x),
                four_bar_rates(result, -1),
                moved_four_bar(result, 1.0),
                "all",
            ),
            Cell(
                "four-bar",
                "kite that folds onto itself",
                result,
                "what ground and crank, and coupler and rocker, differ by",
                lambda x: (1.0, 1 - x, 2.0, 2 - 0.7 * x, x),
                four_bar_rates(result),
                moved_four_bar(result),
                "all",
            ),
            Cell(
                "four-bar",
                "true limit of the driver",
                result,
                "crank angle before the limit, of itself",
                lambda x: (4.0, 3.0, 2.0, 2.5, LIMIT * (1 - x)),
                four_bar_rates(result),
                moved_four_bar(result),
                "sizes",
                BY_CONDITION,
                rate_condition(of_four_bar, result),
            ),
            Cell(
                "slider-crank",
                "toggle gap",
                result,
                "what the coupler is longer than crank and offset",
                lambda x: (30.0, 42 * (1 + x), 12.0, -np.pi / 2 + x**0.5),
                slider_crank(result),
                moved_slider_crank(result),
                "all",
            ),
            Cell(
                "slider-crank driven by its slider",
                "transmission angle to 0",
                result,
                "what the slider is short of its reach",
                lambda x: (30.0, 90.0, 12.0, REACH * (1 - x)),
                slider_driven(result),
                moved_by_slider(result),
                "sizes",
                BY_CONDITION,
                rate_condition(_driven, result),
            ),
        )
    ),
    *(
        Cell(
            "six-bar",
            "transmission angle to 0",
            result,
            "what the output dyad is longer than stretched",
            _near_toggle,
            six_bar(result),
            moved_six_bar(result),
            "sizes",
            BY_CONDITION,
            rate_condition(_moved_six_bar, result),
        )
        for result in RESULTS[:2]
    ),
    Cell(
        "inverted slider-crank",
        "pins of the slide meet",
        "direction",
        "what ground and crank differ by, and crank angle",
        lambda x: (30 * (1 + x), 30.0, x),
        _lever,
        _moved_lever,
        "sizes, nan",
        "the slide's displacement beside the sizes",
    ),
    Cell(
        "four-bar",
        "angles of many turns",
        "direction",
        "one over the turns",
        lambda x: (100.0, 30.0, 90.0, 70.0, 1 + 2 * np.pi * round(1 / x)),
        four_bar_rates("direction"),
        moved_four_bar("direction"),
        "all",
    ),
    *(
        Cell(
            "four-bar",
            place,
            "rocker pin",
            distance,
            scaled_lengths((100.0, 30.0, 90.0, 70.0), power, 1.0),
            lambda ctx, *sizes: sum(bars(ctx, *sizes)[:2]),
            lambda *sizes: of_four_bar(*sizes).point("rocker_pin").position,
            "all, refused",
        )
        for place, distance, power in (
            ("small sizes", "sizes over 100 mm", 1),
            ("large sizes", "100 mm over sizes", -1),
        )
    ),
)


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


INSTANT_CELLS = (
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

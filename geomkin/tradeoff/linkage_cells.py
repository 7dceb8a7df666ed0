"""Where methods for linkages and for poses fail: toggles, change points, limits, many turns, nearly equal poses."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from ..linkage.instant.centres import instant_centre
from ..linkage.instant.curvature import path_curvature
from ..linkage.instant.inflection import inflection_circle
from ..linkage.motion import Motion
from ..linkage.moving import move
from ..linkage.named_linkages import FourBar, InvertedSliderCrank, SliderCrank
from ..linkage.six_bars import StephensonSixBar
from ..synthesis.guidance.dyads import dyads_through
from ..synthesis.guidance.poses import circle_of_sliders, poles
from .family import Cell, Sizes, for_each

# Names of results with their values.
Results = Iterator[tuple[str, Any]]
POINT = 40 + 25j
RATES = ("direction", "rate", "second rate")


def cross(a: Any, b: Any) -> Any:
    """z of the vector product."""
    return (a.conjugate() * b).imag


def two_unknowns(a: Any, b: Any, right: Any) -> tuple[Any, Any]:
    """Real x and y with x a + y b = right."""
    return cross(right, b) / cross(a, b), cross(a, right) / cross(a, b)


def bars(ctx: Any, ground: Any, crank: Any, coupler: Any, rocker: Any, angle: Any, branch: int = 1) -> Any:
    """Crank, coupler and rocker of a four-bar as vectors, by intersecting circles."""
    pin = crank * ctx.expj(angle)
    return pin, *triangle(ctx, ground - pin, coupler, rocker, branch)


def triangle(ctx: Any, diagonal: Any, one: Any, two: Any, branch: int = 1) -> Any:
    """Two bars, from the start of a diagonal to their pin and from its end."""
    square = abs(diagonal) ** 2
    along = (square + one * one - two * two) / (2 * square)
    bar = (along + ctx.mpc(0, branch) * ctx.sqrt(one * one / square - along**2)) * diagonal
    return bar, bar - diagonal


def rates(ctx: Any, pin: Any, one: Any, two: Any) -> tuple[Any, Any, Any, Any]:
    """First and second derivatives of the angles of two bars by that of a crank: one - two = end - crank."""
    h, k = two_unknowns(one, -two, -pin)
    i = ctx.mpc(0, 1)
    return h, k, *two_unknowns(i * one, -i * two, pin + h * h * one - k * k * two)


def four_bar(ctx: Any, ground: Any, crank: Any, coupler: Any, rocker: Any, angle: Any, branch: int = 1) -> Results:
    """Direction of the coupler, and rates of the rocker."""
    pin, bar, arm = bars(ctx, ground, crank, coupler, rocker, angle, branch)
    yield "direction", bar / coupler
    _, k, _, k2 = rates(ctx, pin, bar, arm)
    yield from (("rate", k), ("second rate", k2))


def slider_crank(ctx: Any, crank: Any, coupler: Any, offset: Any, angle: Any) -> Results:
    """Direction and rates of the coupler."""
    pin, i = crank * ctx.expj(angle), ctx.mpc(0, 1)
    rise = offset - pin.imag
    bar = ctx.mpc(ctx.sqrt(coupler * coupler - rise * rise), rise)
    yield "direction", bar / coupler
    h, _ = two_unknowns(i * bar, ctx.mpc(-1), -i * pin)
    yield "rate", h
    yield "second rate", two_unknowns(i * bar, ctx.mpc(-1), pin + h * h * bar)[0]


def slider_driven(ctx: Any, crank: Any, coupler: Any, offset: Any, position: Any) -> Results:
    """Direction and rates of a crank that its slider drives."""
    (pin, arm), i = triangle(ctx, ctx.mpc(position, offset), crank, coupler), ctx.mpc(0, 1)
    yield "direction", pin / crank
    h, k = two_unknowns(i * pin, i * arm, ctx.mpc(1))
    yield "rate", h
    yield "second rate", two_unknowns(i * pin, i * arm, h * h * pin - k * k * arm)[0]


def six_bar(ctx: Any, *sizes: Any) -> Results:
    """Direction of a Stephenson six-bar's link, and rate of its output."""
    ground, crank, coupler, rocker, x, y, link, output, pivot_x, pivot_y, angle = sizes
    pin, bar, arm = bars(ctx, ground, crank, coupler, rocker, angle)
    out = bar / coupler * ctx.mpc(x, y)
    one, two = triangle(ctx, ctx.mpc(pivot_x, pivot_y) - pin - out, link, output)
    yield "direction", one / link
    yield "rate", two_unknowns(one, -two, -(pin + rates(ctx, pin, bar, arm)[0] * out))[1]


# The library's


def moved_four_bar(ground: float, crank: float, coupler: float, rocker: float, angle: float) -> Motion:
    """A four-bar at one crank angle."""
    return move(FourBar(ground, crank, coupler, rocker, POINT), np.array([angle]))


def _followed(*sizes: Any) -> Motion:
    return move(FourBar(*sizes[:4]), np.array([1.0, sizes[4]]), "follow")


def _slider_crank(crank: float, coupler: float, offset: float, angle: float) -> Motion:
    return move(SliderCrank(crank, coupler, offset), np.array([angle]))


def _slider_driven(crank: float, coupler: float, offset: float, position: float) -> Motion:
    return move(SliderCrank(crank, coupler, offset, driver="slider"), np.array([position]))


def _six_bar(*sizes: Any) -> Motion:
    ground, crank, coupler, rocker, x, y, link, output, pivot_x, pivot_y, angle = sizes
    frame = FourBar(ground, crank, coupler, rocker, complex(x, y))
    return move(StephensonSixBar(frame, link, output, complex(pivot_x, pivot_y)), np.array([angle]))


def moving(motion: Callable[..., Motion], first: str, second: str) -> Callable[..., Results]:
    """Direction of one body, and derivatives of the other's angle."""

    def library(*sizes: float) -> Results:
        bodies = motion(*sizes).bodies
        yield "direction", bodies[first].direction
        yield "rate", bodies[second].first
        yield "second rate", bodies[second].second

    return library


def amplified(motion: Callable[..., Motion]) -> Callable[..., Results]:
    """Factor of the errors of each result: of rates, which are inverse to the angle's sine, its square."""

    def library(*sizes: float) -> Results:
        factor = motion(*sizes).error_amplification
        yield from zip(RATES, (factor, factor**2, factor**2))

    return library


def scaled_lengths(lengths: Sizes, power: int, *others: float) -> Callable[[float], Sizes]:
    """Lengths times the distance or over it, and sizes that are no lengths."""
    return lambda x: (*(length * x**power for length in lengths), *others)


def _near_toggle(distance: float) -> Sizes:
    """A Stephenson six-bar whose output dyad is nearly stretched at 1 rad."""
    four = moved_four_bar(100, 30, 90, 70, 1.0)
    apart = float(abs(150 - 20j - four.point("coupler_point").position[0]))
    return 100.0, 30.0, 90.0, 70.0, POINT.real, POINT.imag, 60.0, apart * (1 + distance) - 60, 150.0, -20.0, 1.0


def _lever(ctx: Any, ground: Any, crank: Any, angle: Any) -> Any:
    arm = crank * ctx.expj(angle) - ground
    return arm / abs(arm)


def _moved_lever(ground: float, crank: float, angle: float) -> Any:
    direction = move(InvertedSliderCrank(ground, crank), np.array([angle])).rocker.direction
    # The line of the slide has no sense.
    return direction * np.sign((direction * np.conj(crank * np.exp(1j * angle) - ground)).real)


def _parallel(distance: float) -> Sizes:
    return 80.0, 30.0, 80 * (1 + distance), 30.0, 1.0


def _centre(ctx: Any, *sizes: Any) -> Any:
    """Intersection of the lines of crank and rocker."""
    pin, _, arm = bars(ctx, *sizes)
    return two_unknowns(pin, arm, ctx.mpc(sizes[0]))[0] * pin


def _diameter(ctx: Any, *sizes: Any) -> Any:
    pin, bar, arm = bars(ctx, *sizes)
    h, _, h2, _ = rates(ctx, pin, bar, arm)
    i = ctx.mpc(0, 1)
    return abs(-h * pin - i * pin * h2 + h * h * pin) / abs(h) ** 3


def _path_curvature(ctx: Any, *sizes: Any) -> Any:
    pin, bar, arm = bars(ctx, *sizes)
    h, _, h2, _ = rates(ctx, pin, bar, arm)
    i, out = ctx.mpc(0, 1), bar / sizes[2] * ctx.mpc(POINT.real, POINT.imag)
    velocity = i * (pin + h * out)
    return cross(velocity, -pin + (i * h2 - h * h) * out) / abs(velocity) ** 3


LIMIT = float(np.arccos((16 + 9 - 4.5**2) / 24))
EXTREME = float(np.sqrt(120.0**2 - 12.0**2))
AMPLIFICATION = "`motion.error_amplification`"
FOUR_BAR = moving(moved_four_bar, "coupler", "rocker")
SIZES_OVER = (("small sizes", "sizes over 100 mm", 1), ("large sizes", "100 mm over sizes", -1))

LINKAGE_CELLS = (
    *for_each(RATES, Cell(
        "four-bar", "toggle gap", "", "gap to the toggle",
        lambda x: (3.0, 1.0, 4 - x, 2.0, x**0.5), four_bar, FOUR_BAR, "all")),
    *for_each(RATES, Cell(
        "four-bar", "near-miss of a change point", "", "excess length over a change point",
        lambda x: (4.0, 1.0, 3 + x, 2.0, np.pi - x**0.5), four_bar, FOUR_BAR, "all")),
    *for_each(RATES, Cell(
        "four-bar", "change point, followed", "", "crank angle beyond the change point, rad",
        lambda x: (4.0, 1.0, 3.0, 2.0, np.pi + x), partial(four_bar, branch=-1),
        moving(_followed, "coupler", "rocker"), "all")),
    *for_each(RATES, Cell(
        "four-bar", "kite that folds onto itself", "", "difference of ground and crank, and of coupler and rocker",
        lambda x: (1.0, 1 - x, 2.0, 2 - 0.7 * x, x), four_bar, FOUR_BAR, "all")),
    *for_each(RATES, Cell(
        "four-bar", "true limit of the driver", "", "crank angle to the limit, relative",
        lambda x: (4.0, 3.0, 2.0, 2.5, LIMIT * (1 - x)), four_bar, FOUR_BAR, "sizes", AMPLIFICATION,
        amplified(moved_four_bar))),
    *for_each(RATES, Cell(
        "slider-crank", "toggle gap", "", "excess of the coupler over crank and offset, relative",
        lambda x: (30.0, 42 * (1 + x), 12.0, -np.pi / 2 + x**0.5), slider_crank,
        moving(_slider_crank, "coupler", "coupler"), "all")),
    *for_each(RATES, Cell(
        "slider-crank driven by its slider", "transmission angle to 0", "", "slider to its extreme position, relative",
        lambda x: (30.0, 90.0, 12.0, EXTREME * (1 - x)), slider_driven, moving(_slider_driven, "crank", "crank"),
        "sizes", AMPLIFICATION, amplified(_slider_driven))),
    *for_each(RATES[:2], Cell(
        "six-bar", "transmission angle to 0", "", "excess length of the output dyad over stretched, relative",
        _near_toggle, six_bar, moving(_six_bar, "link", "output"), "sizes", AMPLIFICATION, amplified(_six_bar))),
    Cell(
        "inverted slider-crank", "pins of the slide meet", "direction",
        "difference of ground and crank, relative, and crank angle",
        lambda x: (30 * (1 + x), 30.0, x), _lever, _moved_lever, "sizes, nan",
        "the slide's displacement, which is small compared with the sizes"),
    *for_each(RATES[:1], Cell(
        "four-bar", "angles of many turns", "", "one over the number of turns",
        lambda x: (100.0, 30.0, 90.0, 70.0, 1 + 2 * np.pi * round(1 / x)), four_bar, FOUR_BAR, "all")),
    *(
        Cell("four-bar", place, "rocker pin", distance, scaled_lengths((100.0, 30.0, 90.0, 70.0), power, 1.0),
             lambda ctx, *sizes: sum(bars(ctx, *sizes)[:2]),
             lambda *sizes: moved_four_bar(*sizes).point("rocker_pin").position, "all, refused")
        for place, distance, power in SIZES_OVER
    ),
    Cell(
        "instant centre", "parallel cranks", "position", "difference of coupler and ground, relative", _parallel,
        _centre, lambda *sizes: instant_centre(moved_four_bar(*sizes), "coupler", "ground").position, "sizes, nan",
        "the centre's distance, and `weight`, 0 if it is at infinity"),
    Cell(
        "inflection circle", "parallel cranks", "diameter", "difference of coupler and ground, relative", _parallel,
        _diameter, lambda *sizes: inflection_circle(moved_four_bar(*sizes), "coupler").diameter, "sizes, nan",
        "the diameter itself: inf if the circle is a line"),
    Cell(
        "path curvature", "parallel cranks", "curvature", "difference of coupler and ground, relative", _parallel,
        _path_curvature, lambda *sizes: path_curvature(moved_four_bar(*sizes), "coupler", POINT).curvature, "all"),
)  # fmt: skip


PIN = 5 + 2j
# A four-bar whose coupler takes the poses, and its drives but the second.
GUIDE = FourBar(100.0, 30.0, 90.0, 70.0)
DRIVES = (0.4, 1.3, 2.1, 3.0)


def _poses(sizes: Sizes) -> list[tuple[complex, float]]:
    return [(complex(x, y), angle) for x, y, angle in zip(sizes[::3], sizes[1::3], sizes[2::3])]


def _placed(ctx: Any, sizes: Any) -> tuple[list[Any], list[Any]]:
    """Origins and directions."""
    return [ctx.mpc(x, y) for x, y in zip(sizes[::3], sizes[1::3])], [ctx.expj(angle) for angle in sizes[2::3]]


def _pole(ctx: Any, *sizes: Any) -> Any:
    (one, two), half = _placed(ctx, sizes)[0], (sizes[5] - sizes[2]) / 2
    return (one + two) / 2 + ctx.mpc(0, 1) * (two - one) / 2 * ctx.cos(half) / ctx.sin(half)


def _pivot(ctx: Any, *sizes: Any) -> Any:
    """Centre of the circle through a pin's three positions."""
    first, *others = (z + u * ctx.mpc(PIN.real, PIN.imag) for z, u in zip(*_placed(ctx, sizes)))
    a, b = (z - first for z in others)
    return first + ctx.mpc(0, 1) * (a * abs(b) ** 2 - b * abs(a) ** 2) / (2 * cross(a, b))


def _slider_centre(ctx: Any, *sizes: Any) -> Any:
    """Centre of the circle of pins whose three positions are collinear."""
    places, directions = _placed(ctx, sizes)
    a, b = (z - places[0] for z in places[1:])
    c, d = (u / directions[0] - 1 for u in directions[1:])
    return places[0] - ctx.mpc(0, 1) * (a * d.conjugate() - b * c.conjugate()) / (2 * cross(c, d))


def _guided(distance: float) -> Sizes:
    """Five poses of a four-bar's coupler, the second at this distance from the first."""
    coupler = move(GUIDE, np.array([DRIVES[0], DRIVES[0] + distance, *DRIVES[1:]])).coupler
    place, angle = coupler.origin.position, np.angle(coupler.direction)
    return tuple(float(v) for row in zip(place.real, place.imag, angle) for v in row)


def _pivot_near_known(ctx: Any, *sizes: Any) -> Any:
    """The pivot of the crank, by Newton's method from its known position."""
    places, directions = _placed(ctx, sizes)
    fixed, pin = ctx.mpc(0), ctx.mpc(0)
    for _ in range(9 if ctx.__class__.__name__ == "MPContext" else 6):
        arms = [z + u * pin - fixed for z, u in zip(places, directions)]
        # Squares of arms are equal: real unknowns are the displacements of the pivot and of the pin.
        rows, right = ctx.matrix(4, 4), ctx.matrix(4, 1)
        for k in range(4):
            parts = [(-(arms[j]), arms[j] * directions[j].conjugate()) for j in (k + 1, 0)]
            for column, (one, other) in enumerate(zip(*parts)):
                rows[k, 2 * column], rows[k, 2 * column + 1] = one.real - other.real, one.imag - other.imag
            right[k] = (abs(arms[0]) ** 2 - abs(arms[k + 1]) ** 2) / 2
        step = ctx.lu_solve(rows, right)
        fixed, pin = fixed + ctx.mpc(step[0], step[1]), pin + ctx.mpc(step[2], step[3])
    return GUIDE.crank + fixed


def _found(*sizes: float) -> Any:
    fixed = dyads_through(_poses(sizes)).fixed
    # With more, two poses count as one, and a whole curve of dyads goes through the rest.
    return GUIDE.crank + fixed[np.abs(fixed).argmin()] if len(fixed) <= 4 else np.nan


def _turned(x: float) -> Sizes:
    return 3.0, 4.0, 0.7, 13.0, -2.0, 0.7 + x


POSE_CELLS = (
    Cell("poles", "poles to infinity", "position", "angle between two poses, rad", _turned, _pole,
         lambda *sizes: poles(_poses(sizes))[0, 1].position, "all, nan", "`weight`, 0 if the pole is at infinity"),
    Cell("circle of sliders", "poles to infinity", "centre", "angle between two poses, rad",
         lambda x: (*_turned(x), -5.0, 10.0, 1.9), _slider_centre,
         lambda *sizes: circle_of_sliders(_poses(sizes)).centre, "all, nan",
         "`curvature`, 0 if the circle is a line"),
    Cell("dyad of a pin and three poses", "equal poses", "fixed pivot", "difference of two poses",
         lambda x: (3.0, 4.0, 0.7, 3 + 7 * x, 4 + 2 * x, 0.7 + 0.3 * x, -5.0, 10.0, 1.9), _pivot,
         lambda *sizes: dyads_through(_poses(sizes), moving=PIN).fixed, "sizes, refused",
         "the distance of the poses, which are refused from 1e-12 on"),
    Cell("dyads of five poses", "equal poses", "fixed pivot of a known crank", "drive between two poses, rad", _guided,
         _pivot_near_known, _found, "sizes, refused",
         "the distance of the poses; from 1e-10 on, dyads through four poses, each with its `residual`"),
)  # fmt: skip

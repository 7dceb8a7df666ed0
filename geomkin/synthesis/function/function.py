"""Searches for function generators: four-bars and slider-cranks whose output follows a function of the crank angle."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal, TypeVar

import numpy as np

from ...core.arguments import ArgumentType, PositiveInt, are_reals, between, checked, is_real, is_whole, numbers
from ...core.errors import DesignError
from ...core.fields import FARTHEST, SMALLEST, Size, rounded_down
from ...plane.vec import Real
from .generators import DECIMALS, AbstractGenerator, FourBarGenerator, SliderGenerator
from .results import DEGREE, AbstractFunctionGenerator, FunctionGenerator, SliderFunctionGenerator, common_fields
from .search import KEPT, LocalOptimum, best_candidates
from .wanted import Function, WantedFunction, wanted_function

G = TypeVar("G", bound=AbstractFunctionGenerator)
Method = Literal["minimax", "least-squares", "points"]


def _from_to(least: float, most: float, unit: str) -> ArgumentType:
    """Type of a number whose magnitude is limited and whose sign gives the sense."""
    description = f"a number from {least:g} to {most:g}, or its negative, in {unit}"
    return ArgumentType(lambda value: is_real(value) and least <= abs(value) <= most, description)


def _are_points(value: Any) -> bool:
    if is_whole(value):
        return bool(3 <= value <= 5)
    row = numbers(value, "iuf")
    return row is not None and row.ndim == 1 and 3 <= len(row) <= 5 and are_reals(row)


# A range below a tenth of a degree cannot show a function; a full turn ends where it started.
Swing = Annotated[float, _from_to(0.1, 359, "deg")]
Travel = Annotated[float, _from_to(SMALLEST, FARTHEST, "mm")]
Start = Annotated[float, between(-360, 360, "deg")]
SliderPosition = Annotated[float, between(-FARTHEST, FARTHEST, "mm")]
# Without these two limits many functions have no best linkage; it tends to a toggle or to infinite links.
Transmission = Annotated[float, between(5, 85, "deg")]
Ratio = Annotated[float, between(1.1, 100)]
Points = Annotated[int | Sequence[float], ArgumentType(_are_points, "3, 4 or 5, or as many values of x")]


@checked
def function_generator(
    function: Function,
    span: tuple[float, float],
    input_deg: Swing = 60.0,
    output_deg: Swing = 90.0,
    input_start_deg: Start | None = None,
    output_start_deg: Start | None = None,
    least_transmission_angle_deg: Transmission = 30.0,
    largest_ratio: Ratio = 10.0,
    method: Method = "minimax",
    points: Points = 3,
    ground: Size = 100.0,
) -> FunctionGenerator:
    """Find the four-bar whose rocker follows y = function(x).

    The crank angle is its start + input_deg (x - x0)/(x1 - x0), the rocker angle its start + output_deg (y -
    y(x0))/(y(x1) - y(x0)), both counterclockwise from the ground line.

    Parameters
    ----------
    function : callable, str or array_like of shape (n, 2)
        A function of a number or an array, a text such as `"log10(x)"` (see `Expression`; angles in rad), or rows (x,
        y), which a cubic spline joins.
    span : tuple of float
        Range (x0, x1) of x, rising.
    input_deg, output_deg : float
        Ranges of crank and rocker, 0.1 to 359 deg; negative for clockwise.
    input_start_deg, output_start_deg : float, optional
        Directions of crank and rocker at x0, -360 to 360 deg; found if not given.
    least_transmission_angle_deg : float
        Limit over the whole range, 5 to 85 deg.
    largest_ratio : float
        Limit of the longest link over the shortest, 1.1 to 100.
    method : {"minimax", "least-squares", "points"}
        "minimax" makes the largest error of the output angle least, "least-squares" its mean square, "points" makes it
        0 at precision points and the largest error least otherwise.
    points : int or sequence of float
        Number of precision points in Chebyshev's spacing, 3 to 5, or their x. Three need no free start, four need one,
        five need both.
    ground : float
        Distance of the ground pivots, mm.

    Returns
    -------
    FunctionGenerator
        The best linkage; `others` lists further optima.

    Raises
    ------
    DesignError
        For a function with a pole or with equal values at both ends, or if no linkage keeps the limits.

    See Also
    --------
    path_generator, body_guides, crank_rocker

    Notes
    -----
    Derived here: fits of Freudenstein's equation over a grid of start angles, and sizes spread over the allowed range,
    are compared by their true error; the best few dozen are improved to their optima.

    Examples
    --------
    >>> from geomkin.synthesis import function_generator
    >>> best = function_generator("log10(x)", (1, 2), 60, 60)
    >>> best.largest_error_deg < 0.01
    True
    """
    wanted = wanted_function(function, span)
    _check_output_range(wanted, float(output_deg))
    task = FourBarGenerator(
        share=wanted.share,
        swing=float(np.radians(input_deg)),
        starts=(_start_in_units(input_start_deg, DEGREE), _start_in_units(output_start_deg, DEGREE)),
        least_transmission=float(np.radians(least_transmission_angle_deg)),
        largest_ratio=float(largest_ratio),
        through=_through(wanted, method, points, (input_start_deg, output_start_deg)),
        out=float(np.radians(output_deg)),
        ground=float(ground),
    )

    def to_result(optimum: LocalOptimum) -> FunctionGenerator:
        starts = [
            _within_half_turn(computed) if given is None else float(given)
            for computed, given in zip(np.degrees(optimum.p[3:5]).tolist(), (input_start_deg, output_start_deg))
        ]
        return FunctionGenerator(
            **common_fields(task, wanted, optimum, method, DEGREE, starts[0]),
            starts_deg=(starts[0], starts[1]),
            largest_error_deg=DEGREE * optimum.worst,
            task=task,
        )

    return _best(task, method, to_result)


@checked
def slider_function_generator(
    function: Function,
    span: tuple[float, float],
    input_deg: Swing = 60.0,
    output_mm: Travel = 50.0,
    input_start_deg: Start | None = None,
    output_start_mm: SliderPosition | None = None,
    least_transmission_angle_deg: Transmission = 30.0,
    largest_ratio: Ratio = 10.0,
    method: Method = "minimax",
    points: Points = 3,
) -> SliderFunctionGenerator:
    """Find the slider-crank whose slider follows y = function(x).

    The crank angle is as for `function_generator`. The slider's position is its start + output_mm (y - y(x0))/(y(x1) -
    y(x0)), mm along +x from the foot of the crank pivot.

    Parameters
    ----------
    function : callable, str or array_like of shape (n, 2)
        As for `function_generator`.
    span : tuple of float
        Range (x0, x1) of x, rising.
    input_deg : float
        Range of the crank, 0.1 to 359 deg; negative for clockwise.
    output_mm : float
        Travel of the slider, mm; negative towards -x.
    input_start_deg : float, optional
        Crank angle at x0, -360 to 360 deg; found if not given.
    output_start_mm : float, optional
        Position of the slider at x0, mm; found if not given.
    least_transmission_angle_deg : float
        Limit of the angle between the connecting rod and the normal of the slide line, 5 to 85 deg.
    largest_ratio : float
        Limit of the ratio of crank and rod, 1.1 to 100.
    method, points
        As for `function_generator`.

    Returns
    -------
    SliderFunctionGenerator
        The best linkage; `others` lists further optima.

    Raises
    ------
    DesignError
        As for `function_generator`.
    """
    wanted = wanted_function(function, span)
    length = abs(float(output_mm))
    task = SliderGenerator(
        share=wanted.share,
        swing=float(np.radians(input_deg)),
        starts=(_start_in_units(input_start_deg, DEGREE), _start_in_units(output_start_mm, length)),
        least_transmission=float(np.radians(least_transmission_angle_deg)),
        largest_ratio=float(largest_ratio),
        through=_through(wanted, method, points, (input_start_deg, output_start_mm)),
        sense=float(np.sign(output_mm)),
        length=length,
    )

    def to_result(optimum: LocalOptimum) -> SliderFunctionGenerator:
        first = float(np.degrees(optimum.p[3]))
        start = _within_half_turn(first) if input_start_deg is None else float(input_start_deg)
        return SliderFunctionGenerator(
            **common_fields(task, wanted, optimum, method, length, start),
            start_deg=start,
            start_mm=length * float(optimum.p[4]) if output_start_mm is None else float(output_start_mm),
            largest_error=length * optimum.worst,
            task=task,
        )

    return _best(task, method, to_result)


def _start_in_units(start: float | None, unit: float) -> float:
    """A given start in the unit of the unknowns; nan if it is free."""
    return np.nan if start is None else float(start) / unit


def _within_half_turn(degrees: float) -> float:
    return round(degrees - 360 * float(np.ceil(degrees / 360 - 0.5)), DECIMALS)


def _check_output_range(wanted: WantedFunction, output_deg: float) -> None:
    """A rocker cannot follow a function whose output covers more than a turn."""
    shares = wanted.share(np.linspace(0, 1, 1025))
    turn = abs(output_deg) * float(np.ptp(shares))
    if turn > 359:
        raise DesignError(
            "output_deg",
            f"found {output_deg:g}, with which the output would cover {turn:.6g} deg",
            f"give at most {rounded_down(359 / float(np.ptp(shares)), 4)} deg, or a range in which it rises or falls",
            "out-of-range",
            float(np.sign(output_deg)) * float(rounded_down(359 / float(np.ptp(shares)), 4)),
        )


def _through(
    wanted: WantedFunction, method: str, points: int | Sequence[float], starts: tuple[float | None, float | None]
) -> tuple[float, ...]:
    """The precision points as shares of the input range; empty for other methods."""
    if method != "points":
        return ()
    x = chebyshev_points((wanted.x0, wanted.x1), points) if is_whole(points) else np.asarray(points, dtype=float)  # type: ignore[arg-type]
    most = 3 + starts.count(None)
    if len(x) > most:
        problem = f"found {len(x)}, but three lengths and the free starts can meet only {most}"
        raise DesignError("points", problem, "give no start, or fewer points", "conflict")
    shares = (x - wanted.x0) / (wanted.x1 - wanted.x0)
    if not ((shares >= 0) & (shares <= 1)).all() or (np.diff(shares) < 1e-3).any():
        remedy = f"give rising values from {wanted.x0:g} to {wanted.x1:g}, at least a thousandth of that apart"
        raise DesignError("points", f"found {', '.join(f'{value:g}' for value in x)}", remedy, "out-of-range")
    return tuple(shares.tolist())


def _best(task: AbstractGenerator, method: str, to_result: Callable[[LocalOptimum], G]) -> G:
    """The best optimum as a linkage, with the others."""
    squares = method == "least-squares"
    optima = best_candidates(task, squares)
    if not optima:
        problem = "no linkage was found that closes from these starts"
        raise DesignError("input_start_deg", problem, "leave a start free", "does-not-assemble")
    best = optima[0]
    if best.broken > KEPT or not np.isfinite(best.worst):
        # A search with the smallest allowed angle shows whether this limit is the reason.
        looser = [
            candidate
            for candidate in best_candidates(replace(task, least_transmission=np.radians(5)), squares)
            if candidate.broken <= KEPT
        ]
        if looser:
            angle = float(np.degrees(task.transmission(np.stack([candidate.p for candidate in looser])).max()))
            least = float(np.degrees(task.least_transmission))
            problem = f"found {least:g}, which none of the linkages tried keeps"
            remedy = f"give at most {rounded_down(angle, 3)}, leave starts free, or give other swings"
            raise DesignError("least_transmission_angle_deg", problem, remedy)
        if task.through and np.abs(task.error(best.p[None], np.array(task.through)[None])).max() > KEPT:
            problem = f"no linkage was found that meets these {len(task.through)} within the limits"
            remedy = "give fewer or others, leave starts free, or give other swings or limits"
            raise DesignError("points", problem, remedy)
        problem = f"found {task.largest_ratio:g}, but none of the linkages tried meets the function within the limits"
        remedy = "give a larger one or a smaller least transmission angle, leave starts free, or give other swings"
        raise DesignError("largest_ratio", problem, remedy)
    others = []
    for optimum in optima[1:]:
        # Linkages with links beyond the allowed size are left out.
        with contextlib.suppress(DesignError):
            others.append(to_result(optimum))
    return replace(to_result(best), others=tuple(others))


@checked
def chebyshev_points(span: tuple[float, float], count: PositiveInt = 3) -> Real:
    """Precision points in Chebyshev's spacing.

    Parameters
    ----------
    span : tuple of float
        Range (x0, x1), rising.
    count : int
        Number of points, 1 to 100.

    Returns
    -------
    array, shape (count,)
        The points, rising.

    Raises
    ------
    DesignError
        If the range does not rise or there are too many points.

    Notes
    -----
    x = (x0 + x1)/2 - (x1 - x0)/2 cos((2 k - 1) pi/(2 count)), k = 1, 2, ...: the zeros of the monic polynomial of this
    degree with the smallest maximum over the range. An error with these zeros has nearly equal peaks (Hartenberg and
    Denavit, Kinematic Synthesis of Linkages, 1964, chapter 5).

    Examples
    --------
    >>> from geomkin.synthesis import chebyshev_points
    >>> chebyshev_points((1, 3), 3).round(3).tolist()
    [1.134, 2.0, 2.866]
    """
    x0, x1 = (float(x) for x in span)
    if not x0 < x1:
        raise DesignError("span", f"found {x0:g} to {x1:g}", "give a rising pair", "out-of-range")
    if count > 100:
        raise DesignError("count", f"found {count}", "give at most 100", "out-of-range")
    points: Real = 0.5 * (x0 + x1) - 0.5 * (x1 - x0) * np.cos((np.arange(count) + 0.5) * np.pi / count)
    return points

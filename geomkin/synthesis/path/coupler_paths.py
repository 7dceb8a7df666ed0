"""Coupler points of many linkages at once, with their derivatives, for path searches.

A four-bar or a slider-crank is a row of numbers in the order of `NAMES`. For a slider-crank `ground` is the offset of
the slide line, and `rocker` is unused.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...core.errors import DesignError, shown
from ...core.records import record
from ...core.units import mm
from ...plane.vec import Complex, Real, dot

NAMES = ("ground", "crank", "coupler", "rocker", "x", "y", "origin_x", "origin_y", "ground_angle", "start")
GROUND, CRANK, COUPLER, ROCKER, ARM_X, ARM_Y, ORIGIN_X, ORIGIN_Y, TURN, START = range(10)


@record(eq=False)
class Paths:
    """Coupler points of s linkages at n crank angles each.

    point (s, n); folding (s, n), the signed cosine of the transmission angle; by_size, derivatives (s, n, 9) of the
    point by the first nine numbers; by_crank (s, n) by the crank angle; folding_by_size and folding_by_crank alike. nan
    if a linkage does not close.
    """

    point: Complex
    by_size: Complex
    by_crank: Complex
    folding: Real
    folding_by_size: Real
    folding_by_crank: Real


def closing(x: Real, cranks: Real, branch: Real, slides: bool) -> tuple[Complex, Complex]:
    """Directions (s, n) of crank and coupler from the ground line; the coupler's is nan if it does not close."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    crank: Complex = np.exp(1j * cranks)
    with np.errstate(invalid="ignore", divide="ignore"):
        if slides:
            sine = (d - a * crank.imag) / b
            return crank, branch[:, None] * np.sqrt(1 - sine**2) + 1j * sine
        across = d - a * crank
        square = np.abs(across) ** 2
        along = (square + b**2 - c**2) / (2 * b)
        coupler: Complex = across * (along + 1j * branch[:, None] * np.sqrt(square - along**2)) / square
    return crank, coupler


def points_of(x: Real, cranks: Real, branch: Real, slides: bool) -> Complex:
    """Coupler points (s, n); nan if a linkage does not close."""
    crank, coupler = closing(x, cranks, branch, slides)
    arm = (x[:, ARM_X] + 1j * x[:, ARM_Y])[:, None]
    placed = x[:, CRANK, None] * crank + arm * coupler
    points: Complex = (x[:, ORIGIN_X] + 1j * x[:, ORIGIN_Y])[:, None] + np.exp(1j * x[:, TURN, None]) * placed
    return points


def along(x: Real, cranks: Real, branch: Real, slides: bool) -> tuple[Complex, Complex]:
    """Coupler points (s, n) and their derivatives by the crank angle; nan if a linkage does not close."""
    d, a, b = (x[:, k, None] for k in (GROUND, CRANK, COUPLER))
    crank, coupler = closing(x, cranks, branch, slides)
    arm = (x[:, ARM_X] + 1j * x[:, ARM_Y])[:, None]
    rocker = 1j * np.ones_like(crank) if slides else a * crank + b * coupler - d
    with np.errstate(invalid="ignore", divide="ignore"):
        swing = -a * dot(rocker, 1j * crank) / (b * dot(rocker, 1j * coupler))
    turn = np.exp(1j * x[:, TURN, None])
    origin = (x[:, ORIGIN_X] + 1j * x[:, ORIGIN_Y])[:, None]
    return origin + turn * (a * crank + arm * coupler), turn * (1j * a * crank + 1j * arm * coupler * swing)


def paths(x: Real, cranks: Real, branch: Real, slides: bool) -> Paths:
    """Coupler points and all first derivatives, by implicit differentiation of the loop. Derived here."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    crank, coupler = closing(x, cranks, branch, slides)
    arm = (x[:, ARM_X] + 1j * x[:, ARM_Y])[:, None]
    turn = np.exp(1j * x[:, TURN, None])
    with np.errstate(invalid="ignore", divide="ignore"):
        # The direction in which the coupler's far pin cannot move: the rocker's, or the normal of the slide.
        rocker = np.full_like(crank, 1j) if slides else (a * crank + b * coupler - d) / c
        give = b * dot(rocker, 1j * coupler)
        ones = np.ones_like(give)
        by = (
            (ones if slides else rocker.real) / give,
            -dot(rocker, crank) / give,
            -dot(rocker, coupler) / give,
            0 * ones if slides else ones / give,
        )
        swing = -a * dot(rocker, 1j * crank) / give
    spin = 1j * arm * coupler
    zero = np.zeros_like(crank)
    sizes = [turn * v for v in (spin * by[0], crank + spin * by[1], spin * by[2], spin * by[3], coupler, 1j * coupler)]
    placed = turn * (a * crank + arm * coupler)
    by_size = np.stack([*sizes, zero + 1, zero + 1j, 1j * placed], axis=-1)
    by_crank = turn * (1j * a * crank + spin * swing)
    origin = (x[:, ORIGIN_X] + 1j * x[:, ORIGIN_Y])[:, None]
    return Paths(origin + placed, by_size, by_crank, *folding(x, cranks, slides))


def signed_transmission_cosine(x: Real, cranks: Real, slides: bool) -> Real:
    """Signed cosine of the transmission angle (s, n); the linkage does not close if its magnitude exceeds 1."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    if slides:
        sine: Real = (d - a * np.sin(cranks)) / b
        return sine
    cosine: Real = (b**2 + c**2 - (d - a) ** 2 - 2 * a * d * (1 - np.cos(cranks))) / (2 * b * c)
    return cosine


def folding(x: Real, cranks: Real, slides: bool) -> tuple[Real, Real, Real]:
    """`signed_transmission_cosine` with its derivatives by sizes (s, n, 9) and by crank (s, n)."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    cos, sin = np.cos(cranks), np.sin(cranks)
    value = signed_transmission_cosine(x, cranks, slides)
    by_size = np.zeros((*cranks.shape, 9))
    if slides:
        by_size[..., GROUND], by_size[..., CRANK], by_size[..., COUPLER] = 1 / b, -sin / b, -value / b
        return value, by_size, -a * cos / b
    by_size[..., GROUND], by_size[..., CRANK] = (a * cos - d) / (b * c), (d * cos - a) / (b * c)
    by_size[..., COUPLER], by_size[..., ROCKER] = 1 / c - value / b, 1 / b - value / c
    return value, by_size, -a * d * sin / (b * c)


# Names of bounds in the order of `NAMES`: lengths and positions in mm, angles in deg.
FOUR_BAR = (
    "ground",
    "crank",
    "coupler",
    "rocker",
    "coupler_point_x",
    "coupler_point_y",
    "origin_x",
    "origin_y",
    "ground_angle_deg",
    "start_deg",
)
# Bounds of linkages for closed paths, and of those with more bars.
CHAIN_ONLY = ("pivots_x", "pivots_y", "links")
# A slider-crank has an offset instead of the ground, and no rocker.
SLIDER = ("offset", *FOUR_BAR[1:])
# Shortest link, and longest link or coordinate, in units of the points' size. A wider range accepts a linkage
# at infinity, or one without a link.
SHORTEST, LONGEST = 1e-6, 1e4
# Range, in turns, of angles without bounds during the search.
FREE = 1e3


def bounds_of(
    bounds: Mapping[str, tuple[float, float]] | None, slides: bool, timed: bool, middle: complex, size: float
) -> tuple[Real, Real]:
    """Bounds low, high (10,) about `middle` in units of `size`; DesignError for unknown names and empty ranges.

    timed: whether crank angles are prescribed; otherwise their start cannot be bounded.
    """
    names = SLIDER if slides else FOUR_BAR
    allowed = [name for k, name in enumerate(names) if not (slides and k == ROCKER) and (timed or k != START)]
    low, high = np.full(10, -LONGEST), np.full(10, LONGEST)
    low[GROUND : ROCKER + 1] = SHORTEST
    low[[TURN, START]], high[[TURN, START]] = -FREE, FREE
    if slides:
        low[GROUND] = -LONGEST
        # An arbitrary length, since there is no rocker.
        low[ROCKER] = high[ROCKER] = 1.0
    for name, pair in (bounds or {}).items():
        if name not in allowed:
            reason = "; start_deg needs drive_deg" if name == "start_deg" and not timed else ""
            reason = (
                "; this one is for closed paths, without bounds of single links, or for more bars"
                if name in CHAIN_ONLY
                else reason
            )
            raise DesignError(
                "bounds", f"found {shown(name)}", f"give any of {', '.join(allowed)}{reason}", "unknown-key"
            )
        least, most = float(pair[0]), float(pair[1])
        k = names.index(name)
        check_bound(name, least, most, is_length=CRANK <= k <= ROCKER or (k == GROUND and not slides))
        if name.endswith("_deg"):
            least, most = np.radians(least), np.radians(most)
        elif name.startswith("origin"):
            shift = middle.real if k == ORIGIN_X else middle.imag
            least, most = (least - shift) / size, (most - shift) / size
        else:
            least, most = least / size, most / size
        low[k], high[k] = max(low[k], least), min(high[k], most)
        if low[k] > high[k]:
            raise DesignError(
                "bounds",
                f"{name} is out of proportion to the points, which are {mm(size):.3g} wide",
                "give bounds nearer to their size",
                "out-of-range",
            )
    return low, high


def check_bound(name: str, least: float, most: float, is_length: bool) -> None:
    """DesignError for bounds that are no range, or that a length cannot have."""
    if not least <= most:
        problem = f"{name} from {least:g} to {most:g} is not a range"
        raise DesignError("bounds", problem, "give the lower value first", "out-of-range")
    if is_length and (least < 0 or most == 0):
        side, value = ("least", f"{mm(least):up6}") if least < 0 else ("most", f"{mm(most):g}")
        problem = f"{name} is at {side} {value}, but a length is above 0"
        raise DesignError("bounds", problem, "give a range from 0, or from a larger value", "out-of-range")


def bound_all_links(bounds: Mapping[str, tuple[float, float]] | None, slides: bool) -> bool:
    """Whether the length of each link is bounded, so that no search tends to infinite links."""
    links = ("crank", "coupler") if slides else FOUR_BAR[:4]
    return bounds is not None and all(link in bounds for link in links)

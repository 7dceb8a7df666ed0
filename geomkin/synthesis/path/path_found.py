"""A linkage found for a path: its measures, texts and ranked others, and when two are alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from ...core.errors import DesignError
from ...core.fields import to_digits
from ...core.records import record
from ...linkage.cognate_linkages import Cognate, cognates
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Real
from ..found import Found, Rounding
from .closed_lines import WantedLine, crossings, distances, path_errors
from .nine_points import PathCount

# Limits of a usable linkage: transmission angle, deg, and ratio of links.
USABLE_DEG, USABLE_RATIO = 30.0, 10.0
# Relative tolerance for limits that are missed by rounding only.
ROUNDED = 1e-6
# Number of points below which the line through the points of a closed path is stated to be smooth, and crossings beyond
# which that number is stated.
FEW_POINTS, MANY_CROSSINGS = 6, 6
# Crank angles of a full turn at which closed paths are measured.
FULL_TURN = 2 * np.pi * np.arange(2049) / 2048
# Factor of the distance from the path beyond which a linkage is much worse, and the relative difference of sizes that
# does not count, of linkages with more than four bars.
FAR, NEARLY = 2.0, 0.02
# Relative difference of all sizes below which two linkages are the same.
SAME_LINKAGE = 1e-3


def _diagonal(points: Complex) -> float:
    return float(np.hypot(np.ptp(points.real), np.ptp(points.imag)))


@record(eq=False, kw_only=True)
class PathFound(Found):
    """A linkage whose coupler point passes through given points or near them.

    Parameters
    ----------
    linkage, branch, transmission_angle_deg, defects
        As for `Found`.
    drive : array, shape (n,)
        Crank angle at each point, rad from the ground line; for a closed path at the nearest point of the path.
    points : array of complex, shape (n,)
        The wanted points, mm.
    square_error : float
        Sum of squared distances of the points from the path, mm2; with prescribed crank angles, from the coupler point
        at these angles.
    largest_distance : float
        Largest of these distances, mm; for a closed path both ways, also from the path to the closed line through the
        points, as far as the points determine this line.
    rms_distance : float
        Root mean square of these distances, mm.
    wanted_line : WantedLine, optional
        The closed line through the points of a closed path.
    weights : array, shape (n,), optional
        Weights of the squared distances of the points.
    weighted_largest_distance : float, optional
        Largest distance as above if each is multiplied by the root of its weight over the largest weight, mm.
    weighted_rms_distance : float, optional
        Root of the weighted mean of squared distances, mm.
    is_timed : bool
        Whether the crank angles at the points were given.
    given : int
        Number of points that were given, if only a part of them, evenly chosen, is in `points`.
    closed : bool
        Whether a full turn draws the path.
    at_limits : tuple of str
        The limits that are active, in words.
    cut_short : bool
        Whether the time limit ended the search from random linkages.
    path_count : PathCount, optional
        For nine points without other conditions, where the paths of the continuation ended. If it `is_complete`,
        `ranked` has every four-bar through the points.
    special : str
        Why nine points without other conditions have no finite number of four-bars; empty otherwise.
    least_squares : bool
        Whether there are more points than a linkage can meet exactly.
    ranked : tuple of PathFound
        Distinct linkages including this one, the best first, those with defects last.
    again : callable, optional
        Search for a usable linkage; see `usable`.
    """

    points: Complex
    square_error: float
    largest_distance: float
    rms_distance: float
    closed: bool = False
    wanted_line: WantedLine | None = field(default=None, repr=False)
    weights: Real | None = field(default=None, repr=False)
    weighted_largest_distance: float | None = None
    weighted_rms_distance: float | None = None
    is_timed: bool = False
    given: int = 0
    at_limits: tuple[str, ...] = ()
    cut_short: bool = False
    path_count: PathCount | None = None
    special: str = ""
    least_squares: bool = False
    ranked: tuple[PathFound, ...] = ()
    again: Callable[[], PathFound | None] | None = field(default=None, repr=False)

    @property
    def coupler_point(self) -> complex:
        """Coupler point in the coupler's frame, mm."""
        return complex(self.linkage.coupler_point)  # type: ignore[attr-defined]

    @property
    def bars(self) -> int:
        """Number of bars, with the ground and without an idler."""
        return sum(len(points) > 1 for points in self.linkage.linkage.bodies.values())

    @property
    def accuracy(self) -> str:
        """The deviation as a share of the size of the path."""
        size = _diagonal(self.points)
        return f"{100 * self.deviation / size:.2g} % off, " if size else ""

    @property
    def deviation(self) -> float:
        """Largest distance by which linkages are compared, weighted if there are weights, mm."""
        return self.largest_distance if self.weighted_largest_distance is None else self.weighted_largest_distance

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a user should know of the points of a closed path, or of their number."""
        sentences = []
        if self.given:
            sentences.append(f"Of {self.given:,} points {len(self.points):,} are used.")
        if self.wanted_line is not None and len(self.points) < FEW_POINTS:
            remedy = "give points along the sides of a polygon"
            sentences.append(f"A smooth closed line through the {len(self.points)} points is followed: {remedy}.")
        if self.wanted_line is not None and (count := crossings(self.wanted_line.line)) > MANY_CROSSINGS:
            remedy = "give parts of it to several linkages, or a simpler curve"
            sentences.append(f"The curve crosses itself {count} times, which few linkages follow: {remedy}.")
        return tuple(sentences)

    @cached_property
    def extent(self) -> float:
        """Size of the place that all pins and the traced point need along the path, over that of the points."""
        motion = move(self.linkage, np.linspace(*self.drive_range, 61), self.branch)
        places = [motion.point(name).position for name in (*motion.linkage.pins, "coupler_point")]
        return _diagonal(np.array(places).ravel()) / _diagonal(self.points)

    @property
    def is_usable(self) -> bool:
        """Whether it has no defects, a transmission angle of at least 30 deg and a ratio of links of at most 10."""
        angle, ratio = self.transmission_angle_deg, self.ratio
        return not self.defects and angle >= USABLE_DEG * (1 - ROUNDED) and bool(ratio <= USABLE_RATIO * (1 + ROUNDED))

    @cached_property
    def usable(self) -> PathFound | None:
        """The best usable linkage, or None if none is found; searched for on first use unless this one is usable.

        Without such limits the best linkage of a path often jams or has extremely long links.
        """
        if self.is_usable:
            return self
        return self.again() if self.again else None

    @property
    def front(self) -> tuple[PathFound, ...]:
        """Those of `ranked` without defects that no other one equals in bars, distance, transmission angle and extent.

        Differences of 2 % do not count. The fewest bars first, and of these the nearest.
        """
        sound = sorted((one for one in self.ranked if not one.defects), key=lambda one: (one.bars, one.deviation))
        kept: list[PathFound] = []
        for found in sound:
            if not any(_is_no_worse(other.costs(other.extent), found.costs(found.extent)) for other in kept):
                kept.append(found)
        return tuple(kept)

    def costs(self, size: float) -> Real:
        """What a better linkage has less of, for a stated size: distance, bars, negative transmission angle, size."""
        return np.array([self.deviation, self.bars, -self.transmission_angle_deg, size])

    @cached_property
    def cognates(self) -> tuple[Cognate, ...]:
        """This linkage and the two other four-bars that draw the same path.

        Empty for a slider-crank, or if the cognates are degenerate.
        """
        if not isinstance(self.linkage, FourBar):
            return ()
        try:
            return cognates(self.linkage)
        except DesignError:
            return ()

    @property
    def drive_range(self) -> tuple[float, float]:
        return (0.0, 2 * np.pi) if self.closed else super().drive_range

    def rounded(self, rounding: Rounding) -> PathFound:
        other = super().rounded(rounding)
        # A linkage with a defect may reach some points on its other branch.
        branches = (1, -1) if self.defects else (self.branch,)
        paths = [move(other.linkage, other.drive, sign).point("coupler_point").position for sign in branches]
        off, path = np.fmin.reduce(np.abs(np.array(paths) - self.points)), np.zeros(0, dtype=complex)
        if self.wanted_line is not None:
            path = move(other.linkage, FULL_TURN, self.branch).point("coupler_point").position
            off = off if self.bars == 4 or self.is_timed else distances(self.points, path)
        return replace(other, **path_errors(off, self.weights, self.wanted_line, path))

    @property
    def errors(self) -> dict[str, float]:
        """The distances in a summary by name, mm."""
        names = ("largest_distance", "rms_distance", "weighted_largest_distance", "weighted_rms_distance")
        values = {name: getattr(self, name) for name in names}
        return {name: to_digits(value, 6) for name, value in values.items() if value is not None}

    def summary(self) -> Mapping[str, object]:
        errors: dict[str, object] = {"square_error_mm2": to_digits(self.square_error, 6)}
        errors |= {f"{name}_mm": value for name, value in self.errors.items()} | {"bars": self.bars}
        if self.bars > 4:
            errors["size_of_mechanism_by_size_of_path"] = to_digits(self.extent, 3)
        limits: dict[str, object] = {"at_limits": list(self.at_limits)} if self.at_limits else {}
        return errors | dict(super().summary()) | limits

    @property
    def drive_deg(self) -> Real:
        """Crank angles at the points, deg."""
        return np.degrees(self.drive)


def _is_no_worse(costs: Real, others: Real) -> bool:
    return bool((costs <= others + NEARLY * np.abs(others)).all())


def is_worse(first: PathFound, second: PathFound) -> bool:
    """Whether another linkage is much nearer to the path without more bars, size or a smaller transmission angle."""
    return _is_no_worse(second.costs(second.size), first.costs(first.size) / np.array([FAR, 1.0, 1.0, 1.0]))


def is_same(first: PathFound, second: PathFound) -> bool:
    """Whether two linkages are equal except for rounding or for the sense of a slide line."""
    if first.bars > 4 or second.bars > 4:
        one, other = (list(found.lengths.values()) for found in (first, second))
        return list(first.lengths) == list(second.lengths) and bool(np.allclose(one, other, rtol=NEARLY))
    if first.branch != second.branch and isinstance(first.linkage, FourBar):
        return False

    def sizes(found: PathFound) -> list[complex]:
        lengths = [abs(length) for length in found.lengths.values()]
        return [*lengths, found.coupler_point, found.linkage.origin]  # type: ignore[attr-defined]

    return all(
        abs(a - b) <= SAME_LINKAGE * max(abs(a), abs(b), 1e-3 * first.lengths["crank"])
        for a, b in zip(sizes(first), sizes(second))
    )

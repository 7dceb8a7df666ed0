"""Deviation of an output by tolerances of lengths and clearances of pins: worst case, root sum square, Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from difflib import get_close_matches
from functools import cached_property
from typing import Annotated, Literal

import numpy as np

from ..core.arguments import ArgumentType, ComplexOrNan, PositiveFloat, between, checked, is_real, whole_between
from ..core.errors import DesignError, shown
from ..core.fields import FARTHEST, rounded_up
from ..core.records import record
from ..plane.vec import Array, Complex, Mask, Real, Whole, dot, first_largest
from .joints.joint import Joint, Play
from .linkage import AbstractLinkage, Linkage
from .motion import Motion, unwrapped_deg
from .moving import move
from .sensitivity import Quantity, entry_numbers, linkage_data, quantities, size_names, size_rates

# Directions, over half a turn, in which the deviation of a point is measured. The largest one is found to 1 part in
# 25,000; twice as many take twice as long.
DIRECTIONS = 180
# Linkages that are moved at once: with more, the arrays no longer fit into a processor's cache.
BATCH = 5000
# Linkages times frames of one Monte Carlo analysis, which take about 600 MB.
MOST_SAMPLES = 20_000_000
# Standard deviations of a length within its tolerance: 99.73 % of all lengths are.
DEVIATIONS = 3.0
# Random linkages of a share: its standard error is 0.1 % at most.
SHARE_LINKAGES = 100_000


def _is_amount(value: object) -> bool:
    return is_real(value) and 0 <= float(value) <= FARTHEST  # type: ignore[arg-type]


Amounts = Annotated[
    float | Mapping[str, float],
    ArgumentType(
        lambda given: (
            all(isinstance(name, str) and _is_amount(value) for name, value in given.items())
            if isinstance(given, Mapping)
            else _is_amount(given)
        ),
        f"a number from 0 to {FARTHEST:g}, in mm, or a table of names with such numbers",
    ),
]

Share = Annotated[float, between(0, 1)]


@record(eq=False)
class SampledDeviations:
    """Deviations of many random linkages, as returned by `ToleranceAnalysis.monte_carlo`.

    Parameters
    ----------
    deviation : array, shape (frames, linkages)
        Of the output from that of the exact linkage; complex for a point. nan where a linkage cannot be assembled.
    assembled : array of bool, shape (frames,)
        Whether the exact linkage can be assembled.
    """

    deviation: Array
    assembled: Mask

    @property
    def not_assembled(self) -> Whole:
        """Number of random linkages that cannot be assembled though the exact one can, (frames,)."""
        counts: Whole = np.isnan(self.deviation).sum(axis=1) * self.assembled
        return counts

    @checked
    def largest(self, share: Share = 0.9973) -> Real:
        """The deviation that a share of the assembled linkages does not exceed, of either sign, (frames,).

        Parameters
        ----------
        share : float
            From 0 to 1, which is the largest deviation of all.

        Returns
        -------
        array, shape (frames,)
            nan if no linkage can be assembled.
        """
        sizes = np.abs(self.deviation)
        sizes.sort(axis=1)
        # Linkages that cannot be assembled are sorted to the end.
        last = np.isfinite(sizes).sum(axis=1) - 1
        index = np.clip(np.ceil(share * (last + 1)).astype(int) - 1, 0, np.maximum(last, 0))
        largest: Real = sizes[np.arange(len(sizes)), index]
        return largest

    @checked
    def share_within(self, bound: float) -> float:
        """Share of the linkages that assemble wherever the exact one does and never deviate by more than `bound`."""
        within = np.abs(self.deviation[self.assembled]) <= bound
        return float(within.all(axis=0).mean())


@record(eq=False)
class ToleranceAnalysis:
    """Deviations of an output at a fixed position of the driver, as returned by `tolerances`.

    Deviations have the unit of the output, rad for an angle, and the shape (frames,); of a point they are those in the
    direction in which it deviates most. They are nan where the linkage is open and at its limits.

    Parameters
    ----------
    motion : Motion
        The exact motion.
    of : str
        The output.
    lengths : mapping of str to float
        Tolerance of each length, mm.
    clearances : mapping of str to float
        Clearance of each pin, mm.
    """

    motion: Motion
    of: str
    lengths: Mapping[str, float]
    clearances: Mapping[str, float]

    @cached_property
    def _quantity(self) -> Quantity:
        known = quantities(self.motion.linkage)
        if self.of not in known:
            raise _unknown("of", self.of, list(known), "quantity")
        return known[self.of]

    @cached_property
    def _directions(self) -> Complex:
        """Unit vectors in which deviations are measured; 1 for an output that is a number."""
        if self._quantity.kind != "point" or self._quantity.part:
            return np.ones(1, dtype=complex)
        half_turn: Complex = np.exp(1j * np.pi * np.arange(DIRECTIONS) / DIRECTIONS)
        return half_turn

    def _along(self, directions: Complex) -> Callable[[str], Real]:
        """Derivatives of the output by a size, in some directions, (frames, directions)."""
        return lambda by: dot(self.motion.sensitivity(self.of, by)[:, None], directions)

    def _terms(self, derivative: Callable[[str], Real]) -> dict[str, Real]:
        """Deviation that each length and each pin alone causes, from derivatives by sizes of two dimensions."""
        terms: dict[str, Real] = {
            name: np.abs(derivative(name)) * tolerance for name, tolerance in self.lengths.items()
        }
        for pin, clearance in self.clearances.items():
            plays = _plays(self.motion.linkage)[pin]
            # Both holes of a pin of two bodies displace an output equally, unless it is the pin itself.
            are_alike = len(plays) == 2 and self._quantity.name != pin
            for owner, place, direction in plays[are_alike:]:
                x, y = (derivative(f"{owner}.{place}.{axis}") for axis in "xy")
                per_mm = np.hypot(x, y) if direction is None else np.abs(x * direction.real + y * direction.imag)
                play = (1.0 if are_alike else 0.5) * clearance * per_mm
                terms[pin] = terms[pin] + play if pin in terms else play
        return terms

    @cached_property
    def _all_terms(self) -> dict[str, Real]:
        return self._terms(self._along(self._directions))

    @cached_property
    def _zeros(self) -> Real:
        """Deviation of the exact linkage, (frames, 1)."""
        return np.where(self.motion.assembled, 0.0, np.nan)[:, None]

    @cached_property
    def contributions(self) -> dict[str, Real]:
        """Deviation that each length or pin alone can cause, (frames,), by its name."""
        return {name: _largest(term) for name, term in self._all_terms.items()}

    @cached_property
    def worst_case(self) -> Real:
        """Deviation if all lengths are at their limits and all pins to one side, whichever adds up most, (frames,)."""
        return _largest(sum(self._all_terms.values(), self._zeros))

    @cached_property
    def root_sum_square(self) -> Real:
        """Root of the sum of the squares of all contributions, (frames,).

        If lengths are normally distributed and their tolerance is three standard deviations, 99.73 % of all linkages
        deviate by less in one direction. Of linkages whose lengths are uniformly distributed fewer do, and of points,
        which deviate in two directions, too; `share_within_root_sum_square` is the share.
        """
        return _largest(np.sqrt(sum((term**2 for term in self._all_terms.values()), self._zeros)))

    @checked
    def share_within_root_sum_square(self, errors: Literal["normal", "uniform"] = "normal") -> float:
        """Share of the linkages whose deviation does not exceed the root sum square, where that is largest.

        Parameters
        ----------
        errors : {"normal", "uniform"}
            Distribution of the lengths: normal, the tolerance being three standard deviations, or uniform within the
            tolerance.

        Returns
        -------
        float
            From 0 to 1; nan if no deviation is known.

        Notes
        -----
        Of 100,000 random linkages, linearised as the root sum square is. A hole lies anywhere within the circle that
        its clearance allows about the pin, with equal probability for equal areas.
        """
        squares = self.root_sum_square
        if not np.isfinite(squares).any():
            return np.nan
        frame, rng = first_largest(squares), np.random.default_rng(0)

        def rate(by: str) -> complex:
            return complex(self.motion.sensitivity(self.of, by)[frame])

        deviation = np.zeros(SHARE_LINKAGES, dtype=complex)
        for name, tolerance in self.lengths.items():
            is_normal = errors == "normal"
            share = rng.normal(0, 1 / DEVIATIONS, SHARE_LINKAGES) if is_normal else rng.uniform(-1, 1, SHARE_LINKAGES)
            deviation += rate(name) * tolerance * share
        for pin, clearance in self.clearances.items():
            for owner, place, direction in _plays(self.motion.linkage)[pin]:
                hole = 0.5 * clearance * _within(direction, rng, SHARE_LINKAGES)
                deviation += rate(f"{owner}.{place}.x") * hole.real + rate(f"{owner}.{place}.y") * hole.imag
        return float(np.mean(np.abs(deviation) <= squares[frame] * (1 + 1e-9)))

    @checked
    def worst_case_along(self, direction: ComplexOrNan) -> Real:
        """Worst-case deviation of a point in one direction, such as across its path.

        Parameters
        ----------
        direction : complex or array_like, shape (frames,)
            The direction; its length has no influence. nan where there is none, as where the linkage is open.

        Returns
        -------
        array, shape (frames,)
            In the unit of the output.
        """
        with np.errstate(all="ignore"):
            directions = np.reshape(direction / np.abs(direction), (-1, 1))
            along: Real = sum(self._terms(self._along(directions)).values(), self._zeros)[:, 0]
        return along

    @cached_property
    def _range_terms(self) -> Real:
        """Deviations of the largest less the smallest value over the frames, one for each length and pin."""
        values = output_values(self.motion, self._quantity)
        if _is_direction(self._quantity):
            values = unwrapped_deg(values)
        if np.iscomplexobj(values) or np.isnan(values).all():
            return np.full(1, np.nan)
        ends = np.array([np.nanargmax(values), np.nanargmin(values)])

        def derivative(by: str) -> Real:
            rates = self.motion.sensitivity(self.of, by)[ends]
            return np.reshape(rates[0] - rates[1], (1, 1))

        return np.array([term.item() for term in self._terms(derivative).values()])

    @property
    def range_worst_case(self) -> float:
        """Worst-case deviation of the output's largest less its smallest value, such as a swing; nan for a point."""
        return float(self._range_terms.sum())

    @property
    def range_root_sum_square(self) -> float:
        """The same as root of the sum of squares."""
        return float(np.sqrt((self._range_terms**2).sum()))

    @checked
    def loosest(self, bound: PositiveFloat, rule: Literal["worst_case", "root_sum_square"] = "worst_case") -> float:
        """The loosest tolerance, equal for all lengths, with which the output keeps within a bound at every frame.

        The clearances stay as they are.

        Parameters
        ----------
        bound : float
            Largest deviation, in the unit of the output.
        rule : {"worst_case", "root_sum_square"}
            The deviation that keeps within it.

        Returns
        -------
        float
            Tolerance, mm; inf if no length has an influence.

        Raises
        ------
        DesignError
            If the clearances alone exceed the bound.
        """
        loosest = float(np.nanmin(self.loosest_at_frames(bound, rule), initial=np.inf))
        if loosest < 0:
            alone = replace(self, lengths={})
            most = rounded_up(np.fmax.reduce(getattr(alone, rule)), 4)
            problem = f"found {bound:g}, and the clearances of the pins alone cause {most}"
            raise DesignError("bound", problem, f"give more than {most}, or smaller clearances")
        return loosest

    def loosest_at_frames(self, bound: float, rule: Literal["worst_case", "root_sum_square"]) -> Real:
        """The loosest tolerance at each frame, mm; negative if the clearances alone exceed the bound there."""
        power = 1 if rule == "worst_case" else 2
        unit = replace(self, lengths=dict.fromkeys(self.lengths, 1.0), clearances={})
        play = sum((self._all_terms[pin] ** power for pin in self.clearances), self._zeros)
        per_mm = sum((term**power for term in unit._all_terms.values()), self._zeros)
        with np.errstate(all="ignore"):
            tolerance = (bound**power - play) / per_mm
        loosest: Real = np.fmin.reduce(np.sign(tolerance) * np.abs(tolerance) ** (1 / power), axis=1)
        return loosest

    @checked
    def monte_carlo(
        self,
        linkages: Annotated[int, whole_between(1, 10_000_000)] = 10_000,
        seed: Annotated[int, whole_between(0, 2**32 - 1)] = 0,
    ) -> SampledDeviations:
        """Deviations of random linkages, each solved exactly.

        Parameters
        ----------
        linkages : int
            Number of linkages.
        seed : int
            Seed of the random numbers; the same one gives the same linkages.

        Returns
        -------
        SampledDeviations

        Raises
        ------
        DesignError
            If there are more than 20 million linkages times frames, or if the branches are followed from frame to
            frame, which takes minutes and much memory for many linkages.

        Notes
        -----
        Lengths are normally distributed, their tolerance being three standard deviations. A hole lies anywhere within
        the circle that its clearance allows about the pin, with equal probability for equal areas.
        """
        frames = len(self.motion.drive)
        if linkages * frames > MOST_SAMPLES:
            most = f"give at most {MOST_SAMPLES // frames:,} linkages, or fewer frames"
            raise DesignError("linkages", f"found {linkages:,} with {frames:,} frames each", most, "too-much-work")
        if self.motion.solution.spec.follow:
            remedy = "use the worst case or the root sum square, or a branch of 1 or -1"
            raise DesignError("branch", "found follow, which is too slow for many linkages", remedy, "too-much-work")
        rng = np.random.default_rng(seed)
        exact = output_values(self.motion, self._quantity)[:, None]
        deviation = np.empty((frames, linkages), dtype=exact.dtype)
        timing = self.motion.timing
        rates = (np.ravel(rate) if np.ndim(rate) else float(rate) for rate in (timing.speed, timing.acceleration))
        speed, acceleration = rates
        for start in range(0, linkages, BATCH):
            random = self._random(rng, min(BATCH, linkages - start))
            try:
                motion = move(random, self.motion.drive, self.motion.solution.spec, speed, acceleration)
            except DesignError as error:
                remedy = "use the worst case or the root sum square"
                raise DesignError("linkages", error.problem, remedy, error.id) from None
            values = output_values(motion, self._quantity)
            apart = np.angle(values * np.conj(exact)) if _is_direction(self._quantity) else values - exact
            deviation[:, start : start + BATCH] = apart
        return SampledDeviations(deviation.real if _is_direction(self._quantity) else deviation, self.motion.assembled)

    def _random(self, rng: np.random.Generator, count: int) -> Linkage:
        """Linkages with random lengths and positions of their holes about the pins."""
        general, numbers = self.motion.linkage, entry_numbers(self.motion.linkage)
        data, moved = linkage_data(general), dict[int, complex | Array]()
        for name, tolerance in self.lengths.items():
            rate, steps = size_rates(self.motion.given, [name])[:, 0], rng.normal(0, tolerance / DEVIATIONS, count)
            for k in np.flatnonzero(rate).tolist():
                moved[k] = moved.get(k, data[k]) + rate[k] * steps
        for pin, clearance in self.clearances.items():
            for owner, place, direction in _plays(general)[pin]:
                k = numbers[owner, place]
                moved[k] = moved.get(k, data[k]) + 0.5 * clearance * _within(direction, rng, count)
        if all(k >= sum(map(len, general.bodies.values())) for k in moved):
            # The points are arrays even if none of them is inexact.
            moved[0] = data[0] + np.zeros(count)
        bodies = {
            body: {point: moved.get(numbers[body, point], z) for point, z in points.items()}
            for body, points in general.bodies.items()
        }

        def varied(joint: Joint) -> Joint:
            places = {name: numbers[joint.name, name] for name in joint.sizes if not name.endswith("_deg")}
            return joint.with_sizes({place: moved[k] for place, k in places.items() if k in moved})

        return replace(general, bodies=bodies, **general.with_joints(varied))


def _plays(linkage: Linkage) -> dict[str, tuple[Play, ...]]:
    """By the name of each joint with a clearance, the places that it leaves free to move."""
    return {joint.name: joint.plays for joint in linkage.joints if joint.plays}


def _within(direction: complex | None, rng: np.random.Generator, count: int) -> Complex:
    """Random points of the unit circle's area, with equal probability for equal areas; or of its diameter."""
    if direction is not None:
        across: Complex = rng.uniform(-1, 1, count) * direction
        return across
    radius = np.sqrt(rng.random(count))
    points: Complex = radius * np.exp(2j * np.pi * rng.random(count))
    return points


def _largest(terms: Real) -> Real:
    largest: Real = terms.max(axis=1)
    return largest


def _is_direction(quantity: Quantity) -> bool:
    return quantity.kind == "body" and quantity.order == 0


def output_values(motion: Motion, quantity: Quantity) -> Array:
    """Values of a quantity at the frames; of an angle its direction, a unit complex number."""
    match quantity.kind:
        case "point":
            point = motion.point(quantity.name)
            values = (point.position, point.velocity, point.acceleration)[quantity.order]
            return {"x": values.real, "y": values.imag}.get(quantity.part, values)
        case "body":
            body = motion.bodies[quantity.name]
            return body.direction if not quantity.order else (body.omega, body.alpha)[quantity.order - 1]
        case "slider":
            slide = motion.slide(quantity.name)
            return (slide.displacement, slide.velocity, slide.acceleration)[quantity.order]
    return motion.transmission_angle


def length_names(linkage: AbstractLinkage) -> list[str]:
    """Names of the lengths of a linkage, to which a tolerance applies.

    Those of a named linkage are its fields in mm, and the coordinates of its points. A general one has the coordinates
    of the points of each body from its first point, without those of the direction to its second point.
    """
    general = linkage.linkage
    entries = {f"{owner}.{name}" if owner else name for owner, name in entry_numbers(general)}
    names = [
        name
        for name in size_names(linkage)
        if not name.endswith(("_deg", "origin.x", "origin.y"))
        and name.removesuffix(".x").removesuffix(".y") not in entries
    ]
    if names:
        return names
    for body, points in general.bodies.items():
        places = list(points.items())
        for k, (point, place) in enumerate(places[1:]):
            apart = complex(place) - complex(places[0][1])
            names += [f"{body}.{point}.x"] * bool(k or apart.real or not apart.imag)
            names += [f"{body}.{point}.y"] * bool(k or apart.imag)
    return names


def _unknown(field: str, name: str, known: list[str], meaning: str) -> DesignError:
    near = get_close_matches(name, known, 3, 0.4)
    remedy = f"give {', '.join(near)}" if near else f"give one of {', '.join(known[:20])}"
    return DesignError(field, f"found {shown(name)}, which is the name of no {meaning}", remedy, "unknown-key")


@checked
def tolerances(motion: Motion, of: str, lengths: Amounts = 0.0, clearances: Amounts = 0.0) -> ToleranceAnalysis:
    """Find how much an output deviates if lengths and pins are not exact.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    of : str
        The output: a point's name, or the id of a column of `motion_table`, as `Motion.sensitivity` takes it.
    lengths : float or mapping of str to float
        Tolerance, mm: a length lies between its nominal value minus and plus this. A number is that of every length:
        the fields in mm of a named linkage, the coordinates of the points of a general one. A mapping gives that of
        single ones, by the names that `Motion.sensitivity` takes, such as `crank` or `coupler_point.x`.
    clearances : float or mapping of str to float
        Diametral clearance, mm: by how much the holes of a pin are wider than it. Each hole may lie anywhere within
        the circle of that diameter about the pin. A number is that of every pin. If a pin is fixed in one of
        two bodies, give half of it. A pin in a slot has the name of the slot, and moves across it.

    Returns
    -------
    ToleranceAnalysis
        Worst case, root sum square and contributions from exact derivatives; Monte Carlo and the loosest tolerance on
        request.

    Raises
    ------
    DesignError
        If there is no such output, length or pin, or the motion is of arrays of linkages.

    See Also
    --------
    move, sweep

    Notes
    -----
    Worst case and root sum square are linearised: they hold for deviations that are small compared with the linkage,
    and not next to a dead centre. The Monte Carlo analysis solves every linkage. Chase and Parkinson, A survey of
    research in the application of tolerance analysis to the design of mechanical assemblies, Research in Engineering
    Design 3, 1991.

    Examples
    --------
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j), [0.0, 1.0])
    >>> analysis = gk.tolerances(motion, of="coupler_point", lengths=0.1, clearances=0.05)
    >>> analysis.worst_case.round(4)
    array([0.5325, 0.4671])
    >>> round(analysis.loosest(0.5), 4)
    0.0907
    """
    if motion.linkage.is_batch:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time", "wrong-type")
    pins = list(_plays(motion.linkage))
    names = length_names(motion.given)
    by_length = dict(lengths) if isinstance(lengths, Mapping) else dict.fromkeys(names, float(lengths))
    by_pin = dict(clearances) if isinstance(clearances, Mapping) else dict.fromkeys(pins, float(clearances))
    for name in by_length:
        if name not in names and (name.endswith("_deg") or name not in size_names(motion.given)):
            raise _unknown("lengths", name, names, "length")
    for pin in by_pin:
        if pin not in pins:
            raise _unknown("clearances", pin, pins, "pin")
    analysis = ToleranceAnalysis(
        motion,
        of,
        {name: float(value) for name, value in by_length.items() if value},
        {pin: float(value) for pin, value in by_pin.items() if value},
    )
    _ = analysis._quantity
    return analysis

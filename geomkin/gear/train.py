"""Gear trains: stages of two gears, of which the driven one shares its arbor with the next driver, and their search."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import accumulate
from math import prod
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..core.arguments import ArgumentType, FloatOrNan, PositiveFloat, between, checked, whole_between
from ..core.errors import DesignError
from ..core.fields import (
    EXACT_DIGITS,
    as_fraction,
    entry,
    moving_picture,
    quantity,
    rounded_up,
    significant_digits,
    to_digits,
)
from ..core.records import record
from ..core.units import mm
from ..model.table import Column, Table
from ..plane.vec import Complex, Pose, Real
from .cutters import LARGEST, RackCutter
from .pair import GearPair
from .spur import SpurGear

# Teeth of a gear of a train: with fewer, no profile shift leaves teeth that mesh well; with more, searches are slow.
FEWEST_TEETH, MOST_TEETH = 6, 1000
MOST_STAGES = 8

Teeth = Annotated[int, whole_between(FEWEST_TEETH, MOST_TEETH)]
Direction = Annotated[float, between(-3600, 3600, "deg")]
Stages = tuple[tuple[Teeth, Teeth], ...]


@record(checked=True)
class GearTrain:
    """A train of spur gears. The first arbor is at the origin; each stage is in its own layer.

    Small gears have the least profile shift without undercut. Their mates have the opposite shift, or the part of it
    that leaves them without undercut.

    Parameters
    ----------
    stages : tuple of tuple of int
        Teeth of the driver and of the driven gear of each stage, 1 to 8 stages. The driven gear is fixed to the driver
        of the next stage.
    module : float
        Pitch diameter per tooth of all gears, mm, above 0.
    directions_deg : tuple of float, optional
        Direction from each arbor to the next one, deg; by default all arbors are on +x. With 0 and 180 two stages of
        equal centre distances form a reverted train: input and output are on one axis.
    backlash : float, optional
        Backlash of each mesh along the working pitch circles, modules, 0 to 0.5.
    friction : float, optional
        Mean coefficient of friction of the flanks, 0 to 1.

    Raises
    ------
    DesignError
        If a number of teeth is out of range, or there are more or fewer directions than stages.

    See Also
    --------
    gear_train, GearPair

    Examples
    --------
    >>> train = gk.GearTrain(((10, 30), (8, 32)), module=2, directions_deg=(0, 180))
    >>> train.ratio, train.axes.round(9)
    (12.0, array([ 0.+0.j, 40.+0.j,  0.+0.j]))
    """

    stages: Stages = entry("teeth of driver and driven gear of each stage", example=((10, 30), (8, 32)))
    module: float = quantity("pitch diameter per tooth", "mm", above=0, at_most=LARGEST, example=2)
    directions_deg: tuple[Direction, ...] = entry("direction from each arbor to the next one, deg", default=())
    backlash: float = quantity(
        "backlash of each mesh along the pitch circles", "modules", default=0.04, at_least=0, at_most=0.5
    )
    friction: float = quantity("mean coefficient of friction of the flanks", default=0.1, at_least=0, at_most=1)

    _repr_html_ = moving_picture

    def __post_init__(self) -> None:
        if not 1 <= len(self.stages) <= MOST_STAGES:
            problem = f"found {len(self.stages)} stages"
            raise DesignError("stages", problem, f"give 1 to {MOST_STAGES}", "out-of-range")
        if len(self.directions_deg) not in (0, len(self.stages)):
            problem = f"found {len(self.directions_deg)} for {len(self.stages)} stages"
            raise DesignError("directions_deg", problem, "give one for each stage, or none", "conflict")
        self.pairs  # noqa: B018  raises for gears that cannot be made or do not mesh

    @cached_property
    def pairs(self) -> tuple[GearPair, ...]:
        """The gears of each stage in mesh."""
        allowance = self.backlash * self.module / 2
        pairs = []
        for teeth in self.stages:
            first, second = (
                SpurGear(z, self.module, x, tooth_thickness_allowance=allowance, on_pointed_tip="cut")
                for z, x in zip(teeth, _shifts(*teeth))
            )
            pairs.append(GearPair(first, second))
        return tuple(pairs)

    @property
    def ratio(self) -> float:
        """Rotations of the first gear for one of the last; negative if they turn in opposite directions."""
        return float(prod(Fraction(-driven, driver) for driver, driven in self.stages))

    @property
    def speeds(self) -> tuple[Fraction, ...]:
        """Rotations of each arbor's gears for one rotation of the first gear, (stages + 1,), exact."""
        return tuple(accumulate((Fraction(-a, b) for a, b in self.stages), lambda x, y: x * y, initial=Fraction(1)))

    @property
    def directions(self) -> Complex:
        """Unit directions from each arbor to the next one, (stages,)."""
        given = self.directions_deg if len(self.directions_deg) else (0.0,) * len(self.stages)
        # Whole quarter turns are exact, so that reverted trains have coaxial arbors.
        return np.array([1j ** (d // 90) * np.exp(1j * np.radians(d % 90)) for d in given])

    @property
    def axes(self) -> Complex:
        """Axes of the first gear and of the driven gear of each stage, mm, (stages + 1,)."""
        steps = np.array([pair.centre_distance for pair in self.pairs]) * self.directions
        return np.concatenate([[0j], np.cumsum(steps)])

    @cached_property
    def arbors(self) -> tuple[str, ...]:
        """Letter of the arbor of each axis, from A, (stages + 1,); coaxial gears have one arbor."""
        axes, limit, arbors = self.axes, 1e-9 * self.module, list[str]()
        for k, axis in enumerate(axes):
            coaxial = next((j for j in range(k) if abs(axes[j] - axis) <= limit), None)
            arbors.append(chr(ord("A") + len(set(arbors))) if coaxial is None else arbors[coaxial])
        return tuple(arbors)

    @property
    def arbor_axes(self) -> dict[str, complex]:
        """Axes of the arbors by their letters from A, mm."""
        axes: dict[str, complex] = {}
        for arbor, axis in zip(self.arbors, self.axes):
            axes.setdefault(arbor, complex(axis))
        return axes

    @property
    def efficiencies(self) -> tuple[float, ...]:
        """Efficiency of each mesh at the given friction.

        Notes
        -----
        1 - friction H_V, with the tooth loss factor H_V = pi (1/z1 + 1/z2) (1 - e + e1^2 + e2^2), where e1 and e2 are
        the contact ratios on either side of the pitch point and e their sum (Niemann and Winter, Maschinenelemente II;
        ISO/TR 14179-2). Two pairs of flanks in contact share the force equally. Friction of the bearings is not
        included.
        """
        return tuple(1 - self.friction * loss_factor(pair) for pair in self.pairs)

    @property
    def efficiency(self) -> float:
        """Efficiency of the train: the product of those of its meshes."""
        return prod(max(efficiency, 0.0) for efficiency in self.efficiencies)

    @checked
    def poses(self, turn: FloatOrNan) -> tuple[Pose, ...]:
        """Poses of the gears on each axis at rotations of the first gear.

        Parameters
        ----------
        turn : float or array_like
            Rotations of the first gear, rad, any shape; at 0 it has a tooth on +y.

        Returns
        -------
        tuple of Pose, length stages + 1
            The first gear, then the driven gear of each stage and the driver fixed to it, whose teeth on +y of their
            frame coincide. Teeth are in the middle of the spaces of their mates.
        """
        angle = np.asarray(turn, dtype=float)
        poses = [Pose(np.zeros(angle.shape, complex), np.exp(1j * angle))]
        for pair, direction, axis in zip(self.pairs, self.directions, self.axes[1:]):
            # A pair's contact is on +y of its driver.
            incline = float(np.angle(direction / 1j))
            angle = (angle - incline) / pair.ratio + np.pi / pair.second.teeth + np.pi + incline
            poses.append(Pose(np.full(angle.shape, axis), np.exp(1j * angle)))
        return tuple(poses)


def _shifts(first: int, second: int) -> tuple[float, float]:
    """Profile shifts of two gears, modules: opposite ones if that leaves neither undercut, else the least ones."""
    rack = RackCutter()
    # Negative limits are the room of large gears.
    limits = [rack.flank_depth - z / 2 * np.sin(rack.pressure_angle) ** 2 for z in (first, second)]
    x1, x2 = (max(0.0, float(limit)) for limit in limits)
    return (x1 or max(-x2, limits[0])) + 0.0, (x2 or max(-x1, limits[1])) + 0.0


@checked
def loss_factor(pair: GearPair) -> float:
    """Tooth loss factor of a mesh: lost power over transmitted power, per unit of friction.

    Parameters
    ----------
    pair : GearPair
        Two gears in mesh.

    Returns
    -------
    float
        H_V of `GearTrain.efficiencies`; of a ring, 1/z2 is subtracted.

    Examples
    --------
    >>> round(gk.gear.loss_factor(gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2))), 4)
    0.1661
    """
    start, end = pair.contact_lengths
    pitch_point = pair.first.base_radius * np.tan(pair.working_pressure_angle)
    before, after = (pitch_point - start) / pair.first.base_pitch, (end - pitch_point) / pair.first.base_pitch
    lengths = 1 - before - after + before**2 + after**2
    side = -1 if pair.is_internal else 1
    return float(np.pi * (1 / pair.first.teeth + side / pair.second.teeth) * lengths)


# Rows of the table of a train: one rotation of the first gear in degrees.
ROWS = 361


@checked
def train_table(train: GearTrain) -> Table:
    """Rotations of all gears of a train during one rotation of the first.

    Parameters
    ----------
    train : GearTrain
        The train.

    Returns
    -------
    Table
        One row for each degree.

    Examples
    --------
    >>> float(gk.gear.train_table(gk.GearTrain(((12, 36), (12, 48)), 2))["driven_2_turn"][-1])
    30.0
    """
    return Table(tuple(turn_columns(train, np.linspace(0, 2 * np.pi, ROWS))))


def turn_columns(train: GearTrain, turn: Real) -> Iterator[Column]:
    """Rotations of all gears, deg, at rotations of the first gear, rad."""
    yield Column("driver_1_turn", "deg", "rotation of the first gear", np.degrees(turn))
    for k, speed in enumerate(train.speeds[1:], start=1):
        on = f" and driver_{k + 1}" if k < len(train.stages) else ""
        yield Column(f"driven_{k}_turn", "deg", f"rotation of driven_{k}{on}", np.degrees(turn) * float(speed))


# Relative error within which a ratio counts as exact: rounding of products of fractions, and far less than the
# difference of any two trains.
EXACT = 1e-12
# Largest number of pairs of stages that a search of three stages tries: about two seconds.
MOST_PAIRS = 4_000_000
# Most stages of a search, and largest ratio.
MOST_SEARCHED, LARGEST_RATIO = 3, 1e9
# Teeth of a pair of which at least one gear needs no positive shift against undercut, for 20 deg: 2 x 17.1.
UNDERCUT_FREE = 35

SearchedTeeth = Annotated[int, whole_between(FEWEST_TEETH, MOST_TEETH)]
SearchedStages = Annotated[int, whole_between(1, MOST_SEARCHED)]
NUMBER_RATIO = between(1 / LARGEST_RATIO, LARGEST_RATIO)
TrainRatio = Annotated[
    float | Fraction,
    ArgumentType(
        lambda value: NUMBER_RATIO.fits(float(value) if isinstance(value, Fraction) else value),
        f"{NUMBER_RATIO.allowed}, or a Fraction",
        NUMBER_RATIO.types,
    ),
]
Error = Annotated[float, between(0, 0.5)]


@checked
def gear_train(
    ratio: TrainRatio,
    module: PositiveFloat = 1.0,
    *,
    least_teeth: SearchedTeeth = 12,
    most_teeth: SearchedTeeth = 60,
    most_stages: SearchedStages = 3,
    error: Error = 0.0,
    reverted: bool = False,
    centre_distance: PositiveFloat | None = None,
) -> GearTrain:
    """Find the gear train of a ratio with the fewest gears and, of those, the fewest teeth.

    Parameters
    ----------
    ratio : float or Fraction
        Rotations of the first gear for one of the last, above 0, in either direction: an even number of stages turns
        the last gear like the first. A decimal of ten or more digits also counts as any fraction that it rounds.
    module : float, optional
        Module of all gears, mm.
    least_teeth, most_teeth : int, optional
        Bounds of the teeth of each gear, 6 to 1000.
    most_stages : int, optional
        Largest number of stages, 1 to 3.
    error : float, optional
        Largest relative error of the ratio; 0 for an exact train.
    reverted : bool, optional
        Whether the train has two stages of equal centre distances, with input and output on one axis.
    centre_distance : float, optional
        Centre distance of every stage, mm; free if omitted.

    Returns
    -------
    GearTrain
        The train, with the least error if several have as few teeth. Its arbors are on the x axis.

    Raises
    ------
    DesignError
        If no train within the bounds has the ratio; the message names the nearest one.

    See Also
    --------
    GearTrain, GearPair

    Notes
    -----
    For each ratio of one stage only the pair with the fewest teeth is kept. The last stage is looked up in the sorted
    ratios, so that every train within the bounds is considered.

    Examples
    --------
    >>> gk.gear_train(60, least_teeth=8, most_teeth=64).stages
    ((8, 60), (8, 64))
    >>> gk.gear_train(12, least_teeth=8, reverted=True).stages
    ((10, 30), (8, 32))
    """
    if least_teeth > most_teeth:
        raise DesignError(
            "least_teeth", f"found {least_teeth}, more than most_teeth = {most_teeth}",
            f"give at most {most_teeth}", "conflict",
        )  # fmt: skip
    if reverted and most_stages < 2:
        raise DesignError("most_stages", f"found {most_stages} for a reverted train", "give at least 2", "conflict")
    total = None if centre_distance is None else _teeth_of(centre_distance, module, least_teeth, most_teeth)
    candidate = _find(float(ratio), least_teeth, most_teeth, most_stages, float(error), reverted, total)
    return _train(candidate, module, reverted, centre_distance)


@record(eq=False)
class _Pairs:
    """Pairs of gears by rising ratio, one of each ratio, all of shape (pairs,)."""

    ratio: Real
    driver: NDArray[np.int64]
    driven: NDArray[np.int64]

    @property
    def teeth(self) -> NDArray[np.int64]:
        """Teeth of both gears."""
        return self.driver + self.driven


@record
class _Candidate:
    """Stages of a train, its number of teeth, and the relative error of its ratio."""

    stages: tuple[tuple[int, int], ...]
    teeth: int
    error: float


# Cached, since an editor makes the recipe again at each step of a drag, mostly with the same bounds.
@lru_cache(maxsize=16)
def _find(
    ratio: float, least: int, most: int, most_stages: int, error: float, reverted: bool, total: int | None
) -> _Candidate:
    """The train with the fewest gears, then the fewest teeth. total: teeth of each stage, None if they are free."""
    nearest: _Candidate | None = None
    for stages in (2,) if reverted else range(1, most_stages + 1):
        # The teeth of reverted trains rise with the sum of each stage: the first candidate has the fewest.
        for pairs in _choices(least, most, reverted, total):
            candidate, next_best = _search(pairs, ratio, stages, error)
            if candidate is not None:
                return candidate
            nearest = next_best if nearest is None or next_best.error < nearest.error else nearest
    assert nearest is not None
    raise _unreachable(ratio, error, nearest, least, most, 2 if reverted else most_stages)


def _choices(least: int, most: int, reverted: bool, total: int | None) -> Iterator[_Pairs]:
    """The pairs from which all stages of a train are chosen; for reverted trains, those of each sum of teeth."""
    z = np.arange(least, most + 1)
    driver, driven = (side.ravel() for side in np.meshgrid(z, z, indexing="ij"))
    sums = [total] if total is not None else range(2 * least, 2 * most + 1) if reverted else [None]
    for teeth in sums:
        keep = slice(None) if teeth is None else driver + driven == teeth
        a, b = driver[keep], driven[keep]
        # Equal fractions of whole numbers have equal quotients, rounded correctly.
        order = np.lexsort((a + b, b / a))
        a, b = a[order], b[order]
        first = np.concatenate([[True], np.diff(b / a) > 0])
        yield _Pairs((b / a)[first], a[first], b[first])


def _search(pairs: _Pairs, ratio: float, stages: int, error: float) -> tuple[_Candidate | None, _Candidate]:
    """The train with the fewest teeth within the error, None if there is none, and the one of the nearest ratio."""
    count = len(pairs.ratio)
    if stages == 3 and count * (count + 1) // 2 > MOST_PAIRS:
        problem = f"found bounds that allow {count:,} ratios of one stage, too many for a search of three stages"
        raise DesignError("most_teeth", problem, "give a smaller most_teeth, or most_stages = 2", "too-much-work")
    lookup, teeth = _Lookup(pairs, max(error, EXACT, _rounding(ratio))), pairs.teeth
    best: _Candidate | None = None
    nearest: _Candidate | None = None
    for heads in _heads(np.argsort(teeth, kind="stable"), stages):
        # A row's first pair has the fewest teeth of its train.
        if best is not None and stages * int(teeth[heads[0, 0]] if stages > 1 else 0) >= best.teeth:
            break
        wanted = ratio / pairs.ratio[heads].prod(axis=1)
        fewest, closest = lookup(wanted)
        inside = np.flatnonzero(fewest >= 0)
        if inside.size:
            sums = teeth[heads[inside]].sum(axis=1) + teeth[fewest[inside]]
            errors = np.abs(pairs.ratio[fewest[inside]] / wanted[inside] - 1)
            k = int(inside[np.lexsort((errors, sums))[0]])
            candidate = _candidate(pairs, (*heads[k], fewest[k]), ratio)
            if best is None or (candidate.teeth, candidate.error) < (best.teeth, best.error):
                best = candidate
        k = int(np.abs(pairs.ratio[closest] / wanted - 1).argmin())
        candidate = _candidate(pairs, (*heads[k], closest[k]), ratio)
        nearest = candidate if nearest is None or candidate.error < nearest.error else nearest
    assert nearest is not None
    return best, nearest


def _rounding(ratio: float) -> float:
    """Relative error of a ratio's last digit, if it has so many that it may be a rounded fraction; otherwise 0."""
    digits, last = significant_digits(ratio)
    return last / 2 / ratio if digits > EXACT_DIGITS and not ratio.is_integer() else 0.0


def _heads(order: NDArray[np.int64], stages: int) -> Iterator[NDArray[np.int64]]:
    """Indices of all pairs but the last of trains, in blocks of shape (trains, stages - 1); order: by rising teeth."""
    if stages == 1:
        yield np.zeros((1, 0), dtype=np.int64)
    elif stages == 2:
        yield order[:, None]
    else:
        for k in range(len(order)):
            rest = order[k:]
            yield np.column_stack([np.full_like(rest, order[k]), rest])


def _candidate(pairs: _Pairs, chosen: tuple[np.int64, ...], ratio: float) -> _Candidate:
    stages = tuple((int(pairs.driver[k]), int(pairs.driven[k])) for k in chosen)
    error = abs(float(np.prod(pairs.ratio[list(chosen)])) / ratio - 1)
    return _Candidate(stages, sum(map(sum, stages)), error)


class _Lookup:
    """Finds, for wanted ratios, the pair with the fewest teeth within a relative error, and the nearest pair."""

    def __init__(self, pairs: _Pairs, error: float):
        self._ratio, self._teeth, self._error = pairs.ratio, pairs.teeth, error
        # Row k holds, for each start, the index of the fewest teeth among 2^k pairs.
        self._fewest = [np.arange(len(pairs.ratio))]
        while len(self._fewest[-1]) > (half := 2 ** (len(self._fewest) - 1)):
            left, right = self._fewest[-1][:-half], self._fewest[-1][half:]
            self._fewest.append(np.where(self._teeth[left] <= self._teeth[right], left, right))

    def __call__(self, wanted: Real) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Indices of both pairs, (wanted,); -1 if no pair is within the error."""
        low = np.searchsorted(self._ratio, wanted * (1 - self._error))
        high = np.searchsorted(self._ratio, wanted * (1 + self._error), side="right")
        fewest = np.full(wanted.shape, -1)
        width = high - low
        for level in np.unique(np.frexp(width[width > 0])[1] - 1).tolist():
            k = np.flatnonzero((width >= 2**level) & (width < 2 ** (level + 1)))
            left, right = self._fewest[level][low[k]], self._fewest[level][high[k] - 2**level]
            fewest[k] = np.where(self._teeth[left] <= self._teeth[right], left, right)
        above = np.searchsorted(self._ratio, wanted)
        before, after = np.maximum(above - 1, 0), np.minimum(above, len(self._ratio) - 1)
        nearer = np.abs(self._ratio[before] - wanted) <= np.abs(self._ratio[after] - wanted)
        return fewest, np.where(nearer, before, after)


def _train(candidate: _Candidate, module: float, reverted: bool, centre_distance: float | None) -> GearTrain:
    """The train of a candidate; without a common centre distance, its smallest gears are paired with each other."""
    stages = candidate.stages
    if not reverted and centre_distance is None:
        drivers, driven = (sorted(side) for side in zip(*stages))
        stages = tuple(zip(drivers, driven))
    train = GearTrain(tuple(sorted(stages, key=sum)), module, (0.0, 180.0) if reverted else ())
    distance = train.pairs[0].centre_distance
    if centre_distance is not None and abs(distance / centre_distance - 1) > 1e-6:
        problem = f"found {mm(centre_distance):g}, at which gears of so few teeth would be undercut"
        least = UNDERCUT_FREE * module / 2
        remedy = f"give at least {mm(least):up}"
        raise DesignError("centre_distance", problem, remedy, value=rounded_up(least))
    return train


def _teeth_of(centre_distance: float, module: float, least: int, most: int) -> int:
    """Teeth of both gears of a stage with a centre distance. Raises DesignError with the nearest that works."""
    teeth = 2 * centre_distance / module
    nearest = int(min(max(round(teeth), 2 * least), 2 * most))
    if abs(teeth - nearest) > 1e-6 * nearest:
        problem = f"found {mm(centre_distance):g}, which {teeth:.6g} teeth of module {mm(module):g} would need"
        distance = to_digits(nearest * module / 2, 10)
        remedy = f"give {mm(distance):.10g}, for {nearest} teeth"
        raise DesignError("centre_distance", problem, remedy, value=distance)
    return nearest


def _unreachable(ratio: float, error: float, nearest: _Candidate, least: int, most: int, stages: int) -> DesignError:
    """The error for a ratio that no train within the bounds has."""
    value = prod(Fraction(b, a) for a, b in nearest.stages)
    teeth = " x ".join(f"{b}/{a}" for a, b in nearest.stages)
    limit = f" within {error:g}" if error else ""
    plural = "s" if stages > 1 else ""
    shown = fraction if isinstance(fraction := as_fraction(ratio), str) else f"{ratio:.12g}"
    return DesignError(
        "ratio",
        f"found {shown}, which no train of at most {stages} stage{plural} of {least} to {most} teeth has{limit}",
        f"give {float(value):.12g} ({teeth}), an error of at least {rounded_up(nearest.error, 3)}, or wider bounds",
    )

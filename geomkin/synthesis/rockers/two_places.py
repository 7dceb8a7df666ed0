"""What a four-bar that stands at two places does between them: defects, the way back, the transmission angle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...plane.vec import Complex, Mask, Real, Whole, cross

# rad by which a rocker's real swing may miss the wanted one: rounding misses by far less, another turn by 2 pi.
MISSED = 1e-6
# Share of the longest link by which a four-bar may be Grashof's and still have but one circuit: a change point.
# Smaller, and rounding makes two circuits of a parallelogram's one; larger, and it joins two that do not meet.
MEETS = 1e-12
# rad of the transmission angle, below which a place is a dead centre, from which nothing tells the way on. Smaller, and
# rounding decides, which is the root of a number's last digit there; larger, and it takes poor drives for none.
DEAD = 1e-6


@dataclass(frozen=True)
class TwoPlaces:
    """The two places, rad."""

    crank_start: float
    crank_swing: float
    rocker_start: float
    rocker_swing: float

    @property
    def crank(self) -> tuple[float, float]:
        return self.crank_start, self.crank_start + self.crank_swing

    @property
    def rocker(self) -> tuple[float, float]:
        return self.rocker_start, self.rocker_start + self.rocker_swing

    @property
    def tie(self) -> Real:
        """Coefficients, of 1/ground, 1/crank and 1/rocker, whose sum is 0. As products: differences lose digits."""
        (one, other), (first, second) = self.crank, self.rocker
        relative = self.crank_swing - self.rocker_swing
        return np.array([
            np.sin(0.5 * (one + other - first - second)) * np.sin(0.5 * relative),
            -np.sin(0.5 * (first + second)) * np.sin(0.5 * self.rocker_swing),
            np.sin(0.5 * (one + other)) * np.sin(0.5 * self.crank_swing),
        ])  # fmt: skip


@dataclass(frozen=True, eq=False)
class Between:
    """What four-bars do between the two places, (linkages,): masks, the branch, and the least transmission, rad."""

    circuit: Mask
    branch: Mask
    order: Mask
    turns_back: Mask
    sign: Whole
    least: Real
    at_places: Real

    @property
    def sound(self) -> Mask:
        return ~(self.circuit | self.branch | self.order)

    def defects(self, k: int) -> tuple[str, ...]:
        return tuple(name for name in ("circuit", "branch", "order") if getattr(self, name)[k])


def between_places(wanted: TwoPlaces, sizes: Mapping[str, Real]) -> Between:
    """Of four-bars that stand at both places. Circuits by the joint that faces the shortest link; derived here."""
    with np.errstate(all="ignore"):
        return _of_lengths(wanted, *(sizes[name] for name in ("ground", "crank", "coupler", "rocker")))


def _of_lengths(wanted: TwoPlaces, ground: Real, crank: Real, coupler: Real, rocker: Real) -> Between:
    start, end = sorted(wanted.crank)
    spans = [_square(ground, crank, turn) for turn in wanted.crank]
    # Crank and ground in line, if they are on the way: the diagonal is least, or greatest.
    for turn in (0.0, np.pi):
        if _inside(turn, start, end):
            spans.append(_square(ground, crank, turn))
    least_span, most_span = np.min(spans, axis=0), np.max(spans, axis=0)
    closed = (least_span > (coupler - rocker) ** 2) & (most_span < (coupler + rocker) ** 2)
    cosines = [(coupler**2 + rocker**2 - span) / (2 * coupler * rocker) for span in (least_span, most_span)]
    at_places = [(coupler**2 + rocker**2 - span) / (2 * coupler * rocker) for span in spans[:2]]
    signs, joints = zip(*(_joints(ground, crank, rocker, *place) for place in zip(wanted.crank, wanted.rocker)))
    shortest = np.argmin([ground, crank, coupler, rocker], axis=0)
    lengths = np.sort([ground, crank, coupler, rocker], axis=0)
    grashof = lengths[1] + lengths[2] - lengths[0] - lengths[3] > MEETS * lengths[3]
    # The joint that is not at the shortest link: ground or crank, rocker pin; coupler, crank pivot; rocker, crank pin.
    facing = [np.choose(shortest, [joint[0], joint[0], joint[1], joint[2]]) for joint in joints]
    circuit = grashof & (np.sign(facing[0]) != np.sign(facing[1]))
    at_least = np.arccos(np.minimum(np.abs(at_places).max(axis=0), 1.0))
    branch = ~circuit & ((signs[0] != signs[1]) | (at_least < DEAD))
    swing = _swing(wanted, ground, crank, coupler, rocker, signs[0])
    order = ~circuit & ~branch & (~closed | (np.abs(swing - wanted.rocker_swing) > MISSED))
    back = np.zeros_like(closed)
    for reach, side in ((coupler + crank, 1), (crank - coupler, -1)):
        cosine = (ground**2 + reach**2 - rocker**2) / (2 * ground * reach)
        at = side * signs[0] * np.arccos(cosine)
        back |= _inside(at, start, end)
    return Between(
        circuit=circuit,
        branch=branch,
        order=order,
        turns_back=back,
        sign=np.where(signs[0] < 0, -1, 1),
        least=np.where(closed, np.arccos(np.minimum(np.abs(cosines).max(axis=0), 1.0)), np.nan),
        at_places=at_least,
    )


def _square(ground: Real, crank: Real, turn: float) -> Real:
    """Of the diagonal from the crank pin to the rocker's pivot."""
    square: Real = (ground - crank) ** 2 + 4 * ground * crank * np.sin(0.5 * turn) ** 2
    return square


def _inside(turn: Real | float, start: float, end: float) -> Mask:
    """Whether an angle, or the same some turns on, lies on the way."""
    return np.asarray(np.mod(np.asarray(turn) - start, 2 * np.pi) < end - start)


def _joints(ground: Real, crank: Real, rocker: Real, turn: float, out: float) -> tuple[Real, tuple[Real, Real, Real]]:
    """The branch, and the sines at rocker pin, crank pivot and crank pin, of which the signs count."""
    ahead: Complex = crank * np.exp(1j * turn)
    arm: Complex = rocker * np.exp(1j * out)
    rod = ground + arm - ahead
    side = cross(rod, arm)
    return np.sign(side), (side, np.sin(turn) + 0 * ground, cross(ahead, rod))


def _swing(wanted: TwoPlaces, ground: Real, crank: Real, coupler: Real, rocker: Real, sign: Real) -> Real:
    """The rocker's way from the first place, on its branch, while the crank goes all its way, rad."""

    def out(turn: float) -> Real:
        # The diagonal from the rocker's pivot turns about the shorter of ground and crank, and the rocker leans on it.
        behind = np.angle(1 - crank / ground * np.exp(1j * turn))
        ahead = turn + np.angle(1 - ground / crank * np.exp(-1j * turn))
        square = _square(ground, crank, turn)
        lean = (square + rocker**2 - coupler**2) / (2 * rocker * np.sqrt(square))
        angle: Real = np.where(crank < ground, behind, ahead) - sign * np.arccos(np.clip(lean, -1, 1))
        return angle

    swing: Real = out(wanted.crank[1]) - out(wanted.crank[0])
    return swing

"""The wheel of a Geneva drive and its crank: sizes, motion, outlines."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from math import gcd

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, inside, quantity
from ..core.records import record
from ..core.units import mm
from ..plane.curve import AbstractCurve
from ..plane.joined import Path, PolarArray
from ..plane.primitives import Arc, Circle, Segment
from ..plane.vec import Complex, Real, spaced_directions

# Most slots and pins. With more the tips of the wheel are too thin to cut at any size that fits a machine.
MOST_SLOTS, MOST_PINS = 24, 5
# Largest difference from a wanted share of dwell that counts as rounding.
SAME_SHARE = 1e-6
# Least radius of the locking disc of an internal wheel over that of the crank: with less, wide tips sweep what is left
# of the disc opposite the pin.
LEAST_LOCK = 0.8


def dwell_share(slots: int, pins: int, internal: bool = False) -> float:
    """Share of the crank's turn in which the wheel is locked."""
    return 1 - pins * (slots + (2 if internal else -2)) / (2 * slots)


def most_pins(slots: int, internal: bool = False) -> int:
    """Most pins of a crank that still locks the wheel between them."""
    return max(k for k in range(1, MOST_PINS + 1) if dwell_share(slots, k, internal) > 1e-9)


@record(checked=True)
class GenevaWheel:
    """A Geneva drive; all lengths in mm.

    Parameters
    ----------
    distance : float
        Distance of the axes of crank and wheel.
    slots : int, optional
        Number of slots of the wheel, from 3.
    pins : int, optional
        Number of pins of the crank, equally spaced; 1 if omitted.
    dwell_share : float, optional
        Share of the crank's turn in which the wheel is locked, instead of `slots`.
    roller : float, optional
        Diameter of the rollers that run in the slots.
    clearance : float, optional
        How much wider the slots are than the rollers, and twice the gap between wheel and locking disc.
    tip_width : float, optional
        Width of the wheel's tips between slot and locking arc.
    internal : bool, optional
        Whether the wheel surrounds the crank. It then turns the same way, moves for more than half a turn, and has
        its largest acceleration, which is smaller, as a pin enters and leaves.

    Examples
    --------
    >>> wheel = gk.geneva.GenevaWheel(60, slots=4)
    >>> round(wheel.crank_radius, 4), wheel.dwell
    (42.4264, 0.75)
    >>> gk.geneva.GenevaWheel(60, slots=4, internal=True).dwell
    0.25
    """

    distance: float = quantity("distance of the axes", "mm", above=0, at_most=FARTHEST, example=60)
    slots: int | None = quantity(
        "number of slots of the wheel", whole=True, default=None, at_least=3, at_most=MOST_SLOTS, example=4
    )
    pins: int | None = quantity(
        "number of pins of the crank, equally spaced; 1 if omitted",
        whole=True, default=None, at_least=1, at_most=MOST_PINS, example=1,
    )  # fmt: skip
    dwell_share: float | None = quantity(
        "share of the crank's turn in which the wheel is locked, instead of slots", default=None, above=0, below=1
    )
    roller: float = quantity(
        "diameter of the rollers that run in the slots", "mm", default=6.0, above=0, at_most=FARTHEST
    )
    clearance: float = quantity(
        "how much wider the slots are than the rollers, and twice the gap between wheel and locking disc",
        "mm", default=0.2, at_least=0, at_most=FARTHEST, printed=1.0,
    )  # fmt: skip
    tip_width: float = quantity(
        "width of the wheel's tips between slot and locking arc", "mm", default=2.0, above=0, at_most=FARTHEST
    )
    internal: bool = entry("whether the wheel surrounds the crank, and turns the same way", default=False)

    def __post_init__(self) -> None:
        if (self.slots is None) == (self.dwell_share is None):
            number = "neither" if self.slots is None else "both"
            raise DesignError("slots", f"found {number} slots and dwell_share", "give one of them", "conflict")
        slots, pins = self.numbers
        if pins > (most := most_pins(slots, self.internal)):
            problem = f"found {pins} for {slots} slots, so that the wheel never rests"
            raise DesignError("pins", problem, f"give at most {most}", "conflict")
        if self.internal:
            half = (1 - LEAST_LOCK) * self.crank_radius - self.clearance / 2
        else:
            half = min(self._floor * self.ratio, self.crank_radius - self.distance + self._mouth)
        widest = 2 * half - self.clearance
        if self.roller >= widest:
            problem = f"found {mm(self.roller):g}, which leaves the wheel no room between its {slots} slots"
            remedy = "give a larger distance" + (f", or less than {mm(widest):down}" if widest > 0 else "")
            raise DesignError("roller", problem, remedy, "conflict", inside(widest, 1) if widest > 0 else None)
        least_lock = LEAST_LOCK * self.crank_radius if self.internal else self.distance - self.rim - self.clearance / 2
        most_width = self.crank_radius - self.half_width - self.clearance / 2 - least_lock
        if self.tip_width >= most_width:
            problem = f"found {mm(self.tip_width):g}, which leaves no locking arc"
            remedy = f"give less than {mm(most_width):down}, or a larger distance"
            raise DesignError("tip_width", problem, remedy, "conflict", inside(most_width, 1))
        if not self.internal and self.clearance / 2 >= self.distance - self.rim:
            problem = f"found {mm(self.clearance):g}, which leaves no locking disc at the crank's axis"
            raise DesignError("clearance", problem, "give a smaller one, or a larger distance", "conflict")

    @cached_property
    def numbers(self) -> tuple[int, int]:
        """Numbers of slots and pins, those of the wanted share of dwell if it is given."""
        if self.dwell_share is None:
            assert self.slots is not None
            return self.slots, self.pins or 1
        wanted = self.dwell_share
        counts = range(1, MOST_PINS + 1) if self.pins is None else (self.pins,)
        pairs = [(n, k) for k in counts for n in range(3, MOST_SLOTS + 1) if k <= most_pins(n, self.internal)]
        shares = {pair: dwell_share(*pair, self.internal) for pair in pairs}

        def order(pair: tuple[int, int]) -> tuple[float, int]:
            return shares[pair], -pair[1]

        below = max((p for p in pairs if shares[p] <= wanted + SAME_SHARE), key=order, default=None)
        above = min((p for p in pairs if shares[p] >= wanted - SAME_SHARE), key=order, default=None)
        if below and abs(shares[below] - wanted) <= SAME_SHARE:
            return below
        nearest = " or ".join(
            f"{shares[pair]:.7g} ({pair[0]} slots, {pair[1]} {'pins' if pair[1] > 1 else 'pin'})"
            for pair in (below, above)
            if pair
        )
        raise DesignError("dwell_share", f"no wheel rests for {wanted:g} of a turn", f"give {nearest}", "out-of-range")

    @property
    def dwell(self) -> float:
        """Share of the crank's turn in which the wheel is locked."""
        return dwell_share(*self.numbers, self.internal)

    @property
    def sense(self) -> int:
        """-1 if the wheel is internal, which changes the sign of the ratio in all formulas; otherwise 1."""
        return -1 if self.internal else 1

    @property
    def crank_radius(self) -> float:
        """Distance of the pins from the crank's axis, mm: they enter the slots along these, at speed 0 of the wheel."""
        return self.distance * self.ratio

    @property
    def ratio(self) -> float:
        """Crank radius over distance."""
        return float(np.sin(np.pi / self.numbers[0]))

    @property
    def half_motion(self) -> float:
        """Angle of the crank from the entry of a pin to the line of centres, rad."""
        return np.pi / 2 - self.sense * np.pi / self.numbers[0]

    @property
    def turns(self) -> int:
        """Turns of the crank after which the wheel is where it began."""
        slots, pins = self.numbers
        return slots // gcd(slots, pins)

    @property
    def half_width(self) -> float:
        """Half the width of a slot, mm."""
        return (self.roller + self.clearance) / 2

    @property
    def _mouth(self) -> float:
        """Distance of a pin from the wheel's axis as it enters, mm."""
        return self.distance * float(np.cos(np.pi / self.numbers[0]))

    @property
    def _floor(self) -> float:
        """Centre of the round floor of a slot, mm from the wheel's axis."""
        return self.distance - self.sense * (self.crank_radius + self.clearance)

    @property
    def rim(self) -> float:
        """Radius of the wheel at its tips, mm: its largest, or of an internal wheel its smallest."""
        return float(np.hypot(self._mouth, self.half_width))

    @property
    def outer_radius(self) -> float:
        """Largest radius of the wheel, mm; an internal one is as wide beyond its slots as a roller."""
        return self._floor + self.half_width + self.roller if self.internal else self.rim

    @property
    def hub(self) -> float:
        """Radius within the floors of the slots, mm."""
        return self._floor - self.half_width

    @property
    def lock_radius(self) -> float:
        """Radius of the locking disc, mm."""
        return self.crank_radius - self.half_width - self.tip_width - self.clearance / 2

    @property
    def relief_radius(self) -> float:
        """Radius of the locking disc where it lets the wheel pass, mm."""
        return self.distance - self.rim - self.clearance / 2

    @property
    def lock_play(self) -> float:
        """Rotation of the locked wheel to either side, rad, from the gap of its locking arc amidst a dwell."""
        if self.internal:
            return self.clearance / 2 / self._mouth
        radius = self.lock_radius + self.clearance / 2
        cosine = (self.distance**2 + radius**2 - self.rim**2) / (2 * self.distance * radius)
        return self.clearance / 2 / (self.distance * float(np.sqrt(1 - cosine**2)))

    def pin_angle(self, turn: ArrayLike) -> tuple[Real, Real]:
        """Angle from the line of centres of the pin nearest to it, rad, and steps made so far, at turns of the crank.

        The crank starts in the middle of a dwell.
        """
        step = 2 * np.pi / self.numbers[1]
        turn = np.asarray(turn, dtype=float)
        made = np.floor(turn / step * (1 + 4e-16))
        return turn - (made + 0.5) * step, made

    def rotation(self, turn: ArrayLike) -> Real:
        """Rotation of the wheel, rad, at rotations of the crank from its start in the middle of a dwell, rad."""
        angle, made = self.pin_angle(turn)
        p, half = np.clip(angle, -self.half_motion, self.half_motion), np.pi / self.numbers[0]
        m = self.sense * self.ratio
        return -self.sense * half * (2 * made + 1) - np.arctan2(m * np.sin(p), 1 - m * np.cos(p))

    def derivatives(self, turn: ArrayLike) -> tuple[Real, Real]:
        """First and second derivative of the wheel's rotation by that of the crank; the second one jumps at entries."""
        p, _ = self.pin_angle(turn)
        m = self.sense * self.ratio
        moves = np.abs(p) < self.half_motion * (1 - 1e-12)
        q = 1 - 2 * m * np.cos(p) + m * m
        first, second = m * (np.cos(p) - m) / q, -m * (1 - m * m) * np.sin(p) / q**2
        return np.where(moves, -first, 0.0), np.where(moves, -second, 0.0)

    @property
    def peaks(self) -> tuple[float, float, float, float]:
        """Largest velocity and acceleration of the wheel by the crank's angle; those at entry and the jerk amidst."""
        m, entry_jump = self.ratio, float(np.tan(np.pi / self.numbers[0]))
        if self.internal:
            return m / (1 + m), entry_jump, entry_jump, m * (1 - m) / (1 + m) ** 3
        k = (1 + m * m) / (4 * m)
        cosine = float(np.sqrt(k * k + 2)) - k
        q = 1 - 2 * m * cosine + m * m
        most = m * (1 - m * m) * float(np.sqrt(1 - cosine**2)) / q**2
        return m / (1 - m), most, entry_jump, m * (1 + m) / (1 - m) ** 3

    @property
    def outline(self) -> AbstractCurve:
        """The wheel's outline about its axis; +x is the middle of a locking arc. An internal wheel has an `opening`."""
        return Circle(0j, self.outer_radius) if self.internal else self.opening

    @property
    def opening(self) -> AbstractCurve:
        """Slots and locking arcs, about the wheel's axis; +x is the middle of a locking arc."""
        slots, _ = self.numbers
        side, half, floor = np.exp(-1j * np.pi / slots), 1j * self.half_width, self._floor
        quarter, end = self.sense * np.pi / 2, floor - self.sense * self.half_width
        edge = _arc_angle(self)
        corner, lock = (self._mouth + half) * side, self.rim * np.exp(-1j * edge)
        tip = -edge - float(np.angle(corner))
        seen = lock - self.distance
        lower = [Arc(floor * side, end * side, -quarter), Segment((floor + half) * side, corner), Arc(0j, corner, tip)]
        upper = [
            Arc(0j, complex(lock.conjugate()), tip),
            Segment(complex(corner.conjugate()), complex(((floor + half) * side).conjugate())),
            Arc(complex((floor * side).conjugate()), complex(((floor + half) * side).conjugate()), -quarter),
        ]
        towards = abs(float(np.angle(seen)))
        arc = Arc(self.distance + 0j, complex(lock), 2 * towards if self.internal else -2 * (np.pi - towards))
        return PolarArray(Path((*lower, arc, *upper)), slots)

    @property
    def lock_outline(self) -> AbstractCurve:
        """Outline of the locking disc about the crank's axis; a pin is on +x."""
        _, pins = self.numbers
        free, step = self.half_motion, 2 * np.pi / pins
        edge = np.exp(1j * free)
        if self.internal:
            far, near = self.lock_radius, lock_inside(self) / self.ratio
            ends = (far * edge, far / edge, near / edge, near * edge)
            sides = (Segment(complex(a), complex(b)) for a, b in pairwise((*ends[1:], ends[0])))
            return Path((Arc(0j, complex(far * edge), 2 * (np.pi - free)), *sides))
        far, near = self.lock_radius, self.relief_radius
        next_edge = np.exp(1j * (step - free))
        pieces = (
            Arc(0j, complex(near * np.exp(-1j * free)), 2 * free),
            Segment(complex(near * edge), complex(far * edge)),
            Arc(0j, complex(far * edge), step - 2 * free),
            Segment(complex(far * next_edge), complex(near * next_edge)),
        )
        return PolarArray(Path(pieces), pins)

    @property
    def pin_places(self) -> Complex:
        """Pins about the crank's axis, mm, the first one on +x."""
        return self.crank_radius * spaced_directions(self.numbers[1])


def _arc_angle(wheel: GenevaWheel) -> float:
    """Angle at the wheel's axis from the middle of a locking arc to its end, rad."""
    radius = wheel.lock_radius + wheel.clearance / 2
    return float(np.arccos((wheel.distance**2 + wheel.rim**2 - radius**2) / (2 * wheel.distance * wheel.rim)))


def lock_inside(wheel: GenevaWheel) -> float:
    """Distance of the straight side of an internal wheel's lock from the crank's axis, mm, amidst its room.

    Inside it the tips of the wheel pass: the middle line of a tip's slot passes the pin, from which the tip is farthest
    on the line of centres.
    """
    tip = wheel.rim * np.exp(1j * (np.pi / wheel.numbers[0] - _arc_angle(wheel)))
    swept = float(abs(wheel.distance + wheel.crank_radius - tip)) - wheel.crank_radius
    return (swept + wheel.lock_radius * wheel.ratio) / 2

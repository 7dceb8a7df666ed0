"""Whether a walker stands: the feet of a linkage and of its copies, and the tilt of their frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ...core.errors import DesignError, shown
from ...core.fields import entry, to_digits
from ...core.records import record
from ...core.units import mm
from ...model.check import Check
from ...plane.vec import Complex, Real, without_rounding
from ..checks import in_driver_unit
from ..drive_limits import largest_between
from ..linkage import Linkage
from ..measures import ground_slopes, support_margin
from ..motion import Motion
from .aspects import AbstractLinkageAspect
from .copies import Copied

# Least number of feet that carry a frame.
FEWEST_FEET = 3
# Largest tilt of the frame over a turn, deg, along the path or across it. A walker that rocks more stumbles; chosen
# here.
MOST_ROCKING_DEG = 10.0
# Three pairs of legs, the middle one half a turn ahead.
SIX_LEGS = (
    "copies = [{ mirrored = true }, { phase_deg = 180 }, { phase_deg = 180, mirrored = true }, {}, { mirrored = true }]"
)
FOUR_LEGS = (
    "Four legs stand on two feet at times, whatever their phases, and the frame then tips from one pair of feet to "
    "another: give six legs, as the checks of the tilt advise, or fix feet of your own that are as wide as the body."
)
# Largest turn of a walker in a machine, rad, with which it stands on its feet.
UPRIGHT = 1e-6
UNKNOWN_STANCE = "How it stands is unknown: no rod joins two of the copies, so their distance is not given."


def foot_entry() -> Any:
    """Field for the foot of a walker."""
    return entry(
        "point that stands on the ground, which is at -y, in a linkage and at least two copies; checks then report "
        "whether the walker falls over, and how far it tilts",
        default=None,
    )


def check_foot(foot: str, linkage: Linkage, count: int) -> None:
    """Refuse a foot that is no point of a moving body, or too few feet. count: number of linkages."""
    fixed = linkage.bodies[linkage.ground]
    points = dict.fromkeys(point for names in linkage.bodies.values() for point in names if point not in fixed)
    if foot not in points:
        raise DesignError("foot", f"found {shown(foot)}", f"give a point of a moving body: {', '.join(points)}")
    if count < FEWEST_FEET:
        problem = f"found {foot}, but {count} of them cannot stand"
        raise DesignError("foot", problem, f"give at least {FEWEST_FEET - 1} [[copies]], or omit foot", "conflict")


@record(eq=False)
class Stance:
    """The feet of a linkage and its copies over a turn, seen from above: x along the path, y along the shaft, mm.

    feet: shape (feet, frames); height: of the feet in the frame, of the same shape. centre: of the weight, in the
    middle of all fixed pivots. motion: of the first linkage. of: how it stands in another motion.
    """

    feet: Complex
    height: Real
    centre: complex
    motion: Motion
    of: Callable[[Motion], Stance]

    @cached_property
    def margin(self) -> Real:
        """Distance of the centre inside the support polygon, mm; negative where it falls over."""
        return support_margin(self.feet, self.centre)

    @cached_property
    def tilt_deg(self) -> Mapping[str, Real]:
        """Tilt of the frame along the path and across it, deg; nan where it falls over."""
        slope = ground_slopes(self.feet, self.height, self.centre)
        return {"along": np.degrees(np.arctan(slope.real)), "across": np.degrees(np.arctan(slope.imag))}

    @cached_property
    def least_margin(self) -> tuple[float, float]:
        """Least margin, mm, also between frames, and the drive there."""
        largest, drive = largest_between(self.motion, lambda motion: -self.of(motion).margin)
        return without_rounding(-float(largest), float(np.abs(self.feet).max())), float(drive)

    @cached_property
    def tilt_range_deg(self) -> Mapping[str, tuple[float, float]]:
        """Least and largest tilt, deg, also between frames; nan if it falls over."""
        if not all(np.isfinite(tilt).all() for tilt in self.tilt_deg.values()):
            return dict.fromkeys(self.tilt_deg, (np.nan, np.nan))

        def both_ways(motion: Motion) -> Real:
            return np.concatenate([(-tilt, tilt) for tilt in self.of(motion).tilt_deg.values()])

        ends = largest_between(self.motion, both_ways)[0].reshape(-1, 2).tolist()
        return {direction: (0.0 - low, high) for direction, (low, high) in zip(self.tilt_deg, ends)}

    @property
    def checks(self) -> Iterator[Check]:
        """That the centre stays above the support polygon, and that the frame rocks little."""
        least, drive = self.least_margin
        advice = "give further copies at other phases, or mirrored ones, so that a foot is on each side of the frame"
        at = in_driver_unit(self.motion, drive)
        name = "least distance of the frame's centre inside its feet"
        yield Check("support_margin", name, least, "at least", 0, "mm", advice, at=at)
        advice = f"give six legs, by {SIX_LEGS} above the first table in place of others"
        for direction, (low, high) in self.tilt_range_deg.items():
            name = f"tilt {direction} the path, largest minus least"
            yield Check(f"tilt_{direction}", name, high - low, "at most", MOST_ROCKING_DEG, "deg", advice)

    @property
    def remarks(self) -> Iterator[str]:
        """That four legs tip, and the place of the weight for which the checks hold."""
        if len(self.feet) == 4:
            yield FOUR_LEGS
        if (margin := self.least_margin[0]) > 0:
            yield (
                f"It stands if its weight is in the middle, {mm(self.centre.imag):.4g} from the outer face of the "
                "first "
                f"ground: fix the battery so that it balances there, within {mm(margin):.2g}."
            )

    @property
    def summary(self) -> Mapping[str, object]:
        """Least margin and the range of the tilts."""
        tilts = {
            f"tilt_{direction}_deg": [to_digits(low), to_digits(high)]
            for direction, (low, high) in self.tilt_range_deg.items()
            if np.isfinite(low)
        }
        return {"least_margin_mm": to_digits(self.least_margin[0]), **tilts}


@record(eq=False)
class StandingAspect(AbstractLinkageAspect[str]):
    """How a walker stands on the feet of the linkage and its copies, down being -y."""

    key = "foot"

    def check(self) -> None:
        check_foot(self.given, self.mechanism.linkage.linkage, 1 + len(self.mechanism.copies))

    @cached_property
    def stance(self) -> Stance | None:
        """How it stands over a turn; None if the distances of the copies are unknown."""
        if any(not rod.pin for rod in self.mechanism.shared):
            return None
        return self._stance_in(self.mechanism.motion)

    def _stance_in(self, motion: Motion) -> Stance:
        made = self.mechanism
        linkage, sheet = motion.linkage, made.stock.thickness
        body = next(name for name, points in linkage.bodies.items() if self.given in points)
        pivots = [pin for pin, bodies in linkage.pins.items() if linkage.ground in bodies]
        first = Copied(motion, np.arange(len(motion.drive)), None)
        feet, height, fixed, start = [], [], [], 0.0
        rooms = (*(rod.room for rod in made.shared), 0.0)
        for copy, stack, room in zip((first, *made.copies_of(motion)), made.stacks, rooms):
            total = (1 + max(stack.layers.values())) * sheet
            layer = next(stack.layers[name] for name, plate in stack.plates.items() if plate.body == body)
            inside = (layer + 0.5) * sheet
            place = copy.place(copy.motion.point(self.given).position)
            feet.append(place.real + 1j * (start + (inside if copy.mirror is None else total - inside)))
            height.append(place.imag)
            fixed += [copy.place(copy.motion.point(pin).position)[0].real for pin in pivots]
            start += total + room
        return Stance(np.array(feet), np.array(height), complex(np.mean(fixed), start / 2), motion, self._stance_in)

    @property
    def checks(self) -> Iterator[Check]:
        advice = "a machine turns it, and its feet are at -y of its own recipe: give angle_deg = 0"
        for check in self.stance.checks if self.stance else ():
            yield replace(check, value=np.nan, at=None, advice=advice) if self._is_turned else check

    @property
    def _is_turned(self) -> bool:
        return abs(self.mechanism.setting.direction - 1) > UPRIGHT

    @property
    def remarks(self) -> Iterator[str]:
        if not self._is_turned:
            yield from self.stance.remarks if self.stance else (UNKNOWN_STANCE,)

    @property
    def entries(self) -> Mapping[str, object]:
        return {"stance": self.stance.summary} if self.stance else {}

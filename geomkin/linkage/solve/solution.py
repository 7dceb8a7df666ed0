"""The branch of every dyad, and where all bodies are over the frames, no further than the order asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...brief import one_line
from ...plane.vec import Array, Complex, Mask, Real, Whole, direction_deg
from ..linkage import Linkage
from .branch import Chosen, FollowedBranch
from .drive_range import DriveRange, change_points
from .driver_dyads import Driven
from .dyads import Dyad
from .loops import Loops
from .placement import Coefficients, Numbers, Placement, Poses, Turned

# Gap, as a share of the reach, below which rounding alone keeps it from zero: true meetings come out below 2e-16 behind
# chains of five dyads. Larger takes a near miss for a meeting, smaller misses meetings behind a dyad at bad angles.
ROUNDING = 1e-14


def reach_of(linkage: Linkage) -> float:
    """A length, mm, that no two points of the linkage can be apart while it is together."""
    bodies = sum(
        max((float(np.abs(z).max()) for z in points.values()), default=0.0) for points in linkage.bodies.values()
    )
    return 2 * (bodies + sum(_far(s.point) + _far(s.through) for s in linkage.sliders))


def _far(place: complex | Array) -> float:
    """Distance from the origin, mm, of many places the largest."""
    return float(np.abs(place).max()) if isinstance(place, np.ndarray) else abs(place)


def with_branches(
    linkage: Linkage, placements: Sequence[Placement], drive: Real, linkages: tuple[int, ...], asked: Chosen
) -> DriveRange:
    """The range of a motion's drives with the branch of every dyad: by sign, near given points, or followed."""
    reach = reach_of(linkage)
    unit = 1.0 if isinstance(placements[0], Turned) else reach
    found = DriveRange(linkage, placements, drive, linkages, unit, {})
    with np.errstate(all="ignore"):
        for k, dyad in enumerate(placements):
            if isinstance(dyad, Dyad):
                found = replace(found, branches={**found.branches, dyad.joint: _branch(found, k, dyad, asked, reach)})
    return found


def _branch(before: DriveRange, k: int, dyad: Dyad, asked: Chosen, reach: float) -> Whole | int | FollowedBranch:
    """The branch of the dyad that is placed k-th, where those of the ones before it are known."""
    told = None if dyad.joint in asked.signs else _nearest(before, k, asked.near)
    frame, sign = told or (0, asked.signs.get(dyad.joint, asked.default))
    if not asked.follow:
        return sign
    if not isinstance(dyad, Driven):
        return change_points(before, k, sign, before.drive[frame:], ROUNDING * reach) if before.drive.size else sign
    return dyad.sign_from(before.drive, int(sign)) if told is None else sign


def _nearest(before: DriveRange, k: int, near: Mapping[str, complex]) -> tuple[int, Whole] | None:
    """The first frame at which a dyad closes, and the side on which what it places there is nearest to given points."""
    later = (j for j, one in enumerate(before.placements) if j > k and isinstance(one, Dyad | Loops))
    end = next(later, len(before.placements))
    ahead = np.exp(1j * np.radians(before.linkage.ground_angle_deg))
    for frames in (before.drive[:1], before.drive):
        here = before.poses(frames, k)
        offs = []
        for side in (1, -1):
            p = Poses(dict(here.origin), dict(here.turn), here.drive, dict(here.kept))
            for placement in before.placements[k:end]:
                placement.place(p, side)
            own = [
                p.origin[body] + p.turn[body] * before.linkage.bodies[body][name] - (z - before.linkage.origin) / ahead
                for body in set(p.origin) - set(here.origin)
                for name, z in near.items()
                if name in before.linkage.bodies[body]
            ]
            if not own:
                return None
            offs.append(np.sum(np.abs(own) ** 2, axis=0))
        known = np.isfinite(offs[0]) | np.isfinite(offs[1])
        share = known.reshape(len(frames), -1).mean(axis=1)
        if share.size and share.any():
            frame = int(np.argmax(share))
            return frame, np.where(offs[1][frame] < offs[0][frame], -1, 1)
    return None


@dataclass(frozen=True, eq=False)
class LinkageSolution:
    """Where all bodies are, and the derivatives of that by the drive, each worked out when first asked for.

    placements: how the bodies are placed, in order; drive: rad or mm, (frames,); asked: the branch. All that is told
    is (frames,) or, of arrays of linkages, (frames, linkages), and nan where the linkage is open.
    """

    linkage: Linkage
    placements: tuple[Placement, ...]
    drive: Real
    asked: Chosen

    __repr__ = one_line

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """(frames,) or (frames, linkages)."""
        places = (z for points in self.linkage.bodies.values() for z in points.values())
        return (len(self.drive), *np.broadcast_shapes(*(np.shape(z) for z in places)))

    def origin(self, body: str, order: int) -> Complex:
        """The place of a body's origin, mm, or its derivative of order 1 or 2 by the drive."""
        if (body, order) not in self._origins:
            origin = (self.poses if order == 0 else self._coefficients(order)).origin[body]
            if self._ahead != 1:
                origin = origin * self._ahead
            if order == 0 and np.any(self.linkage.origin != 0):
                origin = origin + self.linkage.origin
            self._origins[body, order] = self._over_frames(body, origin)
        return self._origins[body, order]

    def direction(self, body: str) -> Complex:
        """A body's x axis, unit complex."""
        if body not in self._directions:
            turn = self.poses.turn[body]
            self._directions[body] = self._over_frames(body, turn if self._ahead == 1 else turn * self._ahead)
        return self._directions[body]

    def turning(self, body: str, order: int) -> Real:
        """The derivative of order 1 or 2 of a body's angle, rad, by the drive."""
        if (body, order) not in self._turnings:
            self._turnings[body, order] = self._over_frames(body, self._coefficients(order).turn[body])
        return self._turnings[body, order]

    def _over_frames(self, body: str, values: Numbers) -> Numbers:
        """Values at every frame, of what moves nan where the linkage is open."""
        if body != self.linkage.ground and not self._all_closed:
            values = np.where(self.closed, values, np.nan)
        return values if values.shape == self.shape else np.broadcast_to(values, self.shape)

    def _coefficients(self, order: int) -> Coefficients:
        return self._first if order == 1 else self._second

    @cached_property
    def closed(self) -> Mask:
        """Whether every body can be where its joints want it."""
        closed = np.ones(self.shape, dtype=bool)
        for placement in self.placements:
            reached = placement.reached(self.poses)
            if reached is not None:
                closed &= np.isfinite(reached)
        return closed

    @cached_property
    def poses(self) -> Poses:
        """Where all bodies are, in the fixed body's frame; nan from the first one on that cannot be placed."""
        return self._range.poses(self.drive)

    @cached_property
    def _first(self) -> Coefficients:
        return self._range.first(self.poses)

    @cached_property
    def _second(self) -> Coefficients:
        return self._range.second(self.poses, self._first)

    @cached_property
    def _range(self) -> DriveRange:
        return with_branches(self.linkage, self.placements, self.drive, self.shape[1:], self.asked)

    @cached_property
    def signs(self) -> Mapping[str, Whole]:
        """The sign of each dyad, by its inner joint, also where the linkage is open; 0 where both branches meet."""
        found: dict[str, Whole] = {}
        for dyad in self.placements:
            if isinstance(dyad, Dyad):
                sign = self._range.sign(dyad, self.poses)
                if isinstance(dyad, Driven):
                    with np.errstate(invalid="ignore"):
                        r = dyad.roots(Poses(drive=self.poses.drive), sign).r
                    sign = np.where(np.isfinite(r), np.sign(r), sign)
                found[dyad.joint] = np.broadcast_to(sign, self.shape)
        return found

    @cached_property
    def branches(self) -> Mapping[str, Whole]:
        """The branch of each dyad, by its inner joint: its sign, and 0 where the linkage is open."""
        return {joint: np.where(self.closed, sign, 0).astype(int) for joint, sign in self.signs.items()}

    @cached_property
    def transmission_angle(self) -> Real:
        """Least over the joints that it is told of, rad; nan where there is none."""
        least = np.full(self.shape, np.nan)
        for placement in self.placements:
            angle = placement.transmission_angle(self.poses)
            if angle is not None:
                least = np.fmin(least, angle)
        return np.where(self.closed, least, np.nan)

    # What was asked for so far, as seen from outside the fixed body's frame.
    @cached_property
    def _origins(self) -> dict[tuple[str, int], Complex]:
        return {}

    @cached_property
    def _directions(self) -> dict[str, Complex]:
        return {}

    @cached_property
    def _turnings(self) -> dict[tuple[str, int], Real]:
        return {}

    @cached_property
    def _ahead(self) -> complex:
        return complex(direction_deg(self.linkage.ground_angle_deg))

    @cached_property
    def _all_closed(self) -> bool:
        return bool(self.closed.all())

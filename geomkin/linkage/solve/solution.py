"""The branch of every dyad, and where all bodies are over the frames, no further than the order asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from math import prod

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real, Whole, known
from ..linkage import Linkage
from .branch import BranchSpec, FollowedBranch
from .drive_range import DriveRange, change_points
from .dyads import Dyad
from .formulas import LazyEvaluation, Timing, linkage_formulas, tell_all
from .input_dyads import InputDyad
from .loops import Loops
from .placement import Coefficients, Numbers, Placement, Poses, RevoluteInput
from .program import Group

# Gap, as a share of the reach, below which rounding alone keeps it from zero: true meetings come out below 2e-16 behind
# chains of five dyads. Larger takes a near miss for a meeting, smaller misses meetings behind a dyad at bad angles.
ROUNDING = 1e-14
# Frames times linkages from which formulas are written down, over all motions of a linkage so far, each of which counts
# as MOVING more for what its Python costs. Writing takes about as long as moving so many: fewer, and what moves once or
# twice waits for it; more, and what moves again and again goes on by the placements for longer.
WORTH, MOVING = 10_000, 1000


def reach_of(linkage: Linkage) -> float:
    """A length, mm, that no two points of the linkage can be apart while it is together."""
    bodies = sum(
        max((float(np.abs(z).max()) for z in points.values()), default=0.0) for points in linkage.bodies.values()
    )
    return 2 * (bodies + sum(_far(s.point) + _far(s.through) for s in linkage.sliders))


def spread(values: Array, shape: tuple[int, ...]) -> Array:
    """Values at every frame; one that is alike for all in a tenth of the time that `broadcast_to` takes."""
    if values.size != 1:
        return np.broadcast_to(values, shape)
    return np.ndarray(shape, values.dtype, values.tobytes(), 0, (0,) * len(shape))


def _far(place: complex | Array) -> float:
    """Distance from the origin, mm, of many places the largest."""
    return float(np.abs(place).max()) if isinstance(place, np.ndarray) else abs(place)


def with_branches(
    linkage: Linkage, placements: Sequence[Placement], drive: Real, linkages: tuple[int, ...], asked: BranchSpec
) -> DriveRange:
    """The range of a motion's drives with the branch of every dyad: by sign, near given points, or followed."""
    dyads = {k: one for k, one in enumerate(placements) if isinstance(one, Dyad)}
    turns, found = (
        isinstance(placements[0], RevoluteInput),
        {one.joint: asked.sign(one.joint) for one in dyads.values()},
    )
    if turns and not asked.follow and not asked.branch_points:
        return DriveRange(linkage, placements, drive, linkages, 1.0, found)
    reach = reach_of(linkage)
    whole = DriveRange(linkage, placements, drive, linkages, 1.0 if turns else reach, {})
    with np.errstate(all="ignore"):
        for k, dyad in dyads.items():
            whole = replace(whole, branches={**whole.branches, dyad.joint: _branch(whole, k, dyad, asked, reach)})
    return whole


def _branch(before: DriveRange, k: int, dyad: Dyad, asked: BranchSpec, reach: float) -> Whole | int | FollowedBranch:
    """The branch of the dyad that is placed k-th, where those of the ones before it are known."""
    told = _nearest(before, k, asked.branch_points) if asked.branch_points and dyad.joint not in asked.branch else None
    frame, sign = told or (0, asked.sign(dyad.joint))
    if not asked.follow:
        return sign
    if not isinstance(dyad, InputDyad):
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


def _kept_by(branch: tuple[str, Whole | int | FollowedBranch]) -> tuple[str, bytes]:
    """What formulas on a joint's branch are kept by; of one that is followed there are none."""
    joint, sign = branch
    return joint, b"" if isinstance(sign, FollowedBranch) else np.asarray(sign).tobytes()


@record(eq=False)
class LinkageSolution:
    """Where all bodies are, and the derivatives of that by the drive, each worked out when first asked for.

    placements: how the bodies are placed, in order; drive: rad or mm, (frames,); asked: the branch. All that is told
    is (frames,) or, of arrays of linkages, (frames, linkages), and nan where the linkage is open.
    """

    linkage: Linkage
    placements: tuple[Placement, ...]
    drive: Real
    asked: BranchSpec
    timing: Timing
    # What was asked for so far, where it had to be made from what formulas tell.
    _kept: dict[tuple[Group, str], Array] = field(init=False, repr=False, default_factory=dict)

    @property
    def shape(self) -> tuple[int, ...]:
        """(frames,) or (frames, linkages)."""
        return (len(self.drive), *self.linkage.shape)

    def origin(self, body: str, order: int) -> Complex:
        """The place of a body's origin, mm, or its derivative of order 1 or 2 by the drive."""
        origin = (self.poses if order == 0 else self._first if order == 1 else self._second).origin[body]
        if self.linkage.ground_direction != 1:
            origin = origin * self.linkage.ground_direction
        if order == 0 and self.linkage.shifted:
            origin = origin + self.linkage.origin
        return self.over_frames(body, origin)

    def told(self, what: Group, body: str) -> Array:
        """What is told of a body: its "direction", unit complex, the "first" or "second" derivative of its angle by the
        drive, rad, "omega" and "alpha", rad/s and rad/s2; or of a point of it what formulas have as (what, body, name).
        """
        worked = self.worked
        if worked is None:
            return self._placed(str(what), body)
        found = worked.value(what, body)
        if found.shape == self._whole:
            return found
        key = what, body
        if key not in self._kept:
            self._kept[key] = self.over_frames(body, found)
        return self._kept[key]

    def _placed(self, what: str, body: str) -> Array:
        """The same of a body by its placements."""
        if what == "direction":
            turn = self.poses.turn[body]
            return self.over_frames(
                body, turn if self.linkage.ground_direction == 1 else turn * self.linkage.ground_direction
            )
        if what in ("first", "second"):
            return self.over_frames(body, (self._first if what == "first" else self._second).turn[body])
        if what == "omega":
            return self.timing.rate(self._placed("first", body))
        second = self._placed("second", body)  # first of all, so that the lower orders come with it
        return self.timing.gain(self._placed("first", body), second)

    def over_frames(self, body: str, values: Numbers) -> Numbers:
        """Values at every frame, of what moves nan where the linkage is open."""
        if self._whole is None and body != self.linkage.ground:
            values = known(self.assembled, values)
        return values if values.shape == self.assembled.shape else spread(values, self.assembled.shape)

    @cached_property
    def assembled(self) -> Mask:
        """Whether every body can be where its joints want it."""
        if self.worked is not None:
            closed = self.worked.value("direction", "")
            return closed if closed.shape == self.shape else spread(closed, self.shape)
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
    def worked(self) -> LazyEvaluation | None:
        """By formulas on these branches; None where they are not worth writing down, or there is more than formulas."""
        asked, written, timing = self.asked, self.linkage.formulas, self.timing
        # Signs that were asked for tell which formulas; where places or the motion tell, their signs do.
        plain = not (asked.follow or asked.branch_points)
        signs = asked.branch.items() if plain else map(_kept_by, self._range.branches.items())
        key = self.placements, timing.steady, timing.speed.ndim, asked.default, *signs
        formulas = written.get(key, 0)
        if isinstance(formulas, int):
            if asked.branch_points and not tell_all(self.placements, self._range.branches):
                # Its placements are its own: what is counted for them is never asked for again.
                return None
            written[key] = moved = formulas + len(self.drive) * prod(self.linkage.shape) + MOVING
            if moved < WORTH or not tell_all(self.placements, self._range.branches):
                return None
            written[key] = formulas = linkage_formulas(self.linkage, self.placements, self._range.branches, timing)
        drive = self.drive.reshape(-1, *(1,) * len(self.linkage.shape)) if self.linkage.is_batch else self.drive
        return LazyEvaluation(formulas, len(drive), self.linkage.shape, {"drive": drive, **timing.given})

    def worked_at(self, body: str, local: complex | Complex) -> LazyEvaluation | None:
        """The same for a point at this place of a body, mm, that goes on from the directions."""
        if self.worked is None:
            return None
        self.worked.value("direction", "")
        return self.worked.at(body, "local", np.asarray(local, dtype=complex))

    @cached_property
    def signs(self) -> Mapping[str, Whole]:
        """The sign of each dyad, by its inner joint, also where the linkage is open; 0 where both branches meet."""
        found: dict[str, Whole] = {}
        for dyad in self.placements:
            if isinstance(dyad, Dyad):
                sign = self._range.sign(dyad, self.poses)
                if isinstance(dyad, InputDyad):
                    with np.errstate(invalid="ignore"):
                        r = dyad.roots(Poses(drive=self.poses.drive), sign).r
                    sign = np.where(np.isfinite(r), np.sign(r), sign)
                found[dyad.joint] = np.broadcast_to(sign, self.shape)
        return found

    @cached_property
    def branches(self) -> Mapping[str, Whole]:
        """The branch of each dyad, by its inner joint: its sign, and 0 where the linkage is open."""
        return {joint: np.where(self.assembled, sign, 0).astype(int) for joint, sign in self.signs.items()}

    @property
    def transmission_angle(self) -> Real:
        """Least over the joints that it is told of, rad; nan where there is none."""
        return self._least_angle if self.worked is None else self.told("angle", "")

    @cached_property
    def _least_angle(self) -> Real:
        """The same by the placements."""
        least = np.full(self.shape, np.nan)
        for placement in self.placements:
            angle = placement.transmission_angle(self.poses)
            if angle is not None:
                least = np.fmin(least, angle)
        return np.where(self.assembled, least, np.nan)

    @cached_property
    def _whole(self) -> tuple[int, ...] | None:
        """The shape of what needs no nan and is told as it is; None where the linkage is open at some frame."""
        closed = self.assembled
        return closed.shape if np.count_nonzero(closed) == closed.size else None

"""The same linkage more than once on one shaft, as the legs of a walker."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import DesignError
from ..linkage.linkage import AbstractLinkage
from ..linkage.motion import Motion
from ..linkage.solve.branch import Branch
from ..linkage.solve.move import move
from ..plane.vec import Real
from ..recipe.settings import Stroke, Turn
from ..scenes.copies import Copied
from ..sizes import check_sizes, entry, quantity

# Copies at most. More than these no page shows.
MOST = 23
# Of a turn, how near a way is to one to count as one.
WHOLE = 1e-9


@dataclass(frozen=True)
class Copy:
    """A further one of the same linkage, whose crank is on the same shaft."""

    phase_deg: float = quantity(
        "its crank's angle ahead of the first one's", "deg", default=0.0, at_least=-360, at_most=360, example=180.0
    )
    mirrored: bool = entry("it is turned over, left for right, about the shaft", default=False)

    def __post_init__(self) -> None:
        check_sizes(self)

    def __str__(self) -> str:
        return f"crank {self.phase_deg:g} deg ahead{', turned over' if self.mirrored else ''}"


def copies_entry() -> Any:
    """Further ones of the linkage."""
    return entry("further ones of the same linkage on the same shaft", default=())


def check_copies(copies: tuple[Copy, ...], linkage: AbstractLinkage, way: Turn | Stroke) -> None:
    """Refuse copies of what does not turn on a shaft, by whole turns."""
    if not copies:
        return
    if len(copies) > MOST:
        raise DesignError("copies", f"found {len(copies)}", f"give at most {MOST}")
    if linkage.linkage.driver_pivot is None:
        raise DesignError("copies", "the driver turns on no fixed shaft, which they could share", "leave them out")
    turn = way.turn_deg if isinstance(way, Turn) else 0.0
    if abs(turn - 360) > 360 * WHOLE:
        raise DesignError("copies", "the driver makes no whole turn", "let it go 360 deg, or leave copies out")


def copied(
    copies: tuple[Copy, ...], first: Motion, linkage: AbstractLinkage, signs: Branch, way: Turn
) -> Iterator[Copied]:
    """Where each of the copies is at the frames of the first one.

    Each is followed from where the first one starts, through as much of the turn before as it is ahead, so that it
    moves on the same branch. Derived here.
    """
    frames, k, driver = way.frames, int(np.argmax(first.closed)), linkage.linkage.driver
    pivot = linkage.linkage.driver_pivot
    assert pivot is not None
    shaft = complex(first.point(pivot).position[k])
    # Towards the crank's first pin besides the shaft, or along its x axis where it has none.
    points = linkage.linkage.bodies[driver]
    arm = next((z - points[pivot] for z in points.values() if z != points[pivot]), 1.0)
    # Its angle where the drive is 0.
    zero = float(np.angle(first.bodies[driver].direction[k] * arm * np.exp(-1j * frames[k])))
    for copy in copies:
        phase = np.radians(copy.phase_deg)
        # Turned over, an arm at an angle a is seen at half a turn less a.
        wanted = np.pi - 2 * zero - phase - frames[::-1] if copy.mirrored else frames + phase
        motion = move(linkage, _led(wanted, frames), signs, way.speed, way.acceleration)
        rows = np.arange(len(motion.drive) - len(frames), len(motion.drive))
        yield Copied(motion, rows[::-1] if copy.mirrored else rows, shaft.real if copy.mirrored else None)


def _led(wanted: Real, frames: Real) -> Real:
    """A drive that goes on from the first frame, its way round, and ends with what is wanted or whole turns later."""
    step = float(frames[1] - frames[0])
    turn = float(np.copysign(2 * np.pi, step))
    later = wanted + turn * np.ceil((frames[0] - wanted[0]) / turn - WHOLE)
    before = np.arange(frames[0], later[0] - 1e-6 * step, step)
    return np.concatenate([before, later])

"""Which dyads the driver alone moves: their loop is C + K e^{iq} for the drive q, or has a bar of length q."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .actuators import ActuatedRRP, ActuatedRRR, Stroked
from .driver_dyads import Driven, DrivenRRP, DrivenRRR
from .dyads import RRP, RRR
from .steps import Anchor, Carried, Oriented, Step, Turned


def driven(dyad: RRR | RRP, ground: str, steps: Sequence[Step], follow: bool) -> Driven | None:
    """The dyad as one that the driver alone moves, where it is."""
    seen = _Seen(ground, steps)
    if isinstance(dyad, RRR):
        ends = [seen.anchor(base) for base in dyad.bases]
    else:
        ends = [seen.anchor(dyad.base), seen.anchor(dyad.start)]
        if dyad.rail.body != ground:
            return None
    if ends[0] is None or ends[1] is None:
        return None
    still, turning = ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]
    if np.any(turning == 0):
        return None
    if isinstance(dyad, RRP):
        return DrivenRRP(dyad.joint, follow, still, turning, dyad)
    return None if np.any(still == 0) else DrivenRRR(dyad.joint, follow, still, turning, dyad)


def actuated(
    dyad: RRR | RRP, which: int, arm: Stroked, ground: str, steps: Sequence[Step], follow: bool
) -> Driven | None:
    """The dyad with its bar `which` as an actuator, on points that stand still; None where they do not.

    Of an RRP the only bar is 0.
    """
    seen = _Seen(ground, steps)
    ends = [seen.anchor(base) for base in (dyad.bases if isinstance(dyad, RRR) else (dyad.base, dyad.start))]
    if ends[0] is None or ends[1] is None:
        return None
    still = ends[1][0] - ends[0][0]
    if isinstance(dyad, RRR):
        return ActuatedRRR(dyad.joint, follow, dyad, which, arm, still)
    rail = seen.turns.get(dyad.rail.body)
    return None if rail is None else ActuatedRRP(dyad.joint, follow, dyad, arm, still, rail[0] * dyad.rail.direction)


class _Seen:
    """Which points are C + K e^{iq}: those of the ground and of a driver that turns on it."""

    def __init__(self, ground: str, steps: Sequence[Step]):
        # Bodies that stand or turn as the driver does: their direction is C or K e^{iq}, the other zero.
        self.turns: dict[str, tuple[complex, complex]] = {ground: (1, 0)}
        self.origins: dict[str, tuple[complex, complex]] = {ground: (0, 0)}
        for step in steps:
            if isinstance(step, Turned):
                self.turns[step.body] = (0, 1)
            elif isinstance(step, Oriented) and step.with_body in self.turns:
                still, turning = self.turns[step.with_body]
                self.turns[step.body] = (still * step.turn, turning * step.turn)
            elif isinstance(step, Carried) and step.body in self.turns:
                pin = self.anchor(step.pin)
                if pin is not None:
                    still, turning = self.turns[step.body]
                    self.origins[step.body] = (pin[0] - still * step.local, pin[1] - turning * step.local)

    def anchor(self, anchor: Anchor) -> tuple[complex, complex] | None:
        arms = ((anchor.body, anchor.place), *anchor.arms)
        if anchor.body not in self.origins or any(body not in self.turns for body, _ in arms):
            return None
        still, turning = self.origins[anchor.body]
        for body, local in arms:
            still, turning = still + self.turns[body][0] * local, turning + self.turns[body][1] * local
        return still, turning

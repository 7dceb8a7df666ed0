"""The plate of a motor in a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..part import Part
from ..scene import SceneBody

MOTOR = "motor"


def apart(parts: Sequence[Part]) -> tuple[tuple[Part, ...], tuple[Part, ...]]:
    """Parts that turn or hold, and those of the motor."""
    return tuple(p for p in parts if p.body != MOTOR), tuple(p for p in parts if p.body == MOTOR)


def on_motor(bodies: tuple[SceneBody, ...], plates: tuple[Part, ...]) -> tuple[SceneBody, ...]:
    """The bodies on a motor's plates, which lie under all of them about the origin; as they were where it has none."""
    if not plates:
        return bodies
    still = np.ones(bodies[0].origin.shape, dtype=complex)
    motor = SceneBody(MOTOR, plates, 0 * still, still, 0, True)
    return (motor, *(replace(body, layer=body.layer + 1) for body in bodies))

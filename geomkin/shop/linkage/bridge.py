"""A second fixed plate on top of a linkage: what it carries, and the two piles that hold it up."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ...linkage.motion import Motion
from ...plane.vec import Complex, direction_deg, dot
from .plates import Assembly, Plate
from .sweep import path_in

# Directions tried for the two piles that hold up a bridge, in half a turn. Fewer make the bridge longer than need be;
# more take time and save a few hundredths of it at most.
DIRECTIONS = 36
# Joints that the bridge carries.
Way = tuple[str, ...]


def ways(assembly: Assembly, ground: str) -> list[Way]:
    """All choices of joints for the bridge, the fewest first; the first is none. A motor is never above."""
    fixed = list(dict.fromkeys(pin.joint for pin in assembly.pins if ground in pin.plates))
    on_ground = {pin.joint for pin in assembly.pins if pin.shaft}
    # All of them on the bridge would be the same stack upside down.
    some = (way for size in range(max(1, len(fixed))) for way in combinations(fixed, size))
    return [way for way in some if not on_ground & set(way)]


def split(assembly: Assembly, ground: str, way: Way) -> tuple[Plate, Plate]:
    """Ground and bridge, each with its own openings."""
    joints = {pin.name: pin.joint for pin in assembly.pins}
    plates = Plate(ground, {}, assembly.plates[ground].seat), Plate(ground)
    for name, places in assembly.plates[ground].openings.items():
        plates[joints.get(name, name) in way].openings[name] = places
    return plates


def pile_places(motion: Motion, assembly: Assembly, near: float) -> tuple[complex, complex]:
    """Places in the ground's frame on two sides of all that moves, at least `near` mm from every plate's centres.

    The two sides are those between which the mechanism is narrowest.
    """
    ground = motion.linkage.ground
    still = assembly.plates[ground].centres
    moving = [path_in(motion, ground, p.body, p.centres) for name, p in assembly.plates.items() if name != ground]
    middle = complex(still.mean())

    def out(direction: Complex) -> float:
        reach = max(float(dot(direction, still).max()), *(path.reach(complex(direction)) for path in moving))
        return reach - float(dot(direction, middle)) + near

    directions = direction_deg(180 / DIRECTIONS * np.arange(DIRECTIONS))
    widths = [out(u) + out(-u) for u in directions]
    # Compared to ten digits, so that rounding does not choose between two directions that are equally good.
    best = directions[min(range(DIRECTIONS), key=lambda k: (float(f"{widths[k]:.10g}"), k))]
    return middle + complex(best) * out(best), middle - complex(best) * out(-best)

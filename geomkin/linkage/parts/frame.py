"""The frame of a linkage with copies: places for rods through all grounds, clear of everything that moves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...plane.measure import separation
from ...plane.vec import Complex
from ..motion import Motion
from .collisions import Pair, meeting, relative_paths
from .layers import PLAY
from .plates import LinkPlate, opened, unused
from .stack import Stack
from .stock import LinkStock

# Least distance of the two rods that mirror each other, in widths of the bar. With a smaller one the frame twists.
APART = 4.0
# Number of places that are tested at once.
AT_ONCE = 40


def frame_places(motion: Motion, stock: LinkStock, plates: Mapping[str, LinkPlate]) -> tuple[complex, ...]:
    """Three places for rods in the ground's frame, mm, nearest to the driver's shaft; empty if none is free.

    Two of them are each other's mirror image in the upright line through the shaft, and the third is on that line, on
    the other side of the shaft. So the rods also fit through the grounds of mirrored copies. Around each there is room
    for a tube or nut as wide as a bar. plates: of one linkage, which makes a whole turn. Derived here.
    """
    linkage = motion.linkage
    assert linkage.driver_pivot is not None
    k = int(np.argmax(motion.assembled))
    upright = 1j * np.conj(motion.bodies[linkage.ground].direction[k])
    shaft = complex(linkage.bodies[linkage.ground][linkage.driver_pivot])
    width = max(stock.bar_width, stock.fastener_used.across)
    near = width + PLAY * stock.clearance
    moving = [plate for plate in plates.values() if plate.body != linkage.ground]
    paths = [relative_paths(motion, linkage.ground, plate.body, plate.hull(stock.bar_width)) for plate in moving]
    # Beyond this distance from the shaft nothing moves.
    corners = [path.extent(complex(u)) - (u.conjugate() * shaft).real for path in paths for u in (1, 1j, -1, -1j)]
    free = float(np.hypot(1, 1) * max(corners) + near)
    step = near / 2
    grid = step * np.arange(int(free / step) + 2)
    pairs = (grid[:, None] + 1j * np.concatenate([grid, -grid[1:]])).ravel()
    taken = [np.array(z) for plate in plates.values() if plate.body == linkage.ground for z in plate.taken]

    def clear(offsets: Complex) -> Iterator[complex]:
        """The offsets from the shaft, x to the right, that are clear as their mirror images are; the nearest first."""
        ordered = offsets[np.lexsort((offsets.imag, offsets.real, np.abs(offsets)))]
        for some in (ordered[n : n + AT_ONCE] for n in range(0, len(ordered), AT_ONCE)):
            both = shaft + np.concatenate([some, -np.conj(some)]) * upright / 1j
            open_ = np.ones(len(both), dtype=bool)
            for z in taken:
                open_ &= separation(both[:, None], np.broadcast_to(z, (len(both), len(z)))) >= near
            tests = [
                Pair(p.body, p.hull(stock.bar_width), linkage.ground, np.array([z]), near) for z in both for p in moving
            ]
            open_ &= ~meeting(motion, tests).reshape(len(both), -1).any(axis=1)
            yield from some[open_[: len(some)] & open_[len(some) :]].tolist()

    pair = next(clear(pairs[2 * pairs.real >= APART * stock.bar_width]), None)
    if pair is None:
        return ()
    middle = next(clear(-1j * np.copysign(grid[1:], pair.imag or 1.0)), None)
    if middle is None:
        return ()
    return tuple(complex(shaft + z * upright / 1j) for z in (pair, -np.conj(pair), middle))


def with_frame(stack: Stack, ground: str, places: tuple[complex, ...]) -> Stack:
    """A stack whose ground has holes for the rods of a frame. ground: the fixed body."""
    plates = dict(stack.plates)
    name = next(name for name, plate in plates.items() if plate.body == ground and stack.layers[name] == 0)
    taken = opened(plates)
    holes = {unused(f"frame_{k}", taken): (place,) for k, place in enumerate(places, 1)}
    plates[name] = replace(plates[name], openings={**plates[name].openings, **holes})
    return replace(stack, plates=plates, frame=tuple(holes))

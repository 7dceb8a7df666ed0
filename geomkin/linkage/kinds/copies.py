"""Further ones of a linkage in its scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, quantity
from ...core.records import record
from ...making.fasteners import gathered
from ...model.part import Bought, Part
from ...model.scene import Scene, SceneBody, SceneMark
from ...plane.curve import Mirrored
from ...plane.vec import Complex, Real, Whole
from ...recipe.settings import Stroke, Turn
from ..linkage import AbstractLinkage
from ..motion import Motion
from ..moving import move
from ..parts.stack import Stack
from ..scene import placed_bodies, traced_points
from ..solve.branch import Branch


@record(eq=False)
class Copied:
    """Where a copy is.

    rows: of the motion, one for each frame of the scene. mirror: x of the line in which it is mirrored, mm, or None.
    """

    motion: Motion
    rows: Whole
    mirror: float | None

    def place(self, z: Complex) -> Complex:
        """Places of the motion, (its frames,), as they are in the copy, (frames,)."""
        here = z[self.rows]
        return here if self.mirror is None else np.asarray(2 * self.mirror - np.conj(here), dtype=complex)

    def turn(self, direction: Complex) -> Complex:
        """The same of the directions of bodies, whose parts are turned over with them."""
        return direction[self.rows] if self.mirror is None else np.conj(direction[self.rows])

    def part(self, part: Part) -> Part:
        """A part as it is seen from the front of the copy."""
        if self.mirror is None:
            return part
        holes, marks = (tuple(Mirrored(curve) for curve in curves) for curves in (part.holes, part.marks))
        return replace(part, outline=Mirrored(part.outline), holes=holes, marks=marks)


def with_copies(scene: Scene, copies: Sequence[Copied], parts: Sequence[Part], layers: Mapping[str, int]) -> Scene:
    """A linkage's scene with further ones of it, one over the other along the shaft.

    parts: of one of them. layers: of its stack, by the plates' names; turned over, the lowest is the highest. Names
    of bodies are shown on the first only: on all of them they would hide the plates.
    """
    high = 1 + max(layers.values())
    bodies: list[SceneBody] = []
    marks: list[SceneMark] = []
    closed = scene.assembled
    for number, copy in enumerate(copies, 1):
        named = f", copy {number + 1}"
        closed = closed & copy.motion.assembled[copy.rows]
        for body in placed_bodies(copy.motion, parts, layers):
            layer = number * high + (body.layer if copy.mirror is None else high - 1 - body.layer)
            held = tuple(copy.part(part) for part in body.parts)
            place, turn = copy.place(np.asarray(body.origin)), copy.turn(np.asarray(body.direction))
            bodies.append(SceneBody(body.name + named, held, place, turn, layer, body.fixed, named=False))
        marks += [
            replace(mark, place=copy.place(mark.place), label=mark.label + named) for mark in traced_points(copy.motion)
        ]
    return replace(scene, assembled=closed, bodies=(*scene.bodies, *bodies), marks=(*scene.marks, *marks))


# Copies at most. More than these no page shows.
MOST = 23
# Of a turn, how near a way is to one to count as one.
WHOLE = 1e-9


@record(checked=True)
class Copy:
    """A further one of the same linkage, whose crank is on the same shaft."""

    phase_deg: float = quantity(
        "its crank's angle ahead of the first one's", "deg", default=0.0, at_least=-360, at_most=360, example=180.0
    )
    mirrored: bool = entry("it is turned over, left for right, about the shaft", default=False)

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
    frames, k, driver = way.frames, int(np.argmax(first.assembled)), linkage.linkage.driver
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


@record
class Shared:
    """A rod that two neighbouring copies share, glued into the cranks of both instead of a screw in each.

    pin: of the linkage; length: of the rod, mm; words: how the copies stand, and what the rod does.
    """

    pin: str
    length: float
    words: str


def shared_rods(copies: tuple[Copy, ...], linkage: AbstractLinkage, stack: Stack, thickness: float) -> Iterator[Shared]:
    """How neighbouring copies drive each other: pin "" and length 0 where no rod of theirs can.

    Back to back, the shaft goes from crank to crank through both grounds. Face to face, the cranks have one pin in
    common where they stand alike and it ends in the uppermost layer: nothing passes over it. Derived here.
    """
    if not copies:
        return
    whole = linkage.linkage
    all_copies = (Copy(0.0), *copies)
    top = max(stack.layers.values())
    # Of points that fall together the pin has the name of the first, so that holes tell which pins these are.
    crank = [pin for pin in stack.pins if pin.name in whole.pins and whole.driver in pin.holes]
    shaft = next(pin for pin in crank if any(stack.plates[name].body == whole.ground for name in pin.holes))
    common = next((pin for pin in crank if pin is not shaft and pin.last == top), None)
    for k, (one, two) in enumerate(zip(all_copies, all_copies[1:]), 1):
        pair, apart = f"copies {k} and {k + 1}", (two.phase_deg - one.phase_deg) % 360
        if one.mirrored and not two.mirrored and shaft.first == 0:
            room = 2 * _beyond(stack, thickness, 0, shaft.name)
            length = 2 * shaft.length + room
            rod = f"one rod {stack.letters[shaft.name]}, {length:g} mm long for both screws, glued into both cranks"
            words = f"{pair} back to back, {room:g} mm between their grounds: {rod} {apart:g} deg apart"
            yield Shared(shaft.name, length, words)
        elif two.mirrored and not one.mirrored and common is not None and apart == 0:
            room = 2 * _beyond(stack, thickness, top, common.name)
            length = 2 * common.length + room
            rod = f"one rod {stack.letters[common.name]}, {length:g} mm long for both screws, glued into both cranks"
            yield Shared(common.name, length, f"{pair} face to face, {room:g} mm between them: {rod}")
        else:
            yield Shared("", 0.0, f"{pair}: no rod of theirs joins their cranks, so turn both by a shaft of yours")


def _beyond(stack: Stack, thickness: float, layer: int, but: str) -> float:
    """How far heads and nuts stand out of the lowest or the uppermost layer, mm, in whole sheets."""
    high = 0.0
    for pin in stack.pins:
        head, nut = stack.fastener.ends(pin.length)
        if pin.name != but and pin.first == 0 == layer:
            high = max(high, nut)
        elif pin.name != but and pin.last == layer != 0:
            high = max(high, head if pin.first == 0 else nut)
    return float(thickness * np.ceil(high / thickness - 1e-9))


def joining(stack: Stack, shared: Sequence[Shared], count: int) -> tuple[Bought, ...]:
    """What is bought for so many of a linkage: a screw for each joint, but for those that share a rod."""
    lines = []
    for pin in stack.pins:
        rods = [one for one in shared if one.pin == pin.name]
        own = count - 2 * len(rods)
        each = stack.bill(pin) if own else ()
        cut = tuple((f"rod {stack.fastener.diameter:g} mm, cut to {one.length:g} mm", 1) for one in rods)
        lines.append((stack.letters[pin.name], (*((name, own * number) for name, number in each), *cut)))
    return gathered(lines)


def copying(copies: Sequence[Copy], shared: Sequence[Shared]) -> tuple[str, ...]:
    """The steps that put a linkage and its copies together; none without copies."""
    if not copies:
        return ()
    told = "; ".join(f"copy {k}: {copy}" for k, copy in enumerate(copies, 2))
    held = f"hold all {1 + len(copies)} grounds in a frame of yours, square to the shaft"
    return (f"{1 + len(copies)} of these on one shaft, {told}", *(one.words for one in shared), held)

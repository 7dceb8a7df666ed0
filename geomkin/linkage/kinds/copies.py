"""Copies of a linkage on the same shaft: their motion, the rods between them, and their assembly."""

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
    """The motion of a copy.

    rows: frame of the motion for each frame of the scene. mirror: x of the line in which it is mirrored, mm, or None.
    """

    motion: Motion
    rows: Whole
    mirror: float | None

    def place(self, z: Complex) -> Complex:
        """Positions of the motion, (its frames,), in the copy, (frames,)."""
        positions = z[self.rows]
        return positions if self.mirror is None else np.asarray(2 * self.mirror - np.conj(positions), dtype=complex)

    def rotated(self, direction: Complex) -> Complex:
        """Directions of bodies in the copy; its parts are mirrored with them."""
        return direction[self.rows] if self.mirror is None else np.conj(direction[self.rows])

    def part(self, part: Part) -> Part:
        """A part seen from the front of the copy."""
        if self.mirror is None:
            return part
        holes, marks = (tuple(Mirrored(curve) for curve in curves) for curves in (part.holes, part.marks))
        return replace(part, outline=Mirrored(part.outline), holes=holes, marks=marks)


def with_copies(scene: Scene, copies: Sequence[Copied], parts: Sequence[Part], layers: Mapping[str, int]) -> Scene:
    """The scene of a linkage with its copies, one above the other along the shaft.

    parts: of one linkage. layers: of its stack, by the plates' names; a mirrored copy has them in reverse. Only the
    first linkage shows the names of its bodies.
    """
    height = 1 + max(layers.values())
    bodies: list[SceneBody] = []
    marks: list[SceneMark] = []
    closed = scene.assembled
    for number, copy in enumerate(copies, 1):
        suffix = f", copy {number + 1}"
        closed = closed & copy.motion.assembled[copy.rows]
        for body in placed_bodies(copy.motion, parts, layers):
            layer = number * height + (body.layer if copy.mirror is None else height - 1 - body.layer)
            copied_parts = tuple(copy.part(part) for part in body.parts)
            place, direction = copy.place(np.asarray(body.origin)), copy.rotated(np.asarray(body.direction))
            bodies.append(SceneBody(body.name + suffix, copied_parts, place, direction, layer, body.fixed, named=False))
        marks += [
            replace(mark, place=copy.place(mark.place), label=mark.label + suffix)
            for mark in traced_points(copy.motion)
        ]
    return replace(scene, assembled=closed, bodies=(*scene.bodies, *bodies), marks=(*scene.marks, *marks))


# Largest number of copies.
MOST = 23
# Relative tolerance of a whole turn.
WHOLE = 1e-9


@record(checked=True)
class Copy:
    """A copy of the linkage whose crank is on the same shaft."""

    phase_deg: float = quantity(
        "angle of its crank ahead of the first one's", "deg", default=0.0, at_least=-360, at_most=360, example=180.0
    )
    mirrored: bool = entry("whether it is turned over, left for right, about the shaft", default=False)

    def __str__(self) -> str:
        return f"crank {self.phase_deg:g} deg ahead{', turned over' if self.mirrored else ''}"


def copies_entry() -> Any:
    """Field for copies of the linkage."""
    return entry("copies of the linkage on the same shaft", default=())


def check_copies(copies: tuple[Copy, ...], linkage: AbstractLinkage, input_range: Turn | Stroke) -> None:
    """Refuse copies of a linkage whose driver does not make whole turns on a fixed shaft."""
    if not copies:
        return
    if len(copies) > MOST:
        raise DesignError("copies", f"found {len(copies)}", f"give at most {MOST}", "out-of-range")
    if linkage.linkage.driver_pivot is None:
        raise DesignError("copies", "the driver turns on no fixed shaft that they could share", "omit them", "conflict")
    if not is_whole_turn(input_range):
        raise DesignError(
            "copies", "the driver makes no whole turn", "let it turn by 360 deg, or omit copies", "conflict"
        )


def is_whole_turn(input_range: Turn | Stroke) -> bool:
    """Whether the driver turns by 360 deg in either direction."""
    return isinstance(input_range, Turn) and abs(input_range.turn_deg - 360) <= 360 * WHOLE


def copied(copies: tuple[Copy, ...], first: Motion, linkage: AbstractLinkage, signs: Branch) -> Iterator[Copied]:
    """The motion of each copy at the frames of the first linkage, over one turn of its driver.

    Each is followed from the first linkage's start, through its phase angle, so that it moves on the same branch.
    Derived here.
    """
    frames, k, driver = first.drive, int(np.argmax(first.assembled)), linkage.linkage.driver
    pivot = linkage.linkage.driver_pivot
    assert pivot is not None
    shaft = complex(first.point(pivot).position[k])
    # Towards the crank's first pin besides the shaft, or along its x axis if it has none.
    points = linkage.linkage.bodies[driver]
    arm = next((z - points[pivot] for z in points.values() if z != points[pivot]), 1.0)
    # Its angle at a drive of 0.
    zero_angle = float(np.angle(first.bodies[driver].direction[k] * arm * np.exp(-1j * frames[k])))
    for copy in copies:
        phase = np.radians(copy.phase_deg)
        # In a mirrored copy an arm at an angle a appears at pi - a.
        wanted = np.pi - 2 * zero_angle - phase - frames[::-1] if copy.mirrored else frames + phase
        motion = move(linkage, _led(wanted, frames), signs, first.timing.speed, first.timing.acceleration)
        rows = np.arange(len(motion.drive) - len(frames), len(motion.drive))
        yield Copied(motion, rows[::-1] if copy.mirrored else rows, shaft.real if copy.mirrored else None)


def _led(wanted: Real, frames: Real) -> Real:
    """A drive that continues from the first frame and ends with `wanted`, or whole turns later."""
    steps = np.diff(frames)
    step = float(steps[np.argmax(np.abs(steps))])
    turn = float(np.copysign(2 * np.pi, step))
    later = wanted + turn * np.ceil((frames[0] - wanted[0]) / turn - WHOLE)
    before = np.arange(frames[0], later[0] - 1e-6 * step, step)
    return np.concatenate([before, later])


@record
class Shared:
    """A rod that two neighbouring copies share, glued into the cranks of both instead of a screw in each.

    pin: of the linkage; length: of the rod, mm; words: the arrangement of the copies, and the purpose of the rod.
    """

    pin: str
    length: float
    words: str


def shared_rods(copies: tuple[Copy, ...], linkage: AbstractLinkage, stack: Stack, thickness: float) -> Iterator[Shared]:
    """The rods by which neighbouring copies drive each other; pin "" and length 0 if no rod fits.

    Back to back, the shaft goes from crank to crank through both grounds. Face to face, the cranks share a pin if they
    are in phase and it ends in the uppermost layer, so that nothing passes over it. Derived here.
    """
    if not copies:
        return
    whole = linkage.linkage
    all_copies = (Copy(0.0), *copies)
    top = max(stack.layers.values())
    # Coincident points have the name of the first, so the pins are identified by their holes.
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
            yield Shared("", 0.0, f"{pair}: no rod joins their cranks, so turn both by a shaft of yours")


def _beyond(stack: Stack, thickness: float, layer: int, excluded: str) -> float:
    """Height of heads and nuts beyond the lowest or uppermost layer, mm, in whole sheets."""
    height = 0.0
    for pin in stack.pins:
        head, nut = stack.fastener.ends(pin.length)
        if pin.name != excluded and pin.first == 0 == layer:
            height = max(height, nut)
        elif pin.name != excluded and pin.last == layer != 0:
            height = max(height, head if pin.first == 0 else nut)
    return float(thickness * np.ceil(height / thickness - 1e-9))


def joining(stack: Stack, shared: Sequence[Shared], count: int) -> tuple[Bought, ...]:
    """Bought items for several copies of a linkage: a screw for each joint, except those that share a rod."""
    lines = []
    for pin in stack.pins:
        rods = [rod for rod in shared if rod.pin == pin.name]
        single = count - 2 * len(rods)
        bill = stack.bill(pin) if single else ()
        rod_bill = tuple((f"rod {stack.fastener.diameter:g} mm, cut to {rod.length:g} mm", 1) for rod in rods)
        lines.append((stack.letters[pin.name], (*((name, single * number) for name, number in bill), *rod_bill)))
    return gathered(lines)


def copying(copies: Sequence[Copy], shared: Sequence[Shared]) -> tuple[str, ...]:
    """Assembly steps of a linkage with its copies; none without copies."""
    if not copies:
        return ()
    phases = "; ".join(f"copy {k}: {copy}" for k, copy in enumerate(copies, 2))
    frame = f"hold all {1 + len(copies)} grounds in a frame of yours, square to the shaft"
    return (f"{1 + len(copies)} of these on one shaft, {phases}", *(rod.words for rod in shared), frame)

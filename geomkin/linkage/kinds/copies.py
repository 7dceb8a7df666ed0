"""Copies of a linkage on the same shaft: their motion, the rods between them, and their assembly."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, quantity
from ...core.records import record
from ...core.units import mm
from ...making.assembly import Bill, glue_bill, tube_bill
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Scene, SceneBody, SceneMark
from ...plane.measure import separation
from ...plane.vec import Complex, Pose, Real, Whole
from ...recipe.aspect import ShaftPlacement
from ...recipe.settings import Stroke, Turn
from ..linkage import AbstractLinkage
from ..motion import Motion
from ..moving import move
from ..parts.collisions import Pair, meeting, relative_paths
from ..parts.layers import PLAY
from ..parts.plates import LinkPlate, opened, unused
from ..parts.stack import PinSpan, Stack
from ..parts.stock import LinkStock
from ..scene import placed_bodies, traced_points
from ..solve.branch import Branch

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
    near = width + PLAY * stock.pin_clearance
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


@record(eq=False)
class Copied:
    """The motion of a copy.

    rows: frame of the motion for each frame of the scene. placement: of the copy on the shaft.
    """

    motion: Motion
    rows: Whole
    placement: ShaftPlacement = ShaftPlacement()

    @property
    def mirrored(self) -> bool:
        """Whether it is turned over."""
        return self.placement.mirrored

    def place(self, z: Complex) -> Complex:
        """Positions of the motion, (its frames,), in the copy, (frames,)."""
        return self.placement.place(z[self.rows])


def with_copies(
    scene: Scene, copies: Sequence[Copied], parts: Sequence[Part], layers: Mapping[str, int], lowest: int
) -> Scene:
    """The scene of a linkage with its copies, one above the other along the shaft.

    parts: of one copy. layers: of its stack, by the plates' names; a mirrored copy has them in reverse. lowest: layer
    of the first copy. Only the first linkage shows the names of its bodies.
    """
    height = 1 + max(layers.values())
    bodies: list[SceneBody] = []
    marks: list[SceneMark] = []
    closed = scene.assembled
    for number, copy in enumerate(copies, 1):
        suffix = f", copy {number + 1}"
        closed = closed & copy.motion.assembled[copy.rows]
        for body in placed_bodies(copy.motion, parts, layers):
            layer = height - 1 - body.layer if copy.mirrored else body.layer
            layer += lowest + (number - 1) * height
            copied_parts = tuple(copy.placement.part(part) for part in body.parts)
            place = copy.place(np.asarray(body.origin))
            direction = copy.placement.rotated(np.asarray(body.direction)[copy.rows])
            bodies.append(SceneBody(body.name + suffix, copied_parts, place, direction, layer, body.fixed, named=False))
        marks += [
            replace(mark, place=copy.place(mark.place), label=mark.label + suffix)
            for mark in traced_points(copy.motion)
        ]
    # Not mirrored, since each copy is assembled on its own ground.
    rows = copies[0].rows
    own = (
        replace(body, origin=np.asarray(body.origin)[rows], direction=np.asarray(body.direction)[rows])
        for body in placed_bodies(copies[0].motion, parts, layers)
    )
    units = _units(scene.bodies, tuple(own), len(copies))
    return replace(scene, assembled=closed, bodies=(*scene.bodies, *bodies), marks=(*scene.marks, *marks), units=units)


def _units(first: tuple[SceneBody, ...], copy: tuple[SceneBody, ...], count: int) -> dict[str, tuple[SceneBody, ...]]:
    """The bodies of the first linkage and of its copies, which are assembled each on its own ground."""
    if {part.name for body in first for part in body.parts} == {part.name for body in copy for part in body.parts}:
        return {f"each of {1 + count} copies": first}
    last = f"copies 2 to {1 + count}" if count > 1 else "copy 2"
    return {"copy 1": first, last: copy}


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
        # Seen from its front, a mirrored copy turns the other way.
        side = -1 if copy.mirrored else 1
        speed, acceleration = side * first.timing.speed, side * first.timing.acceleration
        motion = move(linkage, _led(wanted, frames), signs, speed, acceleration)
        rows = np.arange(len(motion.drive) - len(frames), len(motion.drive))
        placement = ShaftPlacement(Pose(2 * shaft.real if copy.mirrored else 0.0), copy.mirrored)
        yield Copied(motion, rows[::-1] if copy.mirrored else rows, placement)


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

    pin: of the linkage; length: of the rod, mm; room: between the copies, mm; words: the arrangement of the copies, and
    the purpose of the rod; apart: between the grounds, mm.
    """

    pin: str
    length: float
    room: float
    words: str
    apart: float = np.nan


def without_motor(stack: Stack, driven: Stack) -> Stack:
    """A stack without a motor beside one on it: plates that differ from those of `driven` have names of their own."""
    names: dict[str, str] = {}
    for name, plate in stack.plates.items():
        other = driven.plates.get(name)
        is_equal = other is not None and other.seat is None and other.openings == plate.openings
        if is_equal and all(stack.letters.get(pin) == driven.letters.get(pin) for pin in plate.openings):
            names[name] = name
        else:
            names[name] = unused(f"plain_{name}", {*stack.plates, *driven.plates})
    pins = (
        replace(pin, holes=tuple(names[name] for name in pin.holes), slots=tuple(names[name] for name in pin.slots))
        for pin in stack.pins
    )
    return replace(
        stack,
        layers={names[name]: layer for name, layer in stack.layers.items()},
        pins=tuple(pins),
        plates={names[name]: plate for name, plate in stack.plates.items()},
    )


def counted(driven: Sequence[Part], others: Sequence[Part], count: int) -> tuple[Part, ...]:
    """The parts of a linkage and those of its `count` copies, equal ones once."""
    parts = {part.name: part for part in driven}
    for part in others:
        number = count * part.count + (parts[part.name].count if part.name in parts else 0)
        parts[part.name] = replace(part, count=number)
    return tuple(parts.values())


def stacks_for_rods(
    copies: tuple[Copy, ...], linkage: AbstractLinkage, stacks_of: Callable[[str], tuple[Stack, Stack]]
) -> tuple[Stack, Stack]:
    """The stacks of the first linkage and of a copy with the fewest layers in which all rods between copies fit.

    If none has all rods, those with most. Only rods between copies face to face depend on the order of layers.

    stacks_of: the stacks with a given pin in the uppermost layer, or with any, "".
    """
    fewest = stacks_of("")

    def rodless(stacks: tuple[Stack, Stack]) -> int:
        return sum(not rod.pin for rod in shared_rods(copies, linkage, stacks, 1.0))

    if not any(_face_to_face(*pair) for pair in pairwise((Copy(), *copies))) or not rodless(fewest):
        return fewest
    driver, ground = linkage.linkage.driver, linkage.linkage.ground
    pins = (name for name, bodies in linkage.linkage.pins.items() if driver in bodies and ground not in bodies)
    tries = [fewest, *(stacks_of(name) for name in pins)]
    return min(tries, key=lambda stacks: (sum(len(stack.collisions) for stack in stacks), rodless(stacks)))


def _face_to_face(one: Copy, two: Copy) -> bool:
    """Whether the cranks of neighbouring copies face each other in phase."""
    return two.mirrored and not one.mirrored and (two.phase_deg - one.phase_deg) % 360 == 0


def shared_rods(
    copies: tuple[Copy, ...], linkage: AbstractLinkage, stacks: tuple[Stack, Stack], thickness: float
) -> tuple[Shared, ...]:
    """The rods by which neighbouring copies drive each other; where none fits, pin "", length 0 and room nan.

    Back to back, the shaft goes from crank to crank through both grounds. Face to face, the cranks share a pin if they
    are in phase and it ends in the uppermost layer, so that nothing passes over it. Derived here.

    stacks: of the first linkage and of a copy.
    """
    return tuple(_shared_rods((Copy(), *copies), linkage, (stacks[0], *(stacks[1] for _ in copies)), thickness))


def _shared_rods(
    all_copies: tuple[Copy, ...], linkage: AbstractLinkage, stacks: Sequence[Stack], thickness: float
) -> Iterator[Shared]:
    for k in range(1, len(stacks)):
        (one, two), (lower, upper) = all_copies[k - 1 : k + 1], stacks[k - 1 : k + 1]
        pair, apart = f"copies {k} and {k + 1}", (two.phase_deg - one.phase_deg) % 360
        (shaft, common), (other_shaft, other_common) = (_crank_pins(linkage, stack) for stack in (lower, upper))
        if one.mirrored and not two.mirrored and shaft.first == other_shaft.first == 0:
            room = sum(_beyond(stack, thickness, 0, shaft.name) for stack in (lower, upper))
            length = shaft.length + other_shaft.length + room
            rod = f"rod {lower.letters[shaft.name]}, {mm(length):g} long, is glued into both cranks"
            angle = "so that their pins point in opposite directions" if apart == 180 else f"{apart:g} deg apart"
            words = f"{pair} back to back, {mm(room):g} between their grounds: {rod}, {angle}"
            yield Shared(shaft.name, length, room, words, room)
        elif _face_to_face(one, two) and (names := [n for n in common if n in other_common]):
            pin = names[0]
            room = sum(_beyond(stack, thickness, max(stack.layers.values()), pin) for stack in (lower, upper))
            length = common[pin].length + other_common[pin].length + room
            rod = f"rod {lower.letters[pin]}, {mm(length):g} long, is glued into both cranks"
            height = room + thickness * sum(max(stack.layers.values()) for stack in (lower, upper))
            words = f"{pair} face to face, {mm(room):g} between them, the upper one turned over: {rod}"
            yield Shared(pin, length, room, words, height)
        else:
            yield Shared("", 0.0, np.nan, f"{pair}: no rod joins their cranks; add a shaft that turns both")


def _crank_pins(linkage: AbstractLinkage, stack: Stack) -> tuple[PinSpan, dict[str, PinSpan]]:
    """The crank's shaft, and by name its other pins that end in the uppermost layer."""
    whole, top = linkage.linkage, max(stack.layers.values())
    # Coincident points have the name of the first, so the pins are identified by their holes.
    bodies = {pin.name: {stack.plates[name].body for name in pin.holes} for pin in stack.pins}
    crank = [pin for pin in stack.pins if pin.name in whole.pins and whole.driver in bodies[pin.name]]
    shaft = next(pin for pin in crank if whole.ground in bodies[pin.name])
    return shaft, {pin.name: pin for pin in crank if pin is not shaft and pin.last == top}


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


def frame_length(stacks: Sequence[Stack], shared: Sequence[Shared], thickness: float) -> float:
    """Distance of the outer faces of the first and last ground, mm."""
    return thickness * len(stacks) + sum(rod.apart for rod in shared)


def joint_bills(stacks: Sequence[Stack], shared: Sequence[Shared], thickness: float) -> list[tuple[str, Bill]]:
    """Bought items of each joint of several copies of a linkage: a screw, except for joints that share a rod.

    Also the rods of the frame, and the tubes on them between the grounds. stacks: of the first linkage and of each
    copy; thickness: of the sheet, mm.
    """
    lines: list[tuple[str, Bill]] = []
    for name in dict.fromkeys(pin.name for stack in stacks for pin in stack.pins):
        for k, stack in enumerate(stacks):
            has_rod = any(rod.pin == name for rod in shared[max(0, k - 1) : k + 1])
            lines += [(stack.letters[name], stack.bill(pin)) for pin in stack.pins if pin.name == name and not has_rod]
        lines += [
            (stack.letters[name], (stack.fastener.rod(rod.length), *glue_bill(2)))
            for stack, rod in zip(stacks, shared)
            if rod.pin == name
        ]
    first = stacks[0]
    for name in first.frame:
        lines.append((first.letters[name], first.fastener.bill(frame_length(stacks, shared, thickness))))
        tubes = (tube_bill(first.fastener.diameter, rod.apart) for rod in shared if rod.apart)
        lines += [(first.letters[name], tube) for tube in tubes]
    return lines


def _rod_steps(
    stacks: Sequence[Stack], shared: Sequence[Shared], copies: Sequence[Copy], k: int
) -> dict[str, tuple[int, str]]:
    """By the pins of the linkage k, from 0, that are rods: the layer in which the rod is put in, and the step."""
    pins, letters, steps = {pin.name: pin for pin in stacks[k].pins}, stacks[k].letters, dict[str, tuple[int, str]]()
    is_mirrored = k > 0 and copies[k - 1].mirrored
    if k > 0 and (rod := shared[k - 1].pin):
        empty = f"leave {letters[rod]} empty, and glue the spacers on {letters[rod]} to the plates below them"
        glued = f"glue the crank on rod {letters[rod]} of the copy below"
        steps[rod] = (pins[rod].first, empty) if is_mirrored else (pins[rod].last, glued)
    if k < len(shared) and (rod := shared[k].pin):
        side = "above" if is_mirrored else "below"
        step = f"put rod {letters[rod]} through from {side} and glue it into the crank"
        steps[rod] = pins[rod].last if is_mirrored else pins[rod].first, step
    return steps


def _listed(numbers: Sequence[int]) -> str:
    return " and ".join(filter(None, [", ".join(map(str, numbers[:-1])), str(numbers[-1])]))


def copying(
    copies: Sequence[Copy], shared: Sequence[Shared], stacks: Sequence[Stack], thickness: float
) -> tuple[str, ...]:
    """Assembly steps of a linkage with its copies.

    stacks: of the first linkage and of each copy; thickness: of the sheet, mm.
    """
    by_steps: dict[tuple[str, ...], list[int]] = {}
    for k, stack in enumerate(stacks):
        by_steps.setdefault(tuple(stack.steps_with(_rod_steps(stacks, shared, copies, k))), []).append(k + 1)
    units = [
        step if len(by_steps) == 1 else f"{'copy' if len(numbers) == 1 else 'copies'} {_listed(numbers)}, {step}"
        for steps, numbers in by_steps.items()
        for step in steps
    ]
    phases = "; ".join(f"copy {k}: {copy}" for k, copy in enumerate(copies, 2))
    arranged = f"{len(stacks)} of these on one shaft, {phases}"
    return (
        *units,
        *stacks[0].closing,
        arranged,
        *(rod.words for rod in shared),
        _frame_step(shared, stacks, thickness),
    )


def _frame_step(shared: Sequence[Shared], stacks: Sequence[Stack], thickness: float) -> str:
    first = stacks[0]
    if not first.frame:
        return f"mount all {len(stacks)} grounds in a frame at right angles to the shaft"
    letters = [first.letters[name] for name in first.frame]
    tubes = f"{mm(*(rod.apart for rod in shared)):g}"
    return (
        f"frame: the rods {', '.join(letters)} go through all grounds, "
        f"{mm(frame_length(stacks, shared, thickness)):g} from the first to the last; on each rod, between the "
        "grounds, "
        f"tubes of {tubes} in this order; a washer and a nut at each end; where a copy is turned over, {letters[0]} "
        f"and {letters[1]} change places"
    )


def driven_check(copies: Sequence[Copy], shared: Sequence[Shared], attached: Collection[str]) -> Check:
    """Check that the motor of the first linkage turns all copies, through the rods between their cranks.

    attached: names of attachments.
    """
    joined = next((k for k, rod in enumerate(shared) if not rod.pin), len(shared))
    one, two = (Copy(), *copies, Copy())[joined : joined + 2]
    advice = "let every second copy be mirrored, in phase with the one before it, so that rods join their cranks"
    if joined < len(shared) and (_face_to_face(one, two) or (one.mirrored and not two.mirrored)):
        moved = f", move {' and '.join(attached)} nearer to the pins of the same plate" if attached else ""
        advice = (
            f"plates cover the crank's pins towards copy {joined + 2} in each order of layers: give narrower "
            f"bars{moved}, or add a shaft that turns all cranks"
        )
    return Check(
        "copies_not_driven", "copies that no rod joins to the motor", len(shared) - joined, "at most", 0, "", advice
    )

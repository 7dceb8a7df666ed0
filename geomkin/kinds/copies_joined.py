"""How copies of a linkage on one shaft are joined: the rods that they share, what is bought, and the steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..brief import one_line
from ..linkage.linkage import AbstractLinkage
from ..part import Bought
from ..shop.fasteners import gathered
from ..shop.linkage.stack import Stack
from .copies import Copy


@dataclass(frozen=True)
class Shared:
    """A rod that two neighbouring copies share, glued into the cranks of both instead of a screw in each.

    pin: of the linkage; length: of the rod, mm; words: how the copies stand, and what the rod does.
    """

    pin: str
    length: float
    words: str

    __repr__ = one_line


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

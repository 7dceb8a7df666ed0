"""The least transmission angle on the way from one place of the driver to another, in closed form, of many at once."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Real

# All of these: sizes (linkages,), mm; start and end of the drive (linkages,), unwrapped; the least acute angle on all
# of the way, rad. What it hangs on is steady between the drives named here, so that its least is at one of them.


def of_four_bars(ground: Real, crank: Real, coupler: Real, rocker: Real, start: Real, end: Real) -> Real:
    """The crank drives: the angle at the rocker pin hangs on the distance across, which is steady from 0 to pi."""
    turns = [start, end, _passed(start, end, 0.0), _passed(start, end, np.pi)]
    # By half angles: the distance keeps its digits where crank and ground lie folded.
    across = [np.hypot(ground - crank, 2 * np.sqrt(ground * crank) * np.sin(t / 2)) for t in turns]
    least: Real = np.minimum.reduce([acute_at(coupler, rocker, one) for one in across])
    return least


def of_slider_cranks(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """The crank drives: between the coupler and the slide's normal; the pin's height is steady between its normals."""
    turns = [start, end, _passed(start, end, np.pi / 2), _passed(start, end, -np.pi / 2)]
    least: Real = np.minimum.reduce([_beside(offset - crank * np.sin(t), coupler) for t in turns])
    return least


def of_driving_slides(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """The slider drives: between crank and coupler, which are as far apart as their ends are."""
    middle = np.where(start * end < 0, 0.0, start)
    least: Real = np.minimum.reduce([acute_at(crank, coupler, np.hypot(x, offset)) for x in (start, end, middle)])
    return least


def of_driving_shuttles(rod: Real, sine: Real, start: Real, end: Real) -> Real:
    """A trammel's first shuttle drives: between the rod and the second slot's normal. sine: of the slots' angle."""
    return np.minimum(*(_beside(x * sine, rod) for x in (start, end)))


def acute_at(one: Real, other: Real, across: Real) -> Real:
    """The acute angle between two sides of a triangle, by the third; 0 where they do not reach."""
    inner = np.maximum((across - one + other) * (across + one - other), 0.0)
    outer = np.maximum((one + other - across) * (one + other + across), 0.0)
    half: Real = np.arctan2(np.sqrt(np.minimum(inner, outer)), np.sqrt(np.maximum(inner, outer)))
    return 2 * half


def _beside(height: Real, length: Real) -> Real:
    """What is left to a right angle of that at which a bar of a `length` climbs a `height`."""
    return np.arctan2(np.sqrt(np.maximum((length - height) * (length + height), 0.0)), np.abs(height))


def _passed(start: Real, end: Real, angle: float) -> Real:
    """The drive at `angle` where the way goes over it, a whole number of turns left out, else its start."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    over = np.floor((high - angle) / (2 * np.pi)) >= np.ceil((low - angle) / (2 * np.pi))
    return np.where(over, angle, start)

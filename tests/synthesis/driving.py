"""Linkages driven from place to place in small steps, many at once: the second road to the verdict on defects.

Nothing here knows of Grashof, of ranges or of circuits: a driver is turned or slid, the other pin is where two circles
or a circle and a line cross, and the step at which they no longer do ends the way.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

# Steps between two places, and how often the place where the loop is nearest to opening is looked at more closely.
STEPS, LOOKS = 120, 5


@dataclass
class InputDyad:
    """Many linkages at places: drives and second pins, (places, linkages), and where these can be at any drive.

    crossing(q) -> the two places of the second pin, and how far the loop is from opening; q (..., linkages).
    """

    drive: np.ndarray
    pin: np.ndarray
    crossing: object
    turns: bool
    size: np.ndarray


def goes_through(case):
    """Whether each goes through its places in order, in one drive of one sense, without opening: (linkages,)."""
    ways = (1, -1) if case.turns else (0,)
    return np.any([_goes(case, way) for way in ways], axis=0)


def _goes(case, way):
    start = case.drive[0]
    if way:
        # The driver turns on from the first place, once round at most, and meets the others on its way.
        along = np.mod(way * (case.drive - start), 2 * np.pi)
        along[0] = 0.0
        sense = way
    else:
        sense = np.where(case.drive[1] >= start, 1.0, -1.0)
        along = sense * (case.drive - start)
    good = (np.diff(along, axis=0) > 0).all(axis=0)
    at = np.full(start.shape, -1)
    for j in range(len(along)):
        one, other, _ = case.crossing(start + sense * along[j])
        near = np.argmin(np.abs([one - case.pin[j], other - case.pin[j]]), axis=0)
        # Which of the two it is in: never the other without meeting it, which ends the way.
        good &= (near == at) | (j == 0)
        at = near
        if j == len(along) - 1:
            break
        low, high = along[j], along[j + 1]

        def gap(share):
            return case.crossing(start + sense * (low + share * (high - low)))[2]

        share = np.linspace(0, 1, STEPS + 1)[:, None] * np.ones_like(start)
        for _ in range(LOOKS):
            values = gap(share)
            best = values[1:-1].argmin(axis=0) + 1
            left, right = (np.take_along_axis(share, (best + k)[None], axis=0)[0] for k in (-1, 1))
            inside = np.take_along_axis(values, best[None], axis=0)[0]
            good &= inside > 0
            share = left + np.linspace(0, 1, 25)[:, None] * (right - left)
    return good


def circles(at, centre, reach, bar):
    """Crossings of the circle of `bar` about the driven pin `at` with that of `reach` about `centre`."""
    apart = centre - at
    far = np.abs(apart)
    gap = np.minimum(bar + reach - far, far - np.abs(bar - reach))
    along = (far**2 + bar**2 - reach**2) / (2 * far)
    aside = np.sqrt(np.maximum(bar**2 - along**2, 0))
    return at + apart / far * (along + 1j * aside), at + apart / far * (along - 1j * aside), gap


def line(at, through, rail, bar):
    """Crossings of the same circle with a line."""
    back = (at - through) * np.conj(rail)
    gap = bar - np.abs(back.imag)
    reach = np.sqrt(np.maximum(bar**2 - back.imag**2, 0))
    return through + rail * (back.real + reach), through + rail * (back.real - reach), gap


def of_four_bar(first, second, pivots, driver):
    """Pins (places, linkages) and pivots (linkages,); the crank holds the first."""
    if driver == "rocker":
        return of_four_bar(second, first, pivots[::-1], "crank")
    crank, bar = np.abs(first[0] - pivots[0]), np.abs(second[0] - first[0])
    reach = np.abs(second[0] - pivots[1])

    def crossing(q):
        return circles(pivots[0] + crank * np.exp(1j * q), pivots[1], reach, bar)

    return InputDyad(np.angle(first - pivots[0]), second, crossing, True, crank + bar + reach)


def of_slider_crank(first, second, pivot, rail, driver):
    crank, bar = np.abs(first[0] - pivot), np.abs(second[0] - first[0])
    if driver == "crank":

        def crossing(q):
            return line(pivot + crank * np.exp(1j * q), second[0], rail, bar)

        return InputDyad(np.angle(first - pivot), second, crossing, True, crank + bar)
    through = second[0]

    def slid(q):
        return circles(through + q * rail, pivot, crank, bar)

    return InputDyad(((second - through) * np.conj(rail)).real, first, slid, False, crank + bar)


def of_trammel(first, second, slots, driver):
    bar = np.abs(second[0] - first[0])
    if driver == "shuttle":
        through = first[0]

        def slid(q):
            return line(through + q * slots[0], second[0], slots[1], bar)

        return InputDyad(((first - through) * np.conj(slots[0])).real, second, slid, False, bar)

    def turned(q):
        # The first pin on its slot, such that the second is on its own.
        rod = bar * np.exp(1j * q)
        away = ((first[0] + rod - second[0]) * np.conj(slots[1])).imag
        at = first[0] - slots[0] * away / (slots[0] * np.conj(slots[1])).imag
        return at + rod, at + rod, np.ones_like(q)

    return InputDyad(np.angle(second - first), second, turned, True, bar)


def three_poses(rng, count):
    """Origins and directions of three random poses, (3, count)."""
    return rng.normal(size=(3, count)) + 1j * rng.normal(size=(3, count)), np.exp(
        1j * rng.uniform(-np.pi, np.pi, (3, count))
    )


def carried(poses, point):
    return poses[0] + poses[1] * point


def centre_of(pins):
    """Of the circle through three places, by the two perpendiculars."""
    a, b = pins[1] - pins[0], pins[2] - pins[0]
    return pins[0] + 1j * (a * np.abs(b) ** 2 - b * np.abs(a) ** 2) / (2 * (a.real * b.imag - a.imag * b.real))


def sliding(poses, rng):
    """A random point of each body whose three places lie in one line: on a random line through the body, by bisection
    on the root of a quadratic, which is fitted to three of its values; and the line's direction.
    """
    count = poses[0].shape[1]
    start, way = rng.normal(size=count) + 1j * rng.normal(size=count), np.exp(1j * rng.uniform(0, 2 * np.pi, count))

    def bent(t):
        a, b, c = carried(poses, start + t * way)
        return ((b - a) * np.conj(c - a)).imag

    low, middle, high = bent(-1), bent(0), bent(1)
    p, q = (low + high) / 2 - middle, (high - low) / 2
    # Where the line passes by the circle there is none.
    root = np.sqrt(np.maximum(q**2 - 4 * p * middle, 0))
    t = np.where(root > 0, (-q + np.sign(rng.normal(size=count)) * root) / (2 * p), np.nan)
    pins = carried(poses, start + t * way)
    far = np.argmax(np.abs([pins[1] - pins[0], pins[2] - pins[0]]), axis=0)
    rail = np.where(far == 0, pins[1] - pins[0], pins[2] - pins[0])
    return pins, np.exp(1j * np.angle(rail))


def random_linkages(rng, count, places, driver):
    """Four-bars of random lengths at random places of both branches: pins and pivots."""
    # Shares of what the longest may be: all four types and near ones are met.
    sizes = rng.uniform(0.2, 1, (4, count))
    ground, crank, bar, reach = sizes
    pivots = np.zeros(count, dtype=complex), ground + 0j
    q = rng.uniform(-np.pi, np.pi, (40, count))
    one, other, gap = circles(crank * np.exp(1j * q), pivots[1], reach, bar)
    # Of the closed ones the first few; of each, any branch, or one for all in half of the linkages.
    order = np.argsort(gap < 0, axis=0, kind="stable")[:places]
    keep = np.take_along_axis(gap > 0, order, axis=0).all(axis=0)
    side = np.where(rng.random(count) < 0.6, rng.random((1, count)) < 0.5, rng.random((places, count)) < 0.5)
    pick = partial(np.take_along_axis, indices=order, axis=0)
    first, second = crank * np.exp(1j * pick(q)), np.where(side, pick(one), pick(other))
    if driver == "rocker":
        first, second = ground - np.conj(second), ground - np.conj(first)
    return first[:, keep], second[:, keep], (pivots[0][keep], pivots[1][keep])

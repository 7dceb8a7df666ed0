"""Screws, nuts and spacers: looked at as discs between their heights, at frames of their own, and counted on a bill."""

import re
from itertools import combinations

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import DesignError
from geomkin.core.units import Sentence
from geomkin.linkage.parts.plates import assemble
from geomkin.linkage.parts.stack import stack_links
from geomkin.linkage.parts.stock import LinkStock
from geomkin.making.fasteners import SIZES, Fastener, fastener_of
from geomkin.making.motors import MOTOR_FACES
from tests.linkage.mechanisms import BUILDABLE, TURN

STOCK = LinkStock()


def discs(motion, stack, stock):
    """Of each pin: where it is at each frame, and what is round it: radius, and heights from below, mm."""
    pins = {pin.name: pin for pin in assemble(motion, stock).pins}
    ground, t = motion.bodies[motion.linkage.ground], stock.thickness
    for span in stack.pins:
        if span.name in pins:
            pin = pins[span.name]
            place = motion.bodies[pin.body].point(pin.place).position
        else:
            place = ground.point(stack.plates[motion.linkage.ground].openings[span.name][0]).position
        head, nut = stock.fastener_used.ends((span.last - span.first + 1) * t)
        below, above = (nut, head) if span.first == 0 else (head, nut)
        wide = stock.fastener_used.across / 2
        low, high = span.first * t, (span.last + 1) * t
        solids = [(wide, low - below, low), (wide, high, high + above)]
        solids += [(stock.bar_width / 2, layer * t, (layer + 1) * t) for layer in span.spacers]
        if span.motor:
            # A motor's shaft has no head, and stands bare between its plates.
            bare = set(range(span.first, span.last)) - {stack.layers[name] for name in span.holes}
            solids = [(MOTOR_FACES[stock.motor].shaft / 2, layer * t, (layer + 1) * t) for layer in bare]
        yield span.name, np.broadcast_to(place, motion.drive.shape), solids


def hits(motion, stack, stock):
    """Every head, nut or spacer that meets a plate or another pin's, looked at frame by frame."""
    found, all_discs, t = set(), list(discs(motion, stack, stock)), stock.thickness
    for name, place, solids in all_discs:
        for plate, layer in stack.layers.items():
            body = motion.bodies[stack.plates[plate].body]
            seen = (place - body.origin.position) * np.conj(body.direction)
            edge = gk.flatten(gk.plane.rounded_hull(stack.plates[plate].centres, stock.bar_width / 2), 0.02)
            near = distances(seen[motion.assembled], edge)
            for radius, low, high in solids:
                if low < (layer + 1) * t - 1e-6 and high > layer * t + 1e-6 and (near < radius).any():
                    found.add((name, plate))
    for (one, a, these), (two, b, those) in combinations(all_discs, 2):
        apart = abs(a - b)[motion.assembled].min()
        for r, low, high in these:
            if any(low < up - 1e-6 and high > down + 1e-6 and apart < r + s for s, down, up in those):
                found.add((one, two))
    return found


def distances(points, ring):
    """From points to a convex polygon, 0 within."""
    a, b = ring[:, None], np.roll(ring, -1)[:, None]
    share = np.clip(((points - a) * np.conj(b - a)).real / abs(b - a) ** 2, 0, 1)
    apart = abs(points - a - share * (b - a)).min(axis=0)
    turned = ((points - a) * np.conj(b - a)).imag * np.sign((ring * np.conj(np.roll(ring, -1))).imag.sum())
    return np.where((turned <= 0).all(axis=0), 0.0, apart)


@pytest.mark.parametrize("name", list(BUILDABLE)[::3])
def test_no_head_meets_anything(name):
    linkage, branch, *_ = BUILDABLE[name]
    motion = gk.move(linkage, TURN, branch)
    stack = stack_links(motion, STOCK)
    looked = gk.move(linkage, np.linspace(0, 2 * np.pi, 541), branch)
    assert bool(hits(looked, stack, STOCK)) == bool(stack.collisions)


def test_screws_hold_plates_spacers_and_nut():
    for diameter, size in SIZES.items():
        held = Fastener(diameter, "screw", 0.2)
        for grip in np.arange(2.0, 30.0, 0.7):
            length = held.length(grip)
            if length is None:
                continue
            assert length in size.series.lengths and size.lengths[0] <= length <= size.lengths[1]
            head, nut = held.ends(grip)
            # What is under the head: the plates, and what stands out of them with the nut on it.
            assert grip + nut == pytest.approx(length) and nut >= size.washer[1] + size.nut_height + size.pitch
            assert head > size.head[1]
            assert sum(count for _, count in held.bill(grip)) == 3


@pytest.mark.parametrize("play", [0.0, 1.0])
def test_a_threaded_rod_stands_out_at_either_end_by_all_the_play(play):
    held = Fastener(4.0, "screw", play)
    ((name, _), *_), (below, above) = held.bill(45.0), held.ends(45.0)
    cut = float(re.search(r"cut to (\S+) mm", Sentence(name))[1])
    # What stands out at one end while the plates lie against the other.
    assert below == above and below + above - play == pytest.approx(cut - 45.0)


def test_what_is_no_screw_is_a_rod_or_refused():
    ((name, count),) = fastener_of(4.1, 3.0, None, 0.2, None).bill(9.0)
    assert (Sentence(name), count) == ("rod 4.1 mm, cut to 9.2 mm", 1)
    assert fastener_of(4.0, 3.0, "rod", 0.2, None).ends(9.0) == (0.0, 0.0)
    with pytest.raises(DesignError, match="fastener:"):
        LinkStock(pin_diameter=4.1, fastener="screw")

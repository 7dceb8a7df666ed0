"""Stacks of plates: the finished plates are laid on each other as polygons at every frame and looked at."""

from itertools import combinations, product

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import geomkin as gk
from geomkin.linkage.parts.collisions import PointPaths
from geomkin.linkage.parts.layers import Meetings, Passing, order, runs
from geomkin.linkage.parts.plates import assemble
from geomkin.linkage.parts.stack import link_parts, stack_links
from geomkin.linkage.parts.stock import LinkStock
from tests.campaign import by_default
from tests.linkage.mechanisms import BUILDABLE, CROWDED, TURN

STOCK = LinkStock(fastener="rod")
LOOK = np.linspace(0, 2 * np.pi, 181)


class Model:
    """Finished parts and pins as shapely shapes in the fixed frame, at frames of its own."""

    def __init__(self, linkage, branch, stack, parts, stock, drive):
        self.motion = gk.move(linkage, drive, branch)
        self.stack, self.stock = stack, stock
        self.pins = {pin.name: pin for pin in assemble(self.motion, stock).pins}
        self.plates = {
            p.name: self.placed(stack.plates[p.name].body, self.solid(p)) for p in parts if p.name in stack.plates
        }

    @staticmethod
    def solid(part):
        loops = [gk.plane.xy(gk.flatten(curve, 0.01)) for curve in (part.outline, *part.holes)]
        return shapely.Polygon(loops[0], loops[1:])

    def placed(self, body, shape):
        body = self.motion.bodies[body]

        def at(origin, direction):
            return shapely.transform(shape, lambda p: gk.plane.xy(origin + direction * (p[:, 0] + 1j * p[:, 1])))

        return np.array([at(*pose) for pose in zip(body.origin.position, body.direction)])

    def discs(self, name, radius):
        if name in self.pins:
            pin = self.pins[name]
            z = self.motion.bodies[pin.body].point(pin.place).position
        else:
            ground = self.motion.linkage.ground
            place = self.stack.plates[ground].openings[name][0]
            z = self.motion.bodies[ground].point(place).position + np.zeros(len(self.motion.drive))
        return shapely.buffer(shapely.points(gk.plane.xy(z)), radius, quad_segs=32)

    def troubles(self, layers=None):
        """Every pair that overlaps, with the frames at which it does."""
        layers, found = layers or self.stack.layers, {}
        for one, two in combinations(self.plates, 2):
            if layers[one] == layers[two]:
                found[one, two] = shapely.intersects(self.plates[one], self.plates[two])
        spans = {}
        for pin in self.stack.pins:
            at = [layers[name] for name in pin.holes + pin.slots]
            spans[pin.name] = min(at), max(at)
            discs = self.discs(pin.name, self.stock.pin_diameter / 2)
            # A plate that it joins has an opening for it; any other must not be there. Plates are solid but there.
            for name, shapes in self.plates.items():
                if spans[pin.name][0] <= layers[name] <= spans[pin.name][1]:
                    found[pin.name, name] = shapely.intersects(discs, shapes)
            spacers = self.discs(pin.name, self.stock.bar_width / 2)
            for name, shapes in self.plates.items():
                if layers is self.stack.layers and layers[name] in pin.spacers:
                    found[f"spacer of {pin.name}", name] = shapely.intersects(spacers, shapes)
        for one, two in combinations(spans, 2):
            if spans[one][0] <= spans[two][1] and spans[two][0] <= spans[one][1]:
                a, b = (self.discs(name, self.stock.pin_diameter / 2) for name in (one, two))
                found[one, two] = shapely.intersects(a, b)
        for one, two in combinations(self.stack.pins, 2):
            if layers is self.stack.layers and set(one.spacers) & set(two.spacers):
                a, b = (self.discs(pin.name, self.stock.bar_width / 2) for pin in (one, two))
                found[f"spacer of {one.name}", two.name] = shapely.intersects(a, b)
        return {pair: hit for pair, hit in found.items() if hit.any()}


def built(linkage, branch, drive=TURN, stock=STOCK, look=LOOK):
    motion = gk.move(linkage, drive, branch)
    stack = stack_links(motion, stock)
    return stack, Model(linkage, branch, stack, link_parts(motion, stock, stack), stock, look)


@pytest.mark.parametrize("name", by_default(list(BUILDABLE)[::2], slice(0, None, 2)))
def test_no_plate_meets_another_and_no_pin_a_plate_it_does_not_join(name):
    linkage, branch, layers, bridge = BUILDABLE[name]
    stack, model = built(linkage, branch)
    assert stack.collisions == ()
    assert model.motion.assembled.all()
    assert model.troubles() == {}
    assert 1 + max(stack.layers.values()) == layers
    assert ("bridge" in stack.layers) == bridge == any(pin.name == "spacer_1" for pin in stack.pins)
    assert (stack.layers["ground"] == 0 and not bridge) or stack.layers["bridge"] == layers - 1


@pytest.mark.parametrize("name", ["drag link", "oldham coupling"])
def test_discs_of_a_pile_fill_the_room_between_ground_and_bridge(name, thickness=5.0):
    """Its pin is as long as ground, discs and bridge together, and so is any pin from the lowest to the top layer."""
    linkage, branch, layers, _ = BUILDABLE[name]
    stock = LinkStock(thickness=thickness, fastener="rod")
    motion = gk.move(linkage, TURN, branch)
    stack = stack_links(motion, stock)
    parts = {part.name: part for part in link_parts(motion, stock, stack)}
    pins = {pin.name: pin for pin in stack.pins}
    for pile in ("spacer_1", "spacer_2"):
        height = sum(parts[name].thickness for name in ("ground", "bridge"))
        height += parts["spacer"].count / 2 * parts["spacer"].thickness
        assert pins[pile].length == pytest.approx(height) == pytest.approx(layers * thickness)
    for pin in stack.pins:
        assert pin.length == pytest.approx(thickness * len(range(pin.first, pin.last + 1)))


def test_collisions_name_the_pair_and_its_driver_range():
    linkage, branch = CROWDED, {"slide": -1, "ram_pin": 1}
    stack, model = built(linkage, branch)
    assert stack.collisions
    troubles = model.troubles()
    reported = {(c.pin, c.plate) for c in stack.collisions}
    assert reported == set(troubles)
    degrees = np.degrees(model.motion.drive)
    for pair, hit in troubles.items():
        runs = [(c.first, c.last) for c in stack.collisions if (c.pin, c.plate) == pair]
        inside = np.any([(a <= degrees) & (degrees <= b) for a, b in runs], axis=0)
        assert not (hit & ~inside).any()
        # Told a little wider than seen, for the play.
        assert inside.sum() <= hit.sum() + 24


@pytest.mark.parametrize("step_deg", [1.0, 15.0])
def test_collisions_between_frames_are_found(step_deg):
    """Thin bars that pass a pin between two frames: at no frame itself is the crank near the pivot."""
    thin = LinkStock(bar_width=0.6, pin_diameter=0.3, clearance=0)
    drive = np.radians(np.arange(step_deg / 2, 360 + step_deg, step_deg))
    linkage = gk.FourBar(100, 130, 150, 140)
    motion = gk.move(linkage, drive)
    crank = shapely.linestrings(
        np.stack([gk.plane.xy(0 * motion.drive + 0j), gk.plane.xy(130 * np.exp(1j * drive))], axis=1)
    )
    assert shapely.distance(crank, shapely.Point(100, 0)).min() > 0.45
    pair = Meetings(motion, thin, assemble(motion, thin)).pin_and_plate["rocker_pivot", "crank"]
    assert any(np.isclose(np.degrees(b), 360 + step_deg / 2) for _, b in runs(motion, pair))


@pytest.mark.parametrize("step_deg", [10.0])
def test_the_gap_between_frames_is_never_reported_larger_than_it_is(step_deg):
    linkage, branch, _, _ = BUILDABLE["jansen leg"]
    # Of small steps a quarter of a turn.
    turn = 360 if step_deg > 1 else 90
    coarse = gk.move(linkage, np.radians(np.arange(0, turn + step_deg, step_deg)), branch)
    share = np.linspace(0, 1, 11)
    found = assemble(coarse, STOCK)
    fine = gk.move(linkage, (coarse.drive[:-1, None] + share * np.diff(coarse.drive)[:, None]).ravel(), branch)
    for one, two in combinations(found.plates, 2):
        a, b = found.plates[one], found.plates[two]

        def seen(motion, a=a, b=b):
            here = motion.bodies[a.body], motion.bodies[b.body]
            world = here[1].origin.position[:, None] + here[1].direction[:, None] * b.centres
            return (world - here[0].origin.position[:, None]) * np.conj(here[0].direction[:, None])

        reported = PointPaths(coarse.drive, seen(coarse)).gap(a.centres)[:-1]
        hull = shapely.MultiPoint(gk.plane.xy(a.centres)).convex_hull
        hulls = [shapely.MultiPoint(gk.plane.xy(z)).convex_hull for z in seen(fine)]
        true = shapely.distance(hull, hulls).reshape(len(reported), -1).min(axis=1)
        assert np.all(np.maximum(reported, 0) <= true + 1e-9)
        # Nor much smaller, or plates would be kept apart that need not be: a bar that turns about its middle
        # by a step has a hull as wide as its ends travel.
        assert np.all(true - np.maximum(reported, 0) < 0.3 * 100 * np.radians(step_deg))


def puzzle(seed, crossings):
    """Four plates and four pins at random, with the pins that pins cross, and what always follows.

    A pin that crosses another hits its plates, which surround it; a pin's plate meets all that the pin hits.
    """
    random = np.random.default_rng(seed)
    plates, pins = range(4), []
    for number in range(4):
        fixed = random.random() < 0.5
        joins = {int(random.integers(4))} | (set() if fixed else {int(random.integers(4))})
        hits = {k for k in plates if random.random() < 0.4} - joins
        crosses = {k for k in range(number) if crossings and random.random() < 0.3 and not joins & pins[k][0]}
        pins.append((joins, hits, crosses, fixed and number % 2 == 0, fixed and number % 2 == 1))
    for joins, hits, crosses, _, _ in pins:
        for other in crosses:
            hits |= pins[other][0]
            pins[other][1].update(joins)
    meets = [set() for _ in plates]
    pairs = [(k, q) for k, q in combinations(plates, 2) if random.random() < 0.3]
    for k, q in pairs + [(k, q) for joins, hits, *_ in pins for k in joins for q in hits | joins if k != q]:
        meets[k].add(q)
        meets[q].add(k)

    def bits(some):
        return sum(1 << k for k in some)

    return (
        [bits(m) for m in meets],
        [Passing(bits(joins), bottom, top, bits(hits)) for joins, hits, _, bottom, top in pins],
        [crosses for _, _, crosses, _, _ in pins],
    )


@pytest.mark.parametrize("crossings", by_default([False, True], [True]))
@given(seed=st.integers(0, 10**9))
def test_the_order_is_the_best_of_all_orders(crossings, seed):
    """Small puzzles against every way to fill the layers."""
    meets, pins, crosses = puzzle(seed, crossings)
    count = len(meets)

    def design_checks(rows):
        """Collisions, layers and pin length of an assignment; None where plates that meet share a layer."""
        top = max(rows) + 1
        if set(rows) != set(range(1, top)):
            return None
        if any(meets[i] >> j & 1 and rows[i] == rows[j] for i, j in combinations(range(count), 2)):
            return None
        collisions, spans = 0, []
        for pin in pins:
            at = [rows[k] for k in range(count) if pin.joins >> k & 1] + [0] * pin.bottom + [top] * pin.top
            spans.append(range(min(at), max(at) + 1))
            collisions += sum(pin.hits >> k & 1 and rows[k] in spans[-1] for k in range(count))
        for number, others in enumerate(crosses):
            collisions += sum(bool(set(spans[number]) & set(spans[other])) for other in others)
        # Up to the last plate: from there to the top it is the same for all.
        length = sum(min(s[-1], top - 1) - s[0] for s in spans)
        return collisions, top - 1, length

    every = [j for rows in product(range(1, count + 1), repeat=count) if (j := design_checks(rows))]
    clean, least = order(meets, pins), order(meets, pins, clean=False)
    best = min(every)
    assert (clean is None) == (best[0] > 0) == (least.collisions > 0)
    for found in (clean, least):
        # The search knows of crossing pins only by the plates they hit, and so counts them otherwise.
        if found and (not crossings or best[0] == 0):
            assert (found.collisions, len(found.layers), found.length) == best


def test_more_plates_than_the_search_takes_are_refused():
    """One crank that drives a star of eight rockers."""
    star = {"ground": {"crank_pivot": 0j}, "crank": {"crank_pivot": 0j, "crank_pin": 30 + 0j}}
    for k in range(8):
        star["ground"][f"pivot_{k}"] = 100 * np.exp(0.25j * np.pi * k)
        star[f"coupler_{k}"] = {"crank_pin": 0j, f"pin_{k}": 90 + 0j}
        star[f"rocker_{k}"] = {f"pivot_{k}": 0j, f"pin_{k}": 70 + 0j}
    motion = gk.move(gk.Linkage(star, driver="crank"), TURN)
    assert motion.assembled.all()
    with pytest.raises(gk.DesignError, match="17"):
        stack_links(motion, STOCK)
    assert len(link_parts(motion, STOCK)) == 18

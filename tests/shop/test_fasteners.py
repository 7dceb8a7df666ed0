"""Screws, nuts and spacers: looked at as discs between their heights, at frames of their own, and counted on a bill."""

import contextlib
import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import DesignError
from geomkin.linkage.parts import stack
from geomkin.linkage.parts.layers import placed
from geomkin.linkage.parts.plates import assemble
from geomkin.linkage.parts.stack import link_parts, stack_links
from geomkin.linkage.parts.stock import LinkStock
from geomkin.making.fasteners import LENGTHS, SIZES, Fastener, fastener_of
from geomkin.making.motors import MOTORS

from .mechanisms import BUILDABLE, TURN

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
            solids = [(MOTORS[stock.motor].shaft / 2, layer * t, (layer + 1) * t) for layer in bare]
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


@pytest.mark.parametrize("name", BUILDABLE)
def test_no_head_meets_anything(name):
    linkage, branch, *_ = BUILDABLE[name]
    motion = gk.move(linkage, TURN, branch)
    stack = stack_links(motion, STOCK)
    looked = gk.move(linkage, np.linspace(0, 2 * np.pi, 541), branch)
    assert bool(hits(looked, stack, STOCK)) == bool(stack.collisions)


@pytest.mark.parametrize("stock", [STOCK, LinkStock(thickness=8, motor="nema17")], ids=["screws", "motor"])
def test_layers_hold_the_heads_that_reach_into_them(monkeypatch, stock):
    """By places looked at in each layer, of every joint but one that stands out by a hair alone.

    A motor's shaft ends with its plates.
    """
    made, real = [], stack.Heads
    monkeypatch.setattr(stack, "Heads", lambda *given: made.append(real(*given)) or made[-1])
    for linkage, branch, *_ in list(BUILDABLE.values())[:6]:
        with contextlib.suppress(DesignError):  # some have no crank for a motor
            stack_links(gk.move(linkage, TURN, branch), stock)
    seen, shares = set(), np.linspace(0.01, 0.99, 99)
    for heads in made:
        places = placed(heads.gaps())
        for layer in range(-2, places[-1] + 4):
            reaching = set()
            for reach in heads.reaches:
                low, high = places[reach.first], places[reach.last] + 1
                head, nut = (end / stock.thickness for end in stock.fastener_used.ends((high - low) * stock.thickness))
                below, above = (nut, head) if reach.first == 0 else (head, nut)
                if reach.pin.shaft:
                    seen.add("shaft")
                    below = above = 0
                for side, start, end in (("below", low - below, low), ("above", high, high + above)):
                    if ((start < layer + shares) & (layer + shares < end)).any():
                        reaching.add(reach.pin.name)
                        seen.add(side)
            assert {pin.name for pin in heads._heads_in(places, layer)} == reaching
    assert seen == {"below", "above"} | ({"shaft"} if stock.motor else set())


def test_the_look_would_see_a_head():
    """The same without the empty layers: the crank's pin hits the ground."""
    motion = gk.move(gk.FourBar(ground=100, crank=30, coupler=90, rocker=70), TURN)
    assert hits(motion, stack_links(motion, LinkStock(fastener="rod")), STOCK)


@pytest.mark.campaign
@pytest.mark.parametrize("path", sorted(Path("recipes").glob("*.toml")), ids=lambda path: path.stem)
def test_no_head_of_the_gallery_meets_anything_in_quarter_degrees(path):
    recipe = gk.load(path)
    recipe = recipe if hasattr(recipe, "stack") else recipe.design
    if not hasattr(recipe, "stack") or recipe.stack.collisions:
        pytest.skip("no plates that lie on each other, or such as collide and say so")
    way = recipe.way if hasattr(recipe, "way") else recipe.drive
    frames = way.frames
    fine = np.linspace(frames[0], frames[-1], 1441)
    motion = gk.move(recipe.linkage, fine, recipe.branch)
    assert not hits(motion, recipe.stack, recipe.stock)


def test_screws_hold_plates_spacers_and_nut():
    for diameter, size in SIZES.items():
        held = Fastener(diameter, "screw", 0.2)
        for grip in np.arange(2.0, 30.0, 0.7):
            length = held.length(grip)
            if length is None:
                continue
            assert length in LENGTHS and size.lengths[0] <= length <= size.lengths[1]
            head, nut = held.ends(grip)
            # What is under the head: the plates, and what stands out of them with the nut on it.
            assert grip + nut == pytest.approx(length) and nut >= size.washer[1] + size.nut_height + size.pitch
            assert head > size.head[1]
            assert sum(count for _, count in held.bill(grip)) == 3


def test_a_grip_longer_than_any_screw_takes_a_threaded_rod():
    names = [name for name, _ in Fastener(4.0, "screw", 0.2).bill(45.0)]
    assert names[0] == "M4 threaded rod DIN 976-1, cut to 60.2 mm" and len(names) == 3


@pytest.mark.parametrize("play", [0.0, 0.2, 1.0])
def test_a_threaded_rod_stands_out_at_either_end_by_all_the_play(play):
    held = Fastener(4.0, "screw", play)
    ((name, _), *_), (below, above) = held.bill(45.0), held.ends(45.0)
    cut = float(re.search(r"cut to (\S+) mm", name)[1])
    # What stands out at one end while the plates lie against the other.
    assert below == above and below + above - play == pytest.approx(cut - 45.0)


def test_what_is_no_screw_is_a_rod_or_refused():
    assert fastener_of(4.1, 3.0, None, 0.2, None).bill(9.0) == (("rod 4.1 mm, cut to 9.2 mm", 1),)
    assert fastener_of(4.0, 3.0, "rod", 0.2, None).ends(9.0) == (0.0, 0.0)
    with pytest.raises(
        DesignError, match="fastener: found a screw, but no screw is 4.1 mm thick; give pin_diameter as"
    ):
        LinkStock(pin_diameter=4.1, fastener="screw")


def test_sheets_so_thin_that_a_nut_is_a_pile_of_them_have_rods():
    assert (
        LinkStock(thickness=0.4).fastener_used.form == "rod" and LinkStock(thickness=0.8).fastener_used.form == "screw"
    )
    with pytest.raises(DesignError, match="fastener: found a screw, whose nut is as high as .* sheets"):
        LinkStock(thickness=0.1, fastener="screw")


def test_the_bill_and_the_steps_name_every_joint():
    recipe = gk.load("recipes/coupler-driven.toml")
    stack = recipe.stack
    joints = {stack.letters[pin.name] for pin in stack.pins}
    assert joints == set("ABCD")
    screws = [line for line in stack.bought if "screw" in line.name or "rod" in line.name]
    assert {joint for line in screws for joint in line.joints} == joints
    assert sum(line.count for line in screws) == len(joints)
    told = "; ".join(stack.steps)
    assert all(told.count(plate) >= 1 for plate in stack.layers) and told.count("close") >= 1
    (spacer,) = [part for part in link_parts(recipe.fine_motion, recipe.stock, stack) if part.name == "spacer"]
    assert spacer.count == stack.spacers == sum(len(pin.spacers) for pin in stack.pins) > 0


def test_a_lower_head_leaves_fewer_layers_empty():
    motion = gk.move(gk.FourBar(ground=100, crank=30, coupler=90, rocker=70), TURN)
    heights = [max(stack_links(motion, LinkStock(head_height=h)).layers.values()) for h in (0.5, 2.2, 5.0)]
    rods = stack_links(motion, LinkStock(fastener="rod"))
    assert max(rods.layers.values()) < heights[0] == heights[1] < heights[2]
    assert rods.spacers == 0


def told_steps(stack):
    """{how: {letter or plate: layers in which a step says so}} of a stack's steps."""
    words = {
        r"put (.+) through from below": "below",
        r"lay (.+)": "laid",
        r"a spacer on (.+)": "spacer",
        r"nothing on (.+), which a plate here passes": "nothing",
        r"close (.+)": "closed",
        r"put (.+) through from above, nuts below": "above",
    }
    found = {how: {} for how in words.values()} | {"motor": []}
    for layer, step in enumerate(stack.steps):
        head, told = step.split(": ", 1)
        assert head == f"layer {layer}"
        for clause in told.split("; "):
            match = next((m for pattern in words if (m := re.fullmatch(pattern, clause))), None)
            if match is None:
                found["motor"].append((layer, clause))
                continue
            for name in match[1].split(", "):
                found[words[match.re.pattern]].setdefault(name, []).append(layer)
    return found


@pytest.mark.parametrize("name", BUILDABLE)
@pytest.mark.parametrize("stock", [STOCK, LinkStock(fastener="rod"), LinkStock(thickness=8, motor="nema17")])
def test_steps_put_every_pin_through_once_and_tell_every_layer_it_crosses(name, stock):
    """Screws that start in the ground come from above, where there are any so long; all else from below."""
    linkage, branch, *_ = BUILDABLE[name]
    motion = gk.move(linkage, TURN[::3], branch)
    try:
        stack = stack_links(motion, stock)
    except DesignError as error:
        assert error.field == "stock.motor"
        return
    told = told_steps(stack)
    assert {n: [layer] for n, layer in stack.layers.items()} == told["laid"]
    rows = stack.summary()["layers"]
    assert len(rows) == len(stack.steps) and all(n in rows[layer] for n, layer in stack.layers.items())
    for pin in stack.pins:
        letter, crossed = stack.letters[pin.name], {stack.layers[n] for n in pin.holes + pin.slots}
        rows = {how: told[how].get(letter, []) for how in ("below", "closed", "above", "spacer", "nothing")}
        assert rows["spacer"] == list(pin.spacers)
        if pin.motor:
            assert not any(rows.values())
            high = (pin.last - 1) * stock.thickness
            above = f", {high:g} mm above ground" if high else ""
            assert [(layer, clause) for layer, clause in told["motor"] if layer] == [
                (pin.last, f"fix {linkage.driver} on the motor's shaft {letter}, flat on flat{above}")
            ]
            continue
        assert rows["nothing"] == sorted(set(range(pin.first, pin.last)) - crossed - set(pin.spacers))
        bought = " ".join(name for name, _ in stack.bill(pin))
        if pin.first == 0 and "screw" in bought and "rod" not in bought:
            assert rows["above"] == [pin.last] and rows["below"] == rows["closed"] == []
        else:
            assert (rows["below"], rows["closed"], rows["above"]) == ([pin.first], [pin.last], [])

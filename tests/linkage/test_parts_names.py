"""A person's own names for bodies and points change nothing of what is cut, also where the shop uses the same ones."""

import numpy as np
import pytest

import geomkin as gk

# Drawn over with a bridge on two piles, and a plate that slides on two guide pins.
DRAG_LINK = {
    "bodies": {
        "ground": {"O": 0j, "C": 30 + 0j},
        "crank": {"O": 0j, "A": 100 + 0j},
        "coupler": {"A": 0j, "B": 90 + 0j},
        "rocker": {"C": 0j, "B": 70 + 0j},
    },
    "sliders": (),
}
RAM = {
    "bodies": {
        "ground": {"O": 0j},
        "crank": {"O": 0j, "A": 30 + 0j},
        "rod": {"A": 0j, "B": 90 + 0j},
        "ram": {"B": 0j, "tool": 40 + 15j},
    },
    "sliders": (("slide", "ram", "ground"),),
}


def made(sizes, called):
    bodies = {
        called.get(body, body): {called.get(point, point): place for point, place in points.items()}
        for body, points in sizes["bodies"].items()
    }
    sliders = tuple(gk.Slider(*(called.get(name, name) for name in names)) for names in sizes["sliders"])
    linkage = gk.Linkage(bodies, called.get("crank", "crank"), sliders)
    motion = gk.move(linkage, np.linspace(0, 2 * np.pi, 181))
    stack = gk.linkage.stack_links(motion, gk.linkage.LinkStock())
    return stack, gk.linkage.link_parts(motion, gk.linkage.LinkStock(), stack)


def cut(part):
    return [curve.point(np.linspace(*curve.breaks[[0, -1]], 40)) for curve in (part.outline, *part.holes)]


@pytest.mark.parametrize(
    ("sizes", "called"),
    [
        (DRAG_LINK, {"crank": "bridge", "coupler": "bridge_"}),
        (DRAG_LINK, {"coupler": "spacer", "rocker": "spacer_"}),
        (DRAG_LINK, {"A": "spacer_2", "B": "spacer_1", "C": "spacer_1_"}),
        (RAM, {"tool": "slide_guide_2", "B": "slide_guide_1"}),
        (RAM, {"rod": "spacer", "O": "slide_guide_1"}),
    ],
)
def test_what_a_person_calls_it_changes_nothing_of_what_is_cut(sizes, called):
    (plain, wanted), (stack, parts) = made(sizes, {}), made(sizes, called)
    assert len({part.name for part in parts}) == len(parts) == len(wanted) and not stack.collisions
    for part, own in zip(parts, wanted, strict=True):
        assert part.name.startswith(called.get(own.name, own.name)) and part.count == own.count
        assert part.hole_names == own.hole_names
        for one, other in zip(cut(part), cut(own), strict=True):
            assert one == pytest.approx(other, abs=1e-9)
    assert len({pin.name for pin in stack.pins}) == len(stack.pins) and stack.bought == plain.bought
    spans = [[(pin.first, pin.last, pin.spacers) for pin in each.pins] for each in (stack, plain)]
    assert spans[0] == spans[1] and list(stack.layers.values()) == list(plain.layers.values())


def test_a_pin_that_turns_in_no_plate_runs_in_the_slots_of_two():
    """Two blocks on one pin: it slides in a lever that turns, and along the ground 50 mm over the lever's pivot."""
    bodies = {"ground": {"O": 0j}, "lever": {"O": 0j, "tip": 70 + 0j}, "one": {"P": 0j}, "two": {"P": 0j}}
    sliders = (gk.Slider("in_lever", "one", "lever"), gk.Slider("in_ground", "two", "ground", through=50j))
    motion = gk.move(gk.Linkage(bodies, "lever", sliders), np.radians(np.linspace(60, 120, 61)))
    stack = gk.linkage.stack_links(motion, gk.linkage.LinkStock())
    (pin,) = (pin for pin in stack.pins if pin.slots)
    assert (pin.holes, set(pin.slots)) == ((), {"lever", "ground"}) and not stack.collisions
    ground, lever = gk.linkage.link_parts(motion, gk.linkage.LinkStock(), stack)[:2]
    wide = [np.ptp(gk.flatten(hole, 1e-4).real) for part in (ground, lever) for hole in part.holes]
    # Along the ground by twice 50 / tan(60 deg), along the lever from 50 mm to 50 / sin(60 deg).
    assert max(wide[: len(ground.holes)]) == pytest.approx(100 / np.sqrt(3) + 4.2, abs=0.05)
    assert max(wide[len(ground.holes) :]) == pytest.approx(50 * (2 / np.sqrt(3) - 1) + 4.2, abs=0.05)

"""Two bodies that slide on each other, where the pins that hold them meet: the direction is unknown there."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from tests.linkage.examples import lift_table


def scaled(linkage, size):
    bodies = {body: {p: size * z for p, z in points.items()} for body, points in linkage.bodies.items()}
    return dataclasses.replace(linkage, bodies=bodies)


@pytest.mark.parametrize(("size", "origin"), [(1e-7, 0), (1.0, 3 - 2j)])
def test_a_lift_table_that_folds_onto_itself_is_open(size, origin):
    """With its arms on each other both pins of the table are one, and its direction is anything."""
    table = dataclasses.replace(scaled(lift_table(), size), driver="arm", origin=origin * size)
    folded = gk.move(table, np.linspace(1.6, 3, 500))
    assert not folded.assembled.any() and np.isnan(folded.table.direction.real).all()
    assert set(folded.branches["ceiling"]) == {0}
    # Just beyond upright the shoe's place is at its least certain.
    beyond = gk.move(
        table, np.pi / 2 + np.concatenate([np.geomspace(1e-15, 1e-1, 2000), -np.geomspace(1e-15, 1e-12, 50)])
    )
    assert not beyond.assembled.any()
    upright = gk.move(table, np.append(np.linspace(0.1, 1.57, 50), np.pi / 2 - 1e-6))
    assert upright.assembled.all() and upright.table.direction == pytest.approx(np.ones(51), abs=1e-8)


@pytest.mark.parametrize("size", [1e-7])
@pytest.mark.parametrize("side", [1, -1])
def test_nearly_coincident_pins_keep_the_remaining_digits(size, side):
    """A lever through its crank's circle: by the angle at the circumference it leans by half the crank's angle."""
    lever = gk.InvertedSliderCrank(30 * size, 30 * size)
    near = side * 10.0 ** -np.arange(0, 14)
    motion = gk.move(lever, near)
    error = np.abs(np.imag(motion.rocker.direction * np.conj(1j * np.exp(0.5j * near))))
    assert motion.assembled.all() and np.all(error < 1e-15 / np.abs(near))
    assert not gk.move(lever, [0.0, side * 1e-15, side * 1e-16]).assembled.any()


def test_places_far_out_round_as_they_are_large():
    """Two trolleys a rod apart: a lever on the first slides through a pin of the second, which is its own pin."""
    linkage = gk.Linkage(
        {
            "ground": {},
            "first": {"A": 0, "C": 7 + 30.3},
            "rod": {"A": 0, "B": 30.3},
            "second": {"B": -7, "D": 0},
            "lever": {"C": 0},
            "stone": {"D": 0},
        },
        "first",
        (
            gk.Slider("way", "first", "ground", direction_deg=20),
            gk.Slider("same way", "second", "ground", direction_deg=20),
            gk.Slider("slot", "stone", "lever"),
        ),
    )
    assert not gk.move(linkage, np.random.default_rng(1).uniform(-1e7, 1e7, 200)).assembled.any()


def test_lever_on_a_moving_carrier_is_placed_unless_its_pins_meet():
    """A slotted lever behind a crank-rocker at all angles: where its pins are apart by a billionth it has a direction."""
    bodies = {
        "ground": {"O": 0, "C": 100, "E": 0},
        "crank": {"O": 0, "A": 30},
        "coupler": {"A": 0, "B": 90},
        "rocker": {"C": 0, "B": 70, "R": 40j},
        "stone": {"R": 0},
        "lever": {"E": 0},
    }
    drive = np.linspace(0.3, 6, 20)
    pins = gk.move(
        gk.Linkage({name: bodies[name] for name in ("ground", "crank", "coupler", "rocker")}, "crank"), drive
    )
    place = complex(pins.point("R").position[7])
    for apart in (1e-6, 1e-8, 1e-10):
        bodies["ground"]["E"] = place - apart
        motion = gk.move(gk.Linkage(bodies, "crank", (gk.Slider("slot", "stone", "lever"),)), drive)
        assert motion.assembled.all()
        assert abs(motion.lever.direction[7].imag) < 1e-13 / apart
    bodies["ground"]["E"] = place
    assert not gk.move(gk.Linkage(bodies, "crank", (gk.Slider("slot", "stone", "lever"),)), drive).assembled[7]

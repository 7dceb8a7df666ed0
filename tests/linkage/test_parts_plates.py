"""Plates of linkages: what is cut and what is a pin, and slots in which the pins really run."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.linkage.parts.plates import assemble
from geomkin.linkage.parts.stack import link_parts
from geomkin.linkage.parts.stock import LinkStock
from tests.linkage.mechanisms import (
    BUILDABLE,
    OLDHAM,
    RAM_BESIDE_ITS_LINE,
    RAM_WITH_TOOL,
    TURN,
    scotch_yoke,
    sliding_coupler,
    slotted_lever,
)

STOCK = LinkStock()


def parts_of(linkage, branch=1, drive=TURN, stock=STOCK):
    return {part.name: part for part in link_parts(gk.move(linkage, drive, branch), stock)}


def polygon(curve):
    return shapely.Polygon(gk.plane.xy(gk.flatten(curve, 1e-4)))


def test_a_point_on_a_pin_is_one_hole_and_one_beside_it_is_refused():
    on = parts_of(gk.FourBar(100, 30, 90, 70, 0j))["coupler"]
    assert [hole.centre for hole in on.holes] == [0, 90]
    with pytest.raises(gk.DesignError, match="apart") as caught:
        parts_of(gk.FourBar(100, 30, 90, 70, 1e-12))
    assert caught.value.field == "coupler_point"
    with pytest.raises(gk.DesignError, match="apart") as caught:
        parts_of(gk.FourBar(100, 4, 90, 70))
    assert caught.value.field == "crank"


@pytest.mark.parametrize(
    ("linkage", "branch", "openings"),
    [
        (gk.SliderCrank(30, 90), 1, {"ground": (1, 1), "crank": (2, 0), "coupler": (2, 0)}),
        (slotted_lever(80, 30, 160), -1, {"ground": (2, 0), "crank": (2, 0), "lever": (2, 1)}),
        (sliding_coupler("coupler", "block"), 1, {"ground": (2, 0), "crank": (2, 0), "coupler": (2, 1)}),
        (sliding_coupler("block", "coupler"), 1, {"ground": (2, 0), "crank": (2, 0), "coupler": (2, 1)}),
        (scotch_yoke(), 1, {"ground": (1, 2), "crank": (2, 0), "yoke": (2, 1)}),
        (RAM_WITH_TOOL, 1, {"ground": (1, 1), "crank": (2, 0), "rod": (2, 0), "ram": (4, 0)}),
        (OLDHAM, 1, {"ground": (2, 0), "driving": (1, 2), "disc": (4, 0), "driven": (1, 2)}),
    ],
    ids=["slider-crank", "lever", "coupler along block", "block along coupler", "yoke", "ram", "oldham"],
)
def test_blocks_are_pins_and_other_sliding_bodies_are_plates_with_guide_pins(linkage, branch, openings):
    parts = link_parts(gk.move(linkage, TURN + 0.01, branch), LinkStock(bar_width=6))
    found = {
        part.name: (
            sum(isinstance(hole, gk.plane.Circle) for hole in part.holes),
            sum(not isinstance(hole, gk.plane.Circle) for hole in part.holes),
        )
        for part in parts
    }
    assert found == openings


@pytest.mark.parametrize("offset", [0.0, 15.0, -20.0])
def test_a_crosshead_slot_is_as_long_as_the_stroke(offset):
    """Stroke by Pythagoras at the two dead centres."""
    a, b = 30.0, 90.0
    out, back = np.sqrt((b + a) ** 2 - offset**2), np.sqrt((b - a) ** 2 - offset**2)
    ground = parts_of(gk.SliderCrank(a, b, offset=offset))["ground"]
    (hole,) = [hole for hole in ground.holes if not isinstance(hole, gk.plane.Circle)]
    x0, y0, x1, y1 = polygon(hole).bounds
    assert -1e-9 < x1 - (out + 2.1) < 0.01 and -1e-9 < (back - 2.1) - x0 < 0.01
    assert (y0 + y1) / 2 == pytest.approx(offset) and y1 - y0 == pytest.approx(4.2, abs=1e-3)
    x0, _, x1, _ = polygon(ground.outline).bounds
    assert x1 == pytest.approx(out + 7, abs=0.01)


@pytest.mark.parametrize("step_deg", [5, 12])
@pytest.mark.parametrize("name", list(BUILDABLE)[::4])
def test_every_pin_stays_in_its_slot_between_the_frames_too(name, step_deg):
    """Slots made from few frames against the pin, placed at many more by a second run of the solver."""
    linkage, branch, _, _ = BUILDABLE[name]
    found = assemble(gk.move(linkage, np.radians(np.arange(0, 360 + step_deg, step_deg)), branch), STOCK)
    fine = gk.move(linkage, np.linspace(0, 2 * np.pi, 3000), branch)
    runs = {}
    for pin in found.pins:
        world = fine.bodies[pin.body].point(pin.place).position
        for plate in pin.plates:
            seen = fine.bodies[found.plates[plate].body]
            here = (world - seen.origin.position) * np.conj(seen.direction)
            ends = found.plates[plate].openings[pin.name]
            middle = shapely.LineString(gk.plane.xy(np.array(ends * (3 - len(ends)))))
            off = shapely.distance(middle, shapely.points(gk.plane.xy(here)))
            assert off.max() < 1e-3, (pin.name, plate)
            runs.setdefault((plate, ends), []).append(here)
    for (_, ends), paths in runs.items():
        # No longer than it need be, either: of the order of what a path leaves its chords by at these steps.
        spare = np.abs(np.array(ends)[:, None] - np.concatenate(paths)).min(axis=1).max()
        assert spare < 0.5 * np.radians(step_deg) ** 2 * 100


@pytest.mark.parametrize(
    ("linkage", "body"), [(scotch_yoke(), "yoke"), (RAM_WITH_TOOL, "ram"), (RAM_BESIDE_ITS_LINE, "ram")]
)
def test_guide_pins_stand_apart_on_the_line_and_their_slots_clear_of_everything(linkage, body):
    motion = gk.move(linkage, TURN)
    sliding, ground = (assemble(motion, STOCK).plates[name] for name in (body, "ground"))
    places = [sliding.openings[f"slide_guide_{k}"][0] for k in (1, 2)]
    assert abs(places[1] - places[0]) >= 2 * STOCK.bar_width and places[0].imag == places[1].imag
    for plate in (sliding, ground):
        shapes = {ends: shapely.MultiPoint([(z.real, z.imag) for z in ends]).convex_hull for ends in
                  plate.openings.values()}  # fmt: skip
        for ends, shape in shapes.items():
            assert all(shape.distance(other) > STOCK.bar_width - 1e-6 for e, other in shapes.items() if e != ends)


def test_a_slot_that_meets_a_hole_is_refused_by_name():
    with pytest.raises(gk.DesignError, match="slot of crank_pin") as caught:
        parts_of(slotted_lever(80, 30, 100), -1)
    assert caught.value.field == "lever_end" and caught.value.remedy
    # An in-line crank as long as its rod would bring the crosshead into the crank's pivot.
    with pytest.raises(gk.DesignError, match="slot of slider_pin") as caught:
        parts_of(gk.SliderCrank(30, 31))
    assert caught.value.field == "ground"


@pytest.mark.parametrize("call", [gk.linkage.link_parts, gk.linkage.stack_links])
def test_what_is_no_motion_of_one_linkage_is_refused(call):
    many = gk.move(gk.FourBar(100, np.array([30.0, 31.0]), 90, 70), TURN)
    for motion in (many, gk.FourBar(100, 30, 90, 70)):
        with pytest.raises(gk.DesignError) as caught:
            call(motion)
        assert caught.value.field == "motion"
    with pytest.raises(gk.DesignError, match="a LinkStock"):
        call(gk.move(gk.FourBar(100, 30, 90, 70), TURN), 3.0)

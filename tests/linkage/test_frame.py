"""A walker that stands on a frame: its rods are clear of all that moves, its bill and its pictures are complete."""

import dataclasses
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
import shapely

import geomkin as gk
from tests.gallery import named

COPIES = 6


@pytest.fixture(scope="module")
def walker():
    return gk.load("recipes/motor-walker.toml")


def region(part, body, k):
    """A part's outline at a frame."""
    ends = np.asarray(part.outline.breaks)
    points = body.origin[k] + body.direction[k] * part.outline.point(np.linspace(ends[0], ends[-1], 200))
    return shapely.Polygon(np.c_[points.real, points.imag])


def frame_holes(walker, name):
    """Places of the rods in a ground, mm: those of its last three letters."""
    body = named(walker.scene, name)
    (part,) = body.parts
    letters = sorted(filter(None, part.hole_names))[-3:]
    holes = [hole for letter, hole in zip(part.hole_names, part.holes) if letter in letters]
    middles = [np.mean(hole.point(np.linspace(hole.breaks[0], hole.breaks[-1], 65)[:-1])) for hole in holes]
    return body.origin[0] + body.direction[0] * np.array(middles)


def test_rods_of_the_frame_go_through_all_grounds_and_clear_all_that_moves(walker):
    scene = walker.scene
    rods = np.sort_complex(frame_holes(walker, "ground").round(6))
    for k in range(2, COPIES + 1):
        assert np.sort_complex(frame_holes(walker, f"ground, copy {k}").round(6)) == pytest.approx(rods)
    assert shapely.Polygon(np.c_[rods.real, rods.imag]).area > 1000
    # Tubes and nuts as wide as a bar; one copy of each side passes all places of a turn.
    tubes = shapely.union_all([shapely.Point(z.real, z.imag).buffer(5) for z in rods])
    for body in scene.bodies:
        if not body.fixed and ("copy" not in body.name or body.name.endswith("copy 2")):
            assert min(tubes.distance(region(body.parts[0], body, k)) for k in range(len(scene.time))) > 0


def test_every_joint_of_a_driven_walker_has_a_screw_or_a_rod(walker):
    """Seven joints in each copy; five rods replace two screws each, and the motor one."""
    count = {bought.name: bought.count for bought in walker.bought}
    screws = sum(n for name, n in count.items() if "button head" in name)
    rods = {name: n for name, n in count.items() if name.startswith("rod")}
    assert sum(rods.values()) == COPIES - 1 and screws == 7 * COPIES - 2 * (COPIES - 1) - 1
    # Screws have one nut each; three threaded rods have two.
    assert count["M3 lock nut ISO 7040"] == count["M3 washer ISO 7089"] == screws + 6
    # Between the outer faces of the frame there are six sheets, and tubes on each rod.
    tubes = sum(
        n * float(re.search(r"cut to ([\d.]+)", name)[1]) for name, n in count.items() if name.startswith("tube")
    )
    rod = next(float(re.search(r"cut to ([\d.]+)", name)[1]) for name in count if "threaded rod" in name)
    ends = 2 * (0.5 + 4.5 + 0.5)  # washer, lock nut and a pitch
    assert rod == pytest.approx(tubes / 3 + 3 * COPIES + ends, abs=0.5)


def test_plates_under_the_ground_take_up_a_boss_that_is_higher_than_the_sheet(walker):
    parts = {part.name: part for part in walker.parts}
    plate, ground = parts["motor_plate"], parts["ground"]
    assert 3 * (1 + plate.count) >= 6 > 3
    # The boss and the four screws are where the ground has them, and it covers the motor's face.
    holes = [next(h for h in ground.holes if abs(h.centre - hole.centre) < 1e-9) for hole in plate.holes]
    assert [hole.radius for hole in holes] == [hole.radius for hole in plate.holes] and len(holes) == 5
    screw = next(item.name for item in walker.bought if "countersunk" in item.name)
    # 2 to 3 mm in the threads of the motor.
    assert 8 <= float(re.search(r"x (\d+) ", screw)[1]) <= 9
    stock = walker.stock
    assert dataclasses.replace(stock, thickness=6.0).motor_plates == 0
    with pytest.raises(gk.DesignError, match="boss"):
        dataclasses.replace(stock, thickness=1.0, pin_diameter=1.0)


@pytest.mark.campaign
def test_the_walker_does_not_fall_over_and_four_legs_are_warned_of(walker):
    assert {check.id for check in walker.checks if not check.passed} == {"transmission_angle", "shaft_engagement"}
    assert walker.aspect("foot").stance.margin.min() > 25
    # Without the motor at its end, so that four legs stand too.
    bare = dataclasses.replace(walker, loads=None, stock=dataclasses.replace(walker.stock, motor=None))
    four = dataclasses.replace(bare, copies=walker.copies[:3])
    assert len(four.remarks) == len(bare.remarks) + 1


def test_pictures_of_the_steps_show_each_plate_of_each_unit_once_from_below(walker, tmp_path):
    gk.write(walker, tmp_path / "w-steps.svg")
    root = ET.parse(tmp_path / "w-steps.svg").getroot()
    name = "{http://www.w3.org/2000/svg}"
    headings = [text.text for text in root.iter(f"{name}text") if text.get("class") == "scale"]
    # The motor's plates are under the first layer.
    layers = [int(re.search(r"layer (\d+)", heading)[1]) - heading.count("under layer") for heading in headings]
    shown = [part for heading in headings for part in heading.split(": ")[1].split(", ")]
    (second,) = (k for k in range(1, len(layers)) if layers[k] < layers[k - 1])
    assert layers[:second] == sorted(set(layers[:second])) and layers[second:] == sorted(set(layers[second:]))
    cut = {part.name for part in walker.parts} - {"spacer"}
    plain = {"plain_ground", "plain_crank"}
    others = cut - plain - {"ground", "crank", "motor_plate"}
    assert sorted(shown) == sorted([*cut, *others])
    # Each picture colours the parts of its layer, and shows all below faintly.
    groups = [g for g in root if g.tag == f"{name}g"]
    for k, group in enumerate(groups):
        items = list(group.find(f"{name}g"))
        start = 0 if k < second else second
        so_far = sum(len(heading.split(": ")[1].split(", ")) for heading in headings[start : k + 1])
        own = len(headings[k].split(": ")[1].split(", "))
        assert len(items) == so_far and sum(item.get("opacity") is None for item in items) == own

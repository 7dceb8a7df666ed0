"""What the pins of a guided body are chosen by, as it is drawn, against the poses and the linkage that was found."""

import numpy as np
import pytest

from tests.gallery import recipe

POINTS = {"poses-by-trammel": "rod_point"}


def curves(name, label):
    return [curve.curve for curve in recipe(name).scene.curves if label in curve.label]


def first_places(name):
    """Of the pins, where the body is as it was asked for first, wherever the driver starts."""
    motion, (first, _) = recipe(name).design.motion, recipe(name).wanted.pairs[0]
    at = int(np.argmin(np.abs(motion.point(POINTS.get(name, "coupler_point")).position - first)))
    return {pin: complex(motion.point(pin).position[at]) for pin in motion.linkage.pins}


@pytest.mark.parametrize(("name", "count"), [("three-poses", 3), ("poses-by-trammel", 3)])
def test_a_body_that_turns_about_a_pole_goes_from_pose_to_pose(name, count):
    poses = recipe(name).wanted.pairs
    poles = {curve.label: curve.curve.centre for curve in recipe(name).scene.curves if curve.label.startswith("pole")}
    assert len(poles) == count
    for label, pole in poles.items():
        one, other = (poses[int(word) - 1] for word in label.split() if word.isdigit())
        turned = pole + np.exp(1j * (other[1] - one[1])) * (one[0] - pole)
        assert turned == pytest.approx(other[0], abs=1e-9 * abs(pole - one[0]) + 1e-9)


def test_pins_lie_where_the_regions_allow_them():
    pins = first_places("three-poses")
    circles, lines = curves("three-poses", "image-pole circle"), curves("three-poses", "line of the driven link")
    assert len(circles) == 3 and len(lines) == 3
    assert sum(abs(circle.centre - pins["rocker_pin"]) < circle.radius for circle in circles) % 2 == 0
    # Each line passes through the driven pin, and the driving pin is on one side of all, as the link points.
    sides = []
    for line in lines:
        middle, way = (line.start + line.end) / 2, line.end - line.start
        assert middle == pytest.approx(pins["rocker_pin"], abs=1e-6)
        assert abs(way) == pytest.approx(recipe("three-poses").extent)
        sides.append(np.sign(np.imag(np.conj(way) * (pins["crank_pin"] - middle))))
    assert abs(sum(sides)) == 3
    # At the first pose the driven link lies along the first of them.
    along = pins["rocker_pivot"] - pins["rocker_pin"]
    turns = [np.imag(np.conj(line.end - line.start) * along) / abs(line.end - line.start) for line in lines]
    assert min(np.abs(turns)) < 1e-6 * abs(along)


@pytest.mark.parametrize(
    ("name", "driven", "driving"),
    [
        ("three-poses", "rocker_pin", "crank_pin"),
        ("poses-by-slider", "crank_pin", "slider_pin"),
        ("poses-by-crank", "slider_pin", "crank_pin"),
    ],
)
def test_shaded_regions_hold_no_found_pin(name, driven, driving):
    pins, regions = first_places(name), {region.role: region for region in recipe(name).scene.regions}
    assert set(regions) == {"driven", "driving"}
    for role, pin in (("driven", driven), ("driving", driving)):
        loops = [np.append(curve.vertices, curve.vertices[:1]) - pins[pin] for curve in regions[role].curves]
        turns = [np.angle(loop[1:] / loop[:-1]).sum() / (2 * np.pi) for loop in loops]
        assert loops and sum(abs(round(turn)) for turn in turns) % 2 == 0

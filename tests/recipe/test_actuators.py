"""Recipes that a cylinder's rod drives: tables in mm, plates, checks, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

import geomkin as gk

RECIPE = Path(__file__).parent.parent.parent / "recipes" / "lift-table.toml"


@pytest.fixture(scope="module")
def lift():
    return gk.load(RECIPE)


def changed(tmp_path, **tables):
    """The gallery's recipe with other tables, written where it can be read."""
    text = RECIPE.read_text()
    for old, new in tables.values():
        assert old in text
        text = text.replace(old, new)
    file = tmp_path / "changed.toml"
    file.write_text(text)
    return file


def test_table_has_the_stroke_and_the_lifted_load(lift):
    columns = {column.header: column.values for column in lift.table.columns}
    place = columns["lift_place_mm"]
    assert next(iter(columns)) == "lift_place_mm" and place[[0, -1]] == pytest.approx([45, 120])
    assert columns["lift_displacement_mm"] == pytest.approx(place)
    assert columns["time_s"][-1] == pytest.approx(75 / 20) and columns["lift_velocity_mm_per_s"] == pytest.approx(20)
    # By the law of cosines: from the pins' distance to the arm's angle, and the table is as high as the arm's end.
    far, near, apart = abs(180 - 80j), abs(140 - 15j), place + 60
    between = np.arccos((far**2 + near**2 - apart**2) / (2 * far * near))
    angle = between + np.angle(180 - 80j) - np.angle(140 - 15j)
    assert np.radians(columns["arm_angle_deg"]) == pytest.approx(angle)
    assert columns["load_y_mm"] == pytest.approx(200 * np.sin(angle))
    # Without friction the load's weight times its speed is the cylinder's force times that of the rod.
    lifted = np.gradient(columns["load_y_mm"], columns["time_s"])
    assert columns["load_velocity_y_mm_per_s"][1:-1] == pytest.approx(lifted[1:-1], rel=1e-3)
    turned = np.gradient(angle, place)
    assert columns["arm_mechanical_advantage_mm"][1:-1] == pytest.approx(1 / turned[1:-1], rel=1e-3)


def test_rod_and_cylinder_are_plates_and_the_slot_is_as_long_as_the_stroke(lift):
    parts = {part.name: part for part in lift.parts}
    assert {"cylinder", "rod"} <= set(parts)
    pins = {pin.name: pin for pin in lift.made.stack.pins}
    assert all(pins[f"lift_guide_{k}"].slots == ("cylinder",) for k in (1, 2))
    rod, cylinder = lift.made.stack.plates["rod"], lift.made.stack.plates["cylinder"]
    places = [rod.openings[f"lift_guide_{k}"][0].real for k in (1, 2)]
    slot = [end.real for end in cylinder.openings["lift_guide_1"]]
    # One slot for both pins, from where the inner one is at first to where the outer one is at last.
    assert sorted(slot) == pytest.approx([45 + min(places), 120 + max(places)])
    # Nothing leaves it between the frames.
    motion = gk.move(lift.linkage, np.linspace(45, 120, 1001))
    for place in places:
        seen = motion.rod.point(place).position - motion.cylinder.origin.position
        seen = seen * np.conj(motion.cylinder.direction)
        assert np.abs(seen.imag).max() < 1e-11
        assert min(slot) - 1e-9 < seen.real.min() and seen.real.max() < max(slot) + 1e-9

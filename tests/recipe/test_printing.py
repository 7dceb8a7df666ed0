"""The table `printing`: one clearance for all that turns or meshes, in each kind, composed with the other keys."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from shapely import affinity, distance
from shapely import points as shapely_points
from shapely.geometry import Polygon

import geomkin as gk
from geomkin.plane.flatten import flatten
from geomkin.plane.primitives import Circle
from geomkin.plane.vec import xy
from geomkin.recipe.keys import with_values
from geomkin.recipe.load import to_toml, whole_table
from geomkin.recipe.printing import Printing

BAR = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}
GEARS = {
    "kind": "gear-pair",
    "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
    "second": {"teeth": 24, "module": 2},
    "first_stock": {"bore": 5},
    "second_stock": {"bore": 6},
}
CAM = {
    "kind": "disk-cam",
    "cam": {
        "base_radius": 30,
        "follower": {"kind": "oscillating-roller", "roller_radius": 6, "pivot_distance": 70, "arm_length": 55},
        "program": [
            {"kind": "rise", "law": "cycloidal", "rise_deg": 15, "end_deg": 180},
            {"kind": "return", "law": "cycloidal", "end_deg": 360},
        ],
    },
    "base": {},
}
GENEVA = {"kind": "geneva", "geneva": {"distance": 60, "slots": 6}}
CYCLOIDAL = {"kind": "cycloidal-drive", "cycloidal": {"pins": 11, "circle": 100, "pin": 8, "eccentricity": 3}}
TRAIN = {"kind": "gear-train", "train": {"module": 1.5, "stages": [[12, 30], [12, 36]]}, "stock": {"bore": 4}}
GAP = 0.3


def printed(table, **more):
    return gk.load({**table, "printing": {"clearance": GAP} | more})


def polygon(curve, tolerance=1e-4):
    return Polygon(xy(flatten(curve, tolerance)))


@pytest.mark.parametrize("table", [BAR, GEARS, CAM, GENEVA, CYCLOIDAL, TRAIN], ids=lambda table: table["kind"])
def test_round_holes_are_wider_than_their_pins(table):
    """By the gap, whatever the stocks say; those of motors and screws too."""
    holes = 0
    for part in printed(table).parts:
        for hole, fit in zip(part.holes, part.fits):
            if fit is not None and isinstance(hole, Circle):
                assert 2 * hole.radius - fit.diameter == pytest.approx(GAP, abs=1e-9), part.name
                holes += 1
    assert holes >= 3


def test_teeth_in_mesh_keep_half_of_the_gap_on_each_side():
    """The gears that are cut, turned together by shapely: either may turn by the backlash before it meets the other."""
    recipe = printed(GEARS)
    pair = recipe.design
    first, second = (polygon(recipe.parts[k].outline) for k in (0, 1))
    # The teeth on +y: turned to face each other, a tooth of the first in a space of the second.
    first = affinity.rotate(first, -90, origin=(0, 0))
    second = affinity.rotate(second, 90 + 180 / pair.second.teeth, origin=(0, 0))
    second = affinity.translate(second, pair.centre_distance, 0)
    free = [_free_turn(first, second, sign) * pair.first.pitch_radius for sign in (1, -1)]
    # Along the working pitch circle it is larger than along the pitch circle.
    widening = pair.centre_distance / (pair.first.pitch_radius + pair.second.pitch_radius)
    assert free[0] == pytest.approx(free[1], abs=2e-3)
    assert sum(free) == pytest.approx(GAP, abs=3e-3)
    assert pair.backlash == pytest.approx(widening * sum(free), rel=0.05)
    assert first.distance(second) > 0.4 * GAP


def _free_turn(first, second, sign):
    """Angle, rad, by which the first gear turns until it meets the second, by bisection."""
    free, met = 0.0, 0.1
    for _ in range(16):
        middle = (free + met) / 2
        turned = affinity.rotate(first, sign * middle, origin=(0, 0), use_radians=True)
        free, met = (middle, met) if turned.distance(second) > 0 else (free, middle)
    return free


def test_trains_and_mates_have_the_backlash():
    train = printed(TRAIN)
    assert train.design.backlash * train.design.module == pytest.approx(GAP)
    mate = {"kind": "lantern-gears", "mate": {"teeth": 48, "addendum": 7}}
    mate["pinion"] = {"pins": 12, "module": 4, "pin_diameter": 5.5}
    assert printed(mate).mate.backlash == GAP


def test_slots_of_geneva_wheels():
    recipe = printed(GENEVA)
    wheel, roller = polygon(recipe.parts[0].outline), recipe.geneva.roller
    # Of points on a circle through the slots, those in the middle of a slot are farthest from the wheel.
    radius = 0.6 * max(abs(complex(*z)) for z in wheel.exterior.coords)
    points = radius * np.exp(2j * np.pi * np.arange(2_000) / 2_000)
    assert distance(wheel, shapely_points(xy(points))).max() == pytest.approx((roller + GAP) / 2, abs=5e-3)


def test_discs_of_cycloidal_drives_keep_half_of_the_gap_from_all_pins():
    recipe = printed(CYCLOIDAL)
    drive, disc = recipe.cycloidal, polygon(recipe.parts[0].outline)
    pins = shapely_points(xy(drive.circle / 2 * np.exp(2j * np.pi * np.arange(drive.pins) / drive.pins)))

    def gaps(turn):
        moved = affinity.translate(affinity.rotate(disc, turn, origin=(0, 0), use_radians=True), drive.eccentricity, 0)
        return distance(moved, pins) - drive.pin / 2

    pitch = 2 * np.pi / (drive.pins - 1)
    best = max(pitch * np.arange(100) / 100, key=lambda turn: gaps(turn).min())
    np.testing.assert_allclose(gaps(best), GAP / 2, atol=0.05)


@pytest.mark.parametrize("table", [BAR, GEARS, CAM], ids=lambda table: table["kind"])
def test_it_survives_writing_changing_and_inches(table):
    recipe = printed(table, growth=0.1, foot=0.3)
    assert gk.load(to_toml(recipe)) == recipe
    # Another clearance reaches all tables, from the recipe and from its text.
    narrow = printed(table, clearance=0.1, growth=0.1, foot=0.3)
    assert replace(recipe, printing=replace(recipe.printing, clearance=0.1)) == narrow
    assert gk.load(with_values(tomllib.loads(to_toml(recipe)), {"printing.clearance": 0.1})) == narrow
    inches = gk.load({**whole_table(replace(recipe, units="in"))})
    assert inches.printing.clearance == pytest.approx(GAP)
    assert [fit.play for part in inches.parts for fit in part.fits if fit] == pytest.approx(
        [fit.play for part in recipe.parts for fit in part.fits if fit]
    )


def test_sweep_of_the_clearance():
    table, key = {**GEARS, "printing": {"clearance": 0.1}}, "pair.backlash_mm"
    rows = gk.sweep(table, {"printing.clearance": [0.1, 0.3]}, results=[key]).rows
    assert rows[1].results[key] == pytest.approx(3 * rows[0].results[key])


def test_machine_prints_all_its_mechanisms():
    machine = {
        "kind": "machine",
        "mechanisms": {
            "pair": {"recipe": GEARS},
            "legs": {"recipe": BAR, "turned_by": "pair.second", "mirrored": True, "angle_deg": 30},
        },
    }
    recipe = printed(machine, foot=0.2)
    recipes = [mechanism.recipe for mechanism in recipe.mechanisms.values()]
    assert recipes == [printed(GEARS, foot=0.2), printed(BAR, foot=0.2)]
    machine["mechanisms"]["legs"]["recipe"] = {**BAR, "printing": {"clearance": GAP}}
    assert printed(machine, foot=0.2) == recipe
    with pytest.raises(gk.RecipeError) as refused:
        gk.load(machine)
    assert refused.value.problems[0].key == "mechanisms.legs.recipe.printing"


@pytest.mark.parametrize(
    "table",
    [
        {**BAR, "stock": {"pin_fit": "H7/g6"}},
        {**GEARS, "second_stock": {"bore": 6, "fit": "H7/g6"}},
        {**GEARS, "first_stock": {"bore": 6, "bore_tolerance": "H7"}},
        {**GEARS, "first": {"teeth": 12, "module": 0.3}, "second": {"teeth": 24, "module": 0.3}},
    ],
    ids=["pins", "bore", "tolerance", "small teeth"],
)
def test_contradictions_name_the_clearance(table):
    gk.load(table)
    with pytest.raises(gk.RecipeError) as refused:
        printed(table, clearance=0.9)
    assert refused.value.problems[0].key == "printing.clearance"


def test_workshop_file_has_what_printing_omits(tmp_path):
    (tmp_path / "printer.toml").write_text("[PLA]\nclearance = 0.25\ngrowth = 0.12\ninterference = -0.05\n")
    text = to_toml(gk.load(BAR)).replace('kind = "four-bar"', 'kind = "four-bar"\nworkshop = "printer.toml"')
    (tmp_path / "bar.toml").write_text(text.replace("clearance = 0.2\n", "") + "[printing]\nfoot = 0.3\n")
    recipe = gk.load(tmp_path / "bar.toml")
    assert recipe.printing == Printing(0.25, growth=0.12, foot=0.3)
    assert (recipe.stock.clearance, recipe.files.kerf) == (0.25, 0.0)


def test_no_kind_assumes_a_clearance_that_is_stated():
    assert "stock.clearance" in gk.load(BAR).assumed_fits
    assert printed(BAR).assumed_fits == {"files.kerf": 0.0}

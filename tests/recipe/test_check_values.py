"""What recipes' checks say, held against what they are about."""

import numpy as np
import pytest

from tests.texts import parse, template_of


def checks(recipe):
    return {check.name: check for check in recipe.design_checks}


def test_the_largest_forces_of_the_table_are_compared():
    recipe = parse(template_of("shaking-force"))
    table = {column.id: np.asarray(column.values) for column in recipe.table.columns}
    most = {name: np.abs(table[f"force_{name}"]).max() for name in ("given", "best")}
    found = checks(recipe)["largest force, given to best counterbalance"]
    assert found.value == pytest.approx(most["given"] / most["best"], rel=1e-3)


def test_the_table_of_planets_is_one_turn_of_the_carrier_without_slip():
    recipe = parse(template_of("planetary"))
    table = {column.id: np.asarray(column.values) for column in recipe.table.columns}
    sun, planet, ring = (gear.teeth for gear in (recipe.gears.sun, recipe.gears.planet, recipe.gears.ring))
    carrier = table["carrier_angle"]
    assert (carrier[0], carrier[-1]) == (0, pytest.approx(360)) and (np.diff(carrier) > 0).all()
    # As many teeth of each planet pass the standing ring as of the sun pass it, seen from the carrier.
    seen = table["planet_angle"] - carrier
    assert seen * planet == pytest.approx(-carrier * ring)
    assert seen * planet == pytest.approx(-(table["sun_angle"] - carrier) * sun)


def test_lift_lost_to_undercut_is_reported_in_the_unit_of_the_lift():
    recipe = parse("""kind = "disk-cam"
[cam]
base_radius = 20
direction = "clockwise"
follower = {kind = "oscillating-roller", roller_radius = 30, pivot_distance = 100, arm_length = 80}
program = [{kind = "dwell", end_deg = 60}, {kind = "rise", law = "3-4-5", rise_deg = 15, end_deg = 110},
           {kind = "dwell", end_deg = 120}, {kind = "return", law = "cycloidal", end_deg = 175},
           {kind = "dwell", end_deg = 360}]
""")
    most = np.degrees(recipe.made.cut.lost_lift(np.linspace(0, 2 * np.pi, 20001)).max())
    found = checks(recipe)["lift lost to undercut"]
    assert found.unit == "deg" and found.value == pytest.approx(most, rel=1e-4) and most > 0.1

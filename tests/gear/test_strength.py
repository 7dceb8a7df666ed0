"""Forces and stresses of gears against the formulas of the cutting rack, brute force, and published numbers."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.strength import LoadFactors, PairStrength, root_section, tooth_form
from geomkin.plane.roulettes import involute_function

STEEL = gk.Material("steel", 7850, modulus=206_000, poisson_ratio=0.3, strength=600, yield_strength=340)


def section_from_rack(z, x, dedendum=1.25, rho=0.38, angle=np.radians(20)):
    """Chord, lever for a load at the tip, and fillet radius, in modules, by the iteration of ISO 6336-3."""
    e = np.pi / 4 - dedendum * np.tan(angle) - (1 - np.sin(angle)) * rho / np.cos(angle)
    g, h = rho - dedendum + x, 2 / z * (np.pi / 2 - e) - np.pi / 3
    theta = np.pi / 6
    for _ in range(200):
        theta = 2 * g / z * np.tan(theta) - h
    chord = z * np.sin(np.pi / 3 - theta) + np.sqrt(3) * (g / np.cos(theta) - rho)
    fillet = rho + 2 * g**2 / (np.cos(theta) * (z * np.cos(theta) ** 2 - 2 * g))
    tip, base = z + 2 + 2 * x, z * np.cos(angle)
    at_tip = np.arccos(base / tip)
    half = (np.pi / 2 + 2 * x * np.tan(angle)) / z + involute_function(np.tan(angle))
    half -= involute_function(np.tan(at_tip))
    load = at_tip - half
    lever = (np.cos(half) - np.sin(half) * np.tan(load)) * tip - z * np.cos(np.pi / 3 - theta) - g / np.cos(theta) + rho
    return chord, lever / 2, fillet


@pytest.mark.parametrize("z", (12, 17, 24, 40))
@pytest.mark.parametrize("x", (-0.2, 0.0, 0.5))
def test_critical_section_of_the_exact_root_is_that_of_the_cutting_rack(z, x):
    gear = gk.SpurGear(z, 2, x)
    chord, lever, fillet = section_from_rack(z, x)
    form = tooth_form(gear)
    assert form.section.thickness / 2 == pytest.approx(chord, rel=1e-9)
    assert form.section.fillet_radius / 2 == pytest.approx(fillet, rel=1e-9)
    assert form.lever / 2 == pytest.approx(lever, rel=1e-9)


def test_factors_of_a_load_at_the_tip_match_handbooks():
    """Y_Fa and Y_Sa of Chinese handbooks after DIN 3990, racks of dedendum 1.25 and tip radius 0.38, within 0.8 %."""
    printed = {17: (2.97, 1.52), 30: (2.52, 1.625), 100: (2.18, 1.79)}
    for teeth, (form_factor, correction) in printed.items():
        form = tooth_form(gk.SpurGear(teeth, 3))
        assert form.form_factor == pytest.approx(form_factor, rel=8e-3)
        assert form.stress_correction == pytest.approx(correction, rel=8e-3)


@pytest.mark.parametrize("teeth", (12, 17, 38))
def test_lewis_parabola_touches_the_tooth_that_a_rolling_rack_leaves(teeth):
    """The half width of the tooth on each circle, by brute force: the least angle that the rack leaves."""
    angle, rho, radius = np.radians(20), 0.38, teeth / 2
    depth = 1.25 - rho
    side = np.pi / 4 - depth * np.tan(angle) - rho / np.cos(angle)
    # The corner's centre in the gear's frame, with the space next to the tooth on +y as the rack rolls.
    roll = np.linspace(-0.5, 0.5, 2001)
    centre = (1j * (radius - depth) - side - radius * roll) * np.exp(-1j * roll)
    centre *= np.exp(-1j * np.pi / teeth)
    circles = np.linspace(radius - 1.249, gk.SpurGear(teeth, 1).form_radius, 500)[:, None]
    cosine = (circles**2 + np.abs(centre) ** 2 - rho**2) / (2 * circles * np.abs(centre))
    # Angles from +y towards +x that the corner occupies begin at its near side.
    near = np.pi / 2 - np.angle(centre) - np.where(np.abs(cosine) <= 1, np.arccos(np.clip(cosine, -1, 1)), -np.inf)
    half = near.min(axis=1)
    x, y = circles[:, 0] * np.sin(half), circles[:, 0] * np.cos(half)
    gear = gk.SpurGear(teeth, 1)
    load = np.arccos(gear.base_radius / gear.tip_radius) - gear.thickness(gear.tip_radius) / (2 * gear.tip_radius)
    below = gear.base_radius / np.cos(load) - y
    assert tooth_form(gear).lewis_factor == pytest.approx((2 / 3 * x**2 / below)[np.isfinite(x)].min(), rel=1e-3)


def test_lewis_factors_are_near_the_printed_ones():
    """Y of full-depth teeth of 20 deg as in Shigley; its roots have other fillets."""
    for teeth, printed in {12: 0.245, 17: 0.303, 24: 0.337, 38: 0.384, 100: 0.447}.items():
        assert tooth_form(gk.SpurGear(teeth, 1)).lewis_factor == pytest.approx(printed, rel=0.04)


def test_pair_of_20_and_40_teeth():
    """Worked with the formulas of ISO 6336-2 and -3 by hand and by a second program: load factors 1, 5 N m."""
    pair = gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2))
    loaded = PairStrength(pair, 5000, 20, (STEEL, STEEL))
    assert loaded.tangential_force == pytest.approx(250)
    # The nominal contact stress has the contact ratio factor, the pressure at the pitch point has not.
    assert loaded.contact_pressure * np.sqrt((4 - pair.contact_ratio) / 3) == pytest.approx(287.824486, abs=1e-6)
    assert [t.root_stress for t in loaded.teeth] == pytest.approx([18.0843, 17.0860], abs=5e-5)


def test_torque_limit_is_the_torque_at_which_a_safety_meets_its_limit():
    pair = gk.GearPair(gk.SpurGear(17, 2), gk.SpurGear(40, 2))
    for material in (STEEL, gk.making.material("POM"), gk.making.material("birch-plywood")):
        loaded = PairStrength(pair, 100, 8, (material, material))
        at_limit = PairStrength(pair, loaded.torque_limit, 8, (material, material))
        checks = gk.gear.strength_checks(at_limit)
        assert min(check.value / check.limit for check in checks) == pytest.approx(1)


def test_load_factors_multiply_stresses_but_not_bearing_loads():
    pair = gk.GearPair(gk.SpurGear(17, 2), gk.SpurGear(40, 2))
    plain = PairStrength(pair, 100, 8, (STEEL, STEEL))
    shaken = PairStrength(pair, 100, 8, (STEEL, STEEL), LoadFactors(dynamic_factor=4))
    assert shaken.teeth[0].root_stress == pytest.approx(4 * plain.teeth[0].root_stress)
    assert shaken.contact_pressure == pytest.approx(2 * plain.contact_pressure)
    assert shaken.normal_force == plain.normal_force


def test_pressure_in_a_ring_is_that_of_a_convex_and_a_concave_cylinder():
    pair = gk.GearPair(gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))
    loaded = PairStrength(pair, 5000, 10, (STEEL, STEEL))
    r1, r2 = (r * np.sin(pair.working_pressure_angle) for r in pair.working_radii)
    modulus = 206_000 / (2 * (1 - 0.3**2))
    expected = np.sqrt(loaded.normal_force / 10 * modulus * (1 / r1 - 1 / r2) / np.pi)
    assert loaded.contact_pressure == pytest.approx(expected)


def test_ring_has_no_such_section():
    with pytest.raises(gk.DesignError):
        root_section(gk.RingGear(60, 2))


PAIR = {"kind": "gear-pair", "first": {"teeth": 17, "module": 2}, "second": {"teeth": 40, "module": 2}}


def test_recipe_states_forces_checks_and_pressure():
    recipe = gk.load(
        PAIR | {"first_stock": {"material": "POM"}, "second_stock": {"material": "MDF"}, "loads": {"torque_n_mm": 400}}
    )
    assert recipe.notes["loads"]["torque_n_mm"] == {"first": 400, "second": pytest.approx(400 * 40 / 17)}
    assert {"first_root_safety", "second_root_safety", "contact_safety"} <= {check.id for check in recipe.checks}
    along, pressure = recipe.table["along"], recipe.table["contact_pressure"]
    at_pitch = np.interp(17 * np.sin(np.radians(20)), along, pressure)
    assert recipe.notes["loads"]["contact_pressure_n_per_mm2"] == pytest.approx(at_pitch, rel=1e-3)


def test_loads_without_a_material_name_the_key():
    with pytest.raises(gk.RecipeError, match=r"second_stock\.material: is missing"):
        gk.load(PAIR | {"first_stock": {"material": "POM"}, "loads": {"torque_n_mm": 400}})


def test_helical_teeth_state_why_strength_is_missing():
    stocks = {"first_stock": {"material": "POM"}, "second_stock": {"material": "POM"}}
    recipe = gk.load(PAIR | stocks | {"helix_angle_deg": 20, "loads": {"torque_n_mm": 400}})
    assert recipe.forces_missing and "loads" not in recipe.notes

"""Round ends of bars in a recipe, by the conditions of force balance and by polygons of the outlines that are cut."""

import dataclasses
import tomllib
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import Polygon

import geomkin as gk
from geomkin.linkage.parts.plates import LinkPlate
from geomkin.linkage.parts.rotating_masses import round_end
from geomkin.plane.flatten import flatten

BALANCED = "recipes/balanced-rocker.toml"
STEEL = gk.making.material("steel-S235")


def four_bar(counterweights, **more):
    return gk.load({
        "kind": "four-bar",
        "linkage": {"ground": 100, "crank": 25, "coupler": 80, "rocker": 60},
        "drive": {"speed_rpm": 300, "step_deg": 5},
        "loads": {"counterweights": {"bodies": ["crank", "rocker"], "distance": 40, "largest_radius": 40, **counterweights},
                  **more.pop("loads", {})},
        "stock": {"bar_width": 12, "material": "steel-S235"}, **more,
    })  # fmt: skip


def test_plates_and_screws_meet_the_conditions_of_force_balance():
    """Berkof and Lowen, 1969: first moments of crank and rocker about their pivots that balance the coupler's mass."""
    masses = gk.masses(gk.load(BALANCED))
    coupler = masses["coupler"]
    z = coupler.centre
    crank, rocker = (masses[body].mass * masses[body].centre for body in ("crank", "rocker"))
    scale = coupler.mass * 60
    assert abs(crank + coupler.mass * 25 * (1 - z / 80)) < 1e-9 * scale
    assert abs(rocker + coupler.mass * 60 / 80 * z) < 1e-9 * scale


def test_the_summary_and_the_table_have_the_force_without_and_with_the_counterweights():
    recipe = four_bar({})
    plain = gk.load({
        "kind": "four-bar", "linkage": {"ground": 100, "crank": 25, "coupler": 80, "rocker": 60},
        "drive": {"speed_rpm": 300, "step_deg": 5}, "loads": {}, "stock": {"bar_width": 12, "material": "steel-S235"},
    })  # fmt: skip
    without = recipe.table["shaking_force_without_counterweights"]
    assert without == pytest.approx(plain.table["shaking_force"], rel=1e-9)
    rms = recipe.notes["loads"]["shaking_force_rms_N"]
    # Rounding noise, which differs between processors, would not be 0.
    assert rms["without"] == pytest.approx(np.sqrt(np.mean(without**2)), rel=1e-6) and rms["with"] == 0
    assert recipe.scene.hodographs[0].columns == ("shaking_force", "shaking_force_without_counterweights")
    plates = [{part.name: part.mass.mass for part in one.parts} for one in (recipe, plain)]
    heavier = {body: plates[0][body] - plates[1][body] for body in ("crank", "rocker")}
    ends = recipe.notes["loads"]["counterweights"]
    assert heavier == pytest.approx({body: end["added_mass_kg"] for body, end in ends.items()}, rel=1e-6)


@pytest.mark.campaign
def test_a_bound_on_the_size_leaves_more_force_and_the_check_fails():
    checks = [check for recipe in (four_bar({}), four_bar({"largest_radius": 5})) for check in recipe.checks]
    large, small = (check for check in checks if check.id == "counterweights")
    assert large.passed and not small.passed and large.value < small.value < 1


@pytest.mark.parametrize("moment", (-0.2 - 0.1j, -1.5 - 1j, 3 - 1j))
def test_a_round_end_gives_a_plate_of_any_form_the_wanted_first_moment(moment):
    stock = gk.linkage.LinkStock(bar_width=12, material=STEEL)
    plate, pivot = LinkPlate("lever", {"A": (10 + 5j,), "B": (70 + 0j,), "C": (30 + 40j,)}), 10 + 5j
    end = round_end(plate, stock, STEEL, pivot, moment, 40.0)

    def first_moment(centres):
        outline = flatten(gk.plane.rounded_hull(centres, 6), 1e-4)
        cut = Polygon(np.column_stack([outline.real, outline.imag]))
        areal_density = STEEL.density * 1e-9 * stock.thickness
        return areal_density * cut.area * (complex(cut.centroid.x, cut.centroid.y) - pivot), areal_density * cut.area

    (whole, mass), (bare, bare_mass) = first_moment([*plate.centres, *end.rim]), first_moment(plate.centres)
    assert abs(whole - bare - moment) < 1e-4 * abs(whole) and mass - bare_mass == pytest.approx(
        end.added_mass, rel=1e-3
    )
    assert abs(end.centre - pivot) < 40 * (1 + 1e-9)


def test_bad_counterweights_are_named_by_their_key():
    cases = (
        ({"bodies": ["coupler"]}, {}, "loads.counterweights.bodies"),
        ({"bodies": ["wheel"]}, {}, "loads.counterweights.bodies"),
        ({}, {"stock": {}}, "stock.material"),
        ({}, {"loads": {"masses": {"crank": {"mass_kg": 1}}}}, "loads.masses.crank"),
        ({"distance": 0}, {}, "loads.counterweights.distance"),
    )
    for counterweights, more, key in cases:
        with pytest.raises(gk.RecipeError) as refused:
            four_bar(counterweights, **more)
        assert refused.value.problems[0].key == key


@pytest.mark.parametrize("radius", [10, 40])
def test_larger_round_ends_that_need_other_layers_shake_a_walker_no_more_than_none(radius):
    """A crank alone cannot balance a leg: the advice names neither its distance nor its radius."""
    table = tomllib.loads(Path("recipes/motor-walker.toml").read_text("utf-8"))
    table["loads"]["counterweights"] = {"bodies": ["crank"], "distance": 20, "largest_radius": radius}
    loads = gk.load(table | {"drive": {"step_deg": 30, "speed_rpm": 60}}).aspect("loads")
    check = loads.balanced.check(loads.analysis)
    assert not check.passed and check.value <= 1
    assert "a larger" not in check.advice and "bodies" in check.advice


def test_what_is_screwed_to_a_bar_counts_without_counterweights_too():
    arm = {"name": "arm", "body": "rocker", "at": [30, 0], "mass_kg": 0.02, "bore": 3}
    stock = {"bar_width": 12, "material": "steel-S235", "attachments": [arm]}
    balanced = four_bar({}, stock=stock)
    plain = dataclasses.replace(balanced, loads=dataclasses.replace(balanced.loads, counterweights=None))
    assert balanced.table["shaking_force_without_counterweights"] == pytest.approx(
        plain.table["shaking_force"], rel=1e-9
    )
    assert next(check for check in balanced.checks if check.id == "counterweights").value < 1e-9

"""Flywheels that are cut: their inertia by sums over polygons, their speed by forward dynamics, their layers by shapes."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.parts.stock import LinkStock
from tests.linkage.test_parts_stack import Model

STEEL = 7850e-9
ROD = {"thickness": 4, "material": "steel-S235", "fastener": "rod"}
BAR = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 25, "coupler": 90, "rocker": 60}}
PUSHED = [{"body": "rocker", "point": "rocker_pin", "over_deg": [[0, 0, 0], [90, 20, 0], [180, -20, 0], [360, 0, 0]]}]


def pump(stock=ROD, loads=None, **more):
    """20 N against a slider without mass; the discs turn in a plane without weight."""
    force = {"body": "slider", "point": "slider_pin", "force_n": [20, 0]}
    loads = {"forces": [force], "gravity_m_per_s2": [0, 0], "speed_fluctuation": 0.05,
             "masses": {body: {"mass_kg": 0} for body in ("coupler", "slider")}, **(loads or {})}  # fmt: skip
    return gk.load({"kind": "slider-crank", "linkage": {"crank": 20, "coupler": 70},
                    "drive": {"speed_rpm": 240, "step_deg": 5}, "stock": stock, "loads": loads, **more})  # fmt: skip


def four_bar(loads=None, stock=ROD, **more):
    loads = {"forces": PUSHED, "speed_fluctuation": 0.1, "flywheel_sheets": 1, **(loads or {})}
    return gk.load({**BAR, "drive": {"speed_rpm": 240, "step_deg": 2}, "loads": loads, "stock": stock, **more})


def check(recipe, id):
    return next(check for check in recipe.checks if check.id == id)


def discs_of(recipe):
    return [part for part in recipe.parts if part.name.startswith("flywheel")]


def polar_moment(curve, about):
    """Of the area within an outline, mm4, by triangles from the point."""
    start = gk.flatten(curve, 1e-5) - about
    end = np.roll(start, -1)
    twice = (start.conj() * end).imag
    squares = np.abs(start) ** 2 + (start.conj() * end).real + np.abs(end) ** 2
    return abs(np.sum(twice * squares)) / 12


@pytest.mark.parametrize(
    ("sheets", "stock", "more", "size"),
    [(1, ROD, {}, 1), (3, ROD, {}, 1), (2, ROD | {"motor": "37d-30"}, {}, 1), (1, ROD, {"scale": 2}, 2),
     (6, ROD | {"thickness": 40, "bar_width": 24}, {}, 1)],
    ids=["one", "three", "motor", "scale", "lugs"],
)  # fmt: skip
def test_discs_have_the_inertia_that_keeps_the_speed(sheets, stock, more, size):
    """The slider takes 20 N by 40 mm and gives it back; holes and lugs count."""
    recipe = pump(stock, {"flywheel_sheets": sheets}, **more)
    discs = discs_of(recipe)
    assert len(discs) == sheets
    areas = [polar_moment(d.outline, 0j) - sum(polar_moment(hole, 0j) for hole in d.holes) for d in discs]
    inertia = sum(STEEL * disc.thickness * area for disc, area in zip(discs, areas))
    needed = 1e3 * 800 * size / (0.05 * (8 * np.pi) ** 2)
    assert recipe.notes["loads"]["flywheel"]["inertia_kg_mm2"] == pytest.approx(needed, rel=1e-3)
    has_lugs = stock.get("bar_width", 0) > 20
    assert needed * (1 - 1e-9) <= inertia and (inertia < 1.006 * needed or has_lugs)
    kept = check(recipe, "speed_fluctuation")
    assert kept.passed and kept.value == pytest.approx(0.05 * needed / inertia, rel=1e-4)


def test_discs_fit_the_shaft_of_the_motor_and_the_pins_of_the_crank():
    recipe = pump(ROD | {"motor": "37d-30"}, {"flywheel_sheets": 2})
    crank = next(part for part in recipe.parts if part.name == "crank")
    for disc in discs_of(recipe):
        assert disc.fits == crank.fits
        for hole, other in zip(disc.holes, crank.holes, strict=True):
            assert np.array_equal(gk.flatten(hole, 1e-3), gk.flatten(other, 1e-3))
        assert any(disc.name in step for step in recipe.steps if "motor's shaft" in step)
    # The crank of 4 mm alone would engage 4 of 6 mm.
    assert check(recipe, "shaft_engagement").value == pytest.approx(2)


def test_the_speed_fluctuates_by_no_more_in_forward_dynamics():
    """Parts of their own mass under gravity, driven by the mean torque from the mean speed."""
    drawn = four_bar({"speed_fluctuation": 0.02}, scale=1)
    mean = drawn.notes["loads"]["work_N_mm"] / (2 * np.pi)
    speed = four_bar({"speed_fluctuation": 0.02, "run": {"torque_n_mm": mean, "start_rpm": 240, "turns": 2}}).table["run_speed"]  # fmt: skip
    assert 0.9 * 0.02 < np.ptp(speed) / speed.mean() < 0.0201


@pytest.mark.parametrize(
    ("recipe", "stock"),
    [(lambda stock: four_bar({"speed_fluctuation": 0.04}, stock), ROD),
     (lambda stock: four_bar({"flywheel_sheets": 2}, stock), ROD | {"motor": "37d-19"}),
     (lambda stock: pump(stock, {"flywheel_sheets": 2}), ROD)],
    ids=["beyond the rocker's pivot", "motor", "pump"],
)  # fmt: skip
def test_nothing_meets_a_disc_at_any_frame(recipe, stock):
    recipe = recipe(stock)
    stack = recipe.made.stack
    assert check(recipe, "collisions").value == 0 and not stack.collisions
    material = gk.making.material(stock["material"])
    look = np.linspace(0, 2 * np.pi, 61)
    model = Model(recipe.linkage, 1, stack, recipe.parts, LinkStock(**{**stock, "material": material}), look)
    assert not model.troubles()
    # The discs and the crank lie on one another.
    layers = sorted(layer for name, layer in stack.layers.items() if stack.plates[name].body == "crank")
    assert np.ptp(layers) == len(layers) - 1 == recipe.loads.flywheel_sheets


def test_a_disc_turns_with_the_crank_in_the_scene():
    bodies = {part.name: body for body in four_bar().scene.bodies for part in body.parts}
    for place in ("origin", "direction"):
        assert np.array_equal(getattr(bodies["flywheel"], place), getattr(bodies["crank"], place))
    assert abs(bodies["flywheel"].layer - bodies["crank"].layer) == 1


@pytest.mark.campaign
def test_screws_on_the_crank_meet_the_disc():
    stock = ROD | {"attachments": [{"name": "knob", "body": "crank", "at": [12, 0]}]}
    passed = [check(four_bar({"flywheel_sheets": n}, stock), "attachments_passed").value for n in (0, 1)]
    assert passed[1] == passed[0] + 1


@pytest.mark.parametrize(
    ("loads", "more", "key"),
    [
        ({"speed_fluctuation": None}, {}, "loads.speed_fluctuation"),
        ({}, {"stock": {"thickness": 4}}, "stock.material"),
        ({}, {"copies": [{"phase_deg": 180}]}, "loads.flywheel_sheets"),
        ({"masses": {"crank": {"mass_kg": 1}}}, {}, "loads.masses.crank"),
        ({"flywheel_sheets": 7}, {}, "loads.flywheel_sheets"),
    ],
)
def test_a_flywheel_that_cannot_be_cut_is_refused_by_its_key(loads, more, key):
    with pytest.raises(gk.RecipeError) as refused:
        loads = {"flywheel_sheets": 1, "forces": PUSHED, "speed_fluctuation": 0.1, **loads}
        gk.load({**BAR, "stock": ROD, **more, "loads": {k: value for k, value in loads.items() if value is not None}})
    assert [problem.key for problem in refused.value.problems] == [key]


def test_a_crank_that_does_not_turn_fully_has_no_flywheel():
    bar = {"ground": 100, "crank": 70, "coupler": 30, "rocker": 90}
    with pytest.raises(gk.DesignError) as refused:
        _ = gk.load({**BAR, "linkage": bar, "loads": {"forces": PUSHED, "speed_fluctuation": 0.1, "flywheel_sheets": 1},
                     "stock": ROD}).parts  # fmt: skip
    assert refused.value.field == "loads.flywheel_sheets"

"""A pin in a slot, against closed forms and against the same mechanism with a block that slides and turns on the pin."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import DesignError
from geomkin.linkage.parts.strength import pin_pressures
from geomkin.plane.primitives import Circle
from geomkin.plane.vec import cross, dot
from geomkin.recipe.load import from_table

DRIVE = np.linspace(0.1, 0.1 + 2 * np.pi, 49)
SPEED, ACCELERATION = 3.0, 2.0
CRANK, PIVOT = 25.0, -60j
LEVER = {"ground": {"O": 0, "C": PIVOT}, "crank": {"O": 0, "A": CRANK}, "lever": {"C": 0, "tip": 140}}
# The slot is beside the pivot of the lever, at an angle.
OBLIQUE = {"through": 5j, "direction_deg": 7.0}
SLOTTED = gk.Linkage(LEVER, "crank", slots=(gk.PinInSlot("slot", "crank", "A", "lever", **OBLIQUE),))
BLOCK = gk.Linkage({**LEVER, "block": {"A": 0}}, "crank", (gk.Slider("slot", "block", "lever", **OBLIQUE),))
LOADS = gk.Loads(
    gravity=-9810j,
    masses={"lever": gk.Mass(0.5, centre=70, inertia=900), "crank": gk.Mass(0.1, centre=10, inertia=50)},
    forces=[gk.Force("lever", "tip", -20 + 3j)],
)
# A plate whose two pins run in slots of the ground, and whose slot holds the crank's pin: one loop of no dyad.
PLATE = {"ground": {"O": 0}, "crank": {"O": 0, "A": 20}, "plate": {"P": -60, "Q": 60}}
GUIDES = {
    "p": ("plate", "P", "ground", -60 + 0j, 10.0),
    "q": ("plate", "Q", "ground", 60 + 0j, 80.0),
    "s": ("crank", "A", "plate", 0j, 90.0),
}
ESTIMATE = {"P": -40, "Q": 60}
RECIPE = {
    "kind": "linkage",
    "linkage": {
        "driver": "crank",
        "bodies": {"ground": {"O": [0, 0], "C": [0, -60]}, "crank": {"O": [0, 0], "A": [25, 0]}, "lever": {"C": [0, 0], "tip": [140, 0]}},
        "slots": [{"name": "slot", "body": "crank", "pin": "A", "along": "lever", "through": [0, 5], "direction_deg": 7}],
    },
    "loads": {"gravity_m_per_s2": [0, -9.81], "masses": {"lever": {"mass_kg": 0.5, "centre": [70, 0], "inertia_kg_mm2": 900}}},
}  # fmt: skip


def moved(linkage, drive=DRIVE, branch=1):
    return gk.move(linkage, drive, branch, speed=SPEED, acceleration=ACCELERATION)


def assert_equal(one, other):
    assert one == pytest.approx(other, abs=1e-9 * np.abs(other).max(), rel=0)


def test_the_lever_of_a_whitworth_quick_return_points_at_the_crank_pin():
    bodies = {"ground": {"O": 0, "C": 20j}, "crank": {"O": 0, "A": 50}, "lever": {"C": 0}}
    motion = moved(gk.Linkage(bodies, "crank", slots=(gk.PinInSlot("slot", "crank", "A", "lever"),)))
    from_pivot = 50 * np.exp(1j * DRIVE) - 20j
    velocity = 50j * SPEED * np.exp(1j * DRIVE)
    assert_equal(motion.lever.direction, from_pivot / np.abs(from_pivot))
    assert_equal(motion.slide("slot").displacement, np.abs(from_pivot))
    assert_equal(motion.lever.omega, cross(from_pivot, velocity) / np.abs(from_pivot) ** 2)
    assert_equal(motion.slide("slot").velocity, dot(from_pivot, velocity) / np.abs(from_pivot))


def test_a_scotch_yoke_moves_harmonically():
    bodies = {"ground": {"O": 0}, "crank": {"O": 0, "A": 30}, "yoke": {}}
    slot = gk.PinInSlot("slot", "crank", "A", "yoke", direction_deg=90)
    motion = moved(gk.Linkage(bodies, "crank", (gk.Slider("guide", "yoke", "ground"),), slots=(slot,)))
    turn = np.exp(1j * DRIVE)
    guide, rate = motion.slide("guide"), 30 * (1j * ACCELERATION - SPEED**2) * turn
    assert_equal(guide.displacement, 30 * turn.real)
    assert_equal(guide.acceleration, rate.real)
    assert_equal(motion.slide("slot").acceleration, rate.imag)


def test_a_rod_with_its_pin_in_a_slot_of_the_ground_is_a_slider_crank():
    bodies = {"ground": {"O": 0}, "crank": {"O": 0, "A": 30}, "rod": {"A": 0, "B": 90}}
    motion = moved(gk.Linkage(bodies, "crank", slots=(gk.PinInSlot("slot", "rod", "B", "ground", through=5j),)))
    slider_crank = moved(gk.SliderCrank(30, 90, 5))
    assert_equal(motion.slide("slot").acceleration, slider_crank.slide("slide").acceleration)
    assert_equal(motion.transmission_angle, slider_crank.transmission_angle)


@pytest.mark.parametrize("branch", [1, -1])
def test_motion_and_branches_are_those_of_a_block(branch):
    one, other = moved(SLOTTED, branch=branch), moved(BLOCK, branch=branch)
    for name in ("direction", "omega", "alpha"):
        assert_equal(getattr(one.lever, name), getattr(other.lever, name))
    for name in ("displacement", "velocity", "acceleration", "coriolis"):
        assert_equal(getattr(one.slide("slot"), name), getattr(other.slide("slot"), name))
    assert one.residual.max() < 1e-12


def loop(block):
    joints = GUIDES.items()
    if block:
        bodies = {**PLATE, **{f"on_{pin}": {pin: 0} for _, pin, *_ in GUIDES.values()}}
        sliders = tuple(gk.Slider(n, f"on_{pin}", along, 0j, *line) for n, (_, pin, along, *line) in joints)
        return gk.Linkage(bodies, "crank", sliders, estimate=ESTIMATE)
    return gk.Linkage(PLATE, "crank", estimate=ESTIMATE, slots=tuple(gk.PinInSlot(n, *rest) for n, rest in joints))


def test_slots_in_no_dyad_are_solved_as_loops():
    drive = np.linspace(0, 1.4, 15)
    one, other = moved(loop(block=False), drive), moved(loop(block=True), drive)
    assert one.assembled.all() and one.residual.max() < 1e-11
    assert_equal(one.plate.alpha, other.plate.alpha)
    assert_equal(one.transmission_angle, other.transmission_angle)
    loads = gk.Loads(forces=[gk.Force("plate", "P", 3 + 4j)], masses={"plate": gk.Mass(0.3, inertia=400)})
    forces = [gk.forces(motion, loads) for motion in (one, other)]
    assert_equal(forces[0].slide("q").normal, forces[1].slide("q").normal)


def test_the_pin_of_a_waiting_body_needs_an_estimate():
    with pytest.raises(DesignError) as refused:
        moved(replace(loop(block=False), estimate={"P": -40}))
    assert refused.value.field == "estimate" and "Q" in refused.value.problem


def test_the_driver_follows_from_virtual_power():
    motion = moved(SLOTTED)
    centre = motion.bodies["lever"].point(70)
    power = dot(LOADS.forces[0].force, motion.point("tip").velocity)
    for body, point in (("lever", centre), ("crank", motion.bodies["crank"].point(10))):
        mass, moving = LOADS.masses[body], motion.bodies[body]
        inertia_force = 1e-3 * mass.mass * (LOADS.gravity - point.acceleration)
        power = power + dot(inertia_force, point.velocity) - 1e-3 * mass.inertia * moving.alpha * moving.omega
    # Through the system of equations, which dry friction needs, with a coefficient that changes nothing.
    rough = replace(LOADS, friction=[gk.SlideFriction("slot", 1e-12)])
    for loads in (LOADS, rough):
        assert_equal(gk.forces(motion, loads).driver * SPEED, -power)


@pytest.mark.parametrize("coefficient", [0.0, 0.2])
def test_forces_are_those_of_a_block_without_mass(coefficient):
    loads = replace(LOADS, friction=[gk.SlideFriction("slot", coefficient)] if coefficient else [])
    one, other = (gk.forces(moved(linkage), loads) for linkage in (SLOTTED, BLOCK))
    assert_equal(one.driver, other.driver)
    assert_equal(one.slide("slot").normal, other.slide("slot").normal)
    assert_equal(one.pin("C", "lever"), other.pin("C", "lever"))
    assert not one.slide("slot").moment.any() and not one.undetermined


def test_friction_of_a_slot_has_no_length():
    with pytest.raises(DesignError) as refused:
        gk.forces(moved(SLOTTED), replace(LOADS, friction=[gk.SlideFriction("slot", 0.2, length=30)])).driver
    assert refused.value.field == "friction.length"


@pytest.mark.parametrize("by", ["crank.A.x", "slot.through.y", "slot.direction_deg", "ground.C.y"])
def test_sensitivities_are_those_of_a_block(by):
    one, other = moved(SLOTTED), moved(BLOCK)
    for of in ("tip", "lever_omega", "slot_acceleration", "transmission_angle"):
        assert_equal(one.sensitivity(of, by), other.sensitivity(of, by))


def test_play_in_the_slot_deviates_as_random_linkages_do():
    analysis = gk.tolerances(moved(SLOTTED), of="lever_angle", lengths=0, clearances={"slot": 0.2})
    assert list(analysis.contributions) == ["slot"]
    # The lever turns by half the play over the distance of the pin from the pivot.
    distance = np.abs(CRANK * np.exp(1j * DRIVE) - PIVOT)
    largest = np.abs(analysis.monte_carlo(2000).deviation).max(axis=1)
    assert largest == pytest.approx(analysis.worst_case, rel=0.01)
    along = np.sqrt(distance**2 - (5 * np.cos(np.radians(7))) ** 2)
    assert analysis.worst_case == pytest.approx(0.1 / along, rel=1e-3)


def test_arrays_of_linkages_move_as_each_of_them():
    cranks = np.array([20.0, 25.0, 30.0])
    many = moved(replace(SLOTTED, bodies={**LEVER, "crank": {"O": 0, "A": cranks}}))
    assert_equal(many.lever.alpha[:, 1], moved(SLOTTED).lever.alpha)


@pytest.mark.parametrize("change", [{"pin": "B"}, {"along": "plate"}, {"along": "crank"}, {"name": "guide"}])
def test_a_slot_of_wrong_names_is_refused(change):
    slot = gk.PinInSlot(**{"name": "slot", "body": "crank", "pin": "A", "along": "lever", **change})
    with pytest.raises(DesignError) as refused:
        gk.Linkage(LEVER, "crank", (gk.Slider("guide", "lever", "ground"),), slots=(slot,))
    assert refused.value.field == "slots"


def test_the_slot_is_cut_as_long_as_the_pin_travels():
    recipe = from_table(RECIPE)
    parts, stock = {part.name: part for part in recipe.parts}, recipe.stock
    (slot,) = (hole for hole in parts["lever"].holes if not isinstance(hole, Circle))
    # The pin from the pivot: its distance is 35 to 85 mm, of which 5 cos 7 deg is across the slot.
    across = 5 * np.cos(np.radians(7))
    travel = np.sqrt(85**2 - across**2) - np.sqrt(35**2 - across**2)
    points = slot.point(np.linspace(slot.breaks[0], slot.breaks[-1], 2001))
    length = np.ptp((points * np.exp(-1j * np.radians(7))).real)
    assert length == pytest.approx(travel + stock.hole_diameter, abs=0.02)
    assert "A" in {pin.name for pin in recipe.made.stack.pins if pin.slots == ("lever",) and pin.holes == ("crank",)}
    assert not recipe.made.stack.collisions


def test_the_pin_presses_on_its_hole_with_the_normal_force():
    table = {**RECIPE, "stock": {"material": "birch-plywood"}}
    recipe = from_table(table)
    aspect = next(aspect for aspect in recipe.aspects if aspect.key == "loads")
    pressures = dict(pin_pressures(aspect.analysis, recipe.made.stack, recipe.stock))
    area = recipe.stock.pin_diameter * recipe.stock.thickness
    assert pressures["A in the crank"] == pytest.approx(np.abs(aspect.analysis.slide("slot").normal) / area)


def test_table_and_scene_have_the_joint():
    recipe = from_table(RECIPE)
    ids = [column.id for column in recipe.table.columns]
    assert {"slot_displacement", "slot_velocity", "slot_acceleration", "slot_normal_force"} < {*ids}
    assert not {"slot_moment", "A_x"} & {*ids}
    marks = {(mark.sort, mark.label) for mark in recipe.scene.marks}
    assert ("pin", "A") in marks
    edited = next(handle for handle in recipe.handles if handle.id == "direction:slot")
    assert edited.keys == ("linkage.slots[0].direction_deg",)


def test_a_recipe_in_inches_is_the_same_linkage():
    bodies = {
        body: {point: [x / 25.4, y / 25.4] for point, (x, y) in points.items()}
        for body, points in RECIPE["linkage"]["bodies"].items()
    }
    slots = [{**RECIPE["linkage"]["slots"][0], "through": [0, 5 / 25.4]}]
    in_inches = {"kind": "linkage", "units": "in", "linkage": {"driver": "crank", "bodies": bodies, "slots": slots}}
    assert_equal(from_table(in_inches).motion.lever.alpha, from_table(RECIPE).motion.lever.alpha)


def test_the_torque_in_a_machine_is_that_of_a_block():
    slider = {"name": "slot", "body": "block", "along": "lever", "through": [0, 5], "direction_deg": 7}
    with_block = {
        "driver": "crank",
        "bodies": {**RECIPE["linkage"]["bodies"], "block": {"A": [0, 0]}},
        "sliders": [slider],
    }
    torques = []
    for linkage in (RECIPE["linkage"], with_block):
        placed = {"recipe": {**RECIPE, "linkage": linkage}, "angle_deg": 37, "upside_down": True}
        other = {
            "recipe": {"kind": "inverted-slider-crank", "linkage": {"ground": 20, "crank": 50}},
            "turned_by": "lever.crank",
        }
        drive = {"speed_rpm": 90}
        machine = from_table({"kind": "machine", "mechanisms": {"lever": placed, "other": other}, "drive": drive})
        torques.append(machine.torques.input)
    assert np.ptp(torques[0]) > 100
    assert_equal(*torques)

"""The table `[loads]` of a linkage's recipe: driver effort and joint forces in table, plots and summary."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk

BARS = {"ground": 100, "crank": 50, "coupler": 151, "rocker": 111}
MASSES = {
    "crank": {"mass_kg": 0.2, "centre": [20, 0], "inertia_kg_mm2": 100},
    "coupler": {"mass_kg": 0.5, "centre": [75.5, 0], "inertia_kg_mm2": 1210},
    "rocker": {"mass_kg": 0.4, "centre": [55.5, 0], "inertia_kg_mm2": 910},
}
DRIVE = {"speed_rpm": 95 * 30 / np.pi, "start_deg": 120, "end_deg": 240, "step_deg": 10}
STEEL = {"material": "steel-S235"}


def four_bar(loads, **more):
    return gk.load({"kind": "four-bar", "linkage": BARS, "drive": DRIVE, "loads": loads, **more})


def slider_crank(loads, **more):
    linkage = {"crank": 40, "coupler": 140, **more.pop("linkage", {})}
    return gk.load({"kind": "slider-crank", "linkage": linkage, "loads": loads, **more})


def problems(loads):
    """Key and id of each problem that is found when a recipe with these loads is read."""
    with pytest.raises(gk.RecipeError) as error:
        four_bar(loads)
    return [(found.key, found.id) for found in error.value.problems]


def test_the_driver_torque_is_that_of_an_independent_solution():
    """The torque of a reference case, which a multibody program reproduces to 5e-7."""
    recipe = four_bar({"masses": MASSES})
    assert recipe.table["driver_torque"][0] == pytest.approx(-3521.164809164, rel=1e-11)
    assert recipe.table.column("driver_torque").header == "driver_torque_N_mm"
    x, y, size = (recipe.table[f"crank_pin_force_on_coupler{end}"] for end in ("_x", "_y", ""))
    assert np.hypot(x, y) == pytest.approx(size, rel=1e-12) and size[0] == pytest.approx(125.713, abs=1e-3)


def test_the_weight_of_the_parts_is_the_potential_energy_that_the_driver_supplies():
    """At a crawl, the torque is the derivative of the height of all parts, weighed from their outlines."""
    crawl = DRIVE | {"speed_rpm": 1e-3, "step_deg": 0.25}
    recipe = four_bar({"gravity_m_per_s2": [3, -9.81]}, stock=STEEL, drive=crawl)
    motion, energy = recipe.motion, 0
    for name, mass in recipe.body_masses.items():
        place = motion.bodies[name].point(mass.centre).position
        energy = energy + mass.mass * (9.81 * place.imag - 3 * place.real)
    wanted = np.gradient(energy, motion.drive)[1:-1]
    assert recipe.table["driver_torque"][1:-1] == pytest.approx(wanted, abs=1e-4 * np.abs(wanted).max())
    # An entry replaces the mass of the parts.
    light = four_bar({"masses": {name: {"mass_kg": 0} for name in MASSES}}, stock=STEEL, drive=crawl)
    assert np.abs(light.table["driver_torque"]).max() == 0


def test_loads_add_up_and_a_doubled_load_doubles_the_torque():
    still = {"gravity_m_per_s2": [0, 0]}
    force = {"body": "rocker", "point": "rocker_pin", "force_n": [30, -20]}
    doubled = force | {"point": [111, 0], "force_n": [60, -40]}
    torque = {"body": "coupler", "torque_n_mm": 700}
    spring = {"body": "rocker", "point": "rocker_pin", "to_body": "ground", "to_point": [0, 300], "stiffness": 0.2}
    one, two, turned, sprung, all_of_them = (
        four_bar(still | loads).table["driver_torque"]
        for loads in (
            {"forces": [force]},
            {"forces": [doubled]},
            {"torques": [torque]},
            {"springs": [spring]},
            {"forces": [force], "torques": [torque], "springs": [spring]},
        )
    )
    assert two == pytest.approx(2 * one, rel=1e-12)
    assert all_of_them == pytest.approx(one + turned + sprung, rel=1e-10)
    # Virtual work: the driver supplies what the spring's tension and the load take.
    motion = four_bar(still | {"springs": [spring]}).motion
    length = np.abs(motion.point("rocker_pin").position - 300j)
    slope = np.real(np.conj(motion.point("rocker_pin").position - 300j) * motion.point("rocker_pin").first) / length
    assert sprung == pytest.approx(0.2 * length * slope, rel=1e-10)
    assert turned == pytest.approx(-700 * motion.coupler.first, rel=1e-10)


def test_springs_of_all_sorts_store_the_work_of_the_driver():
    """The torque is the derivative of the energy: of twist squared, and of a gas at constant temperature."""
    fine = DRIVE | {"speed_rpm": 1e-3, "step_deg": 0.25}
    ends = {"body": "rocker", "point": "rocker_pin", "to_body": "ground", "to_point": [0, 300]}
    gas = {"gas_springs": [ends | {"force": 100, "extended": 400, "gas_length": 500}]}
    torsion = {"torsion_springs": [{"body": "rocker", "to_body": "coupler", "stiffness": 500, "free_angle_deg": 30}]}
    motion = four_bar(gas, drive=fine).motion
    compression = 400 - np.abs(motion.point("rocker_pin").position - 300j)
    twist = np.unwrap(np.angle(motion.rocker.direction / motion.coupler.direction)) - np.pi / 6
    twist -= 2 * np.pi * np.round(twist[0] / (2 * np.pi))
    assert compression.min() > 0
    for loads, energy in ((gas, -100 * 500 * np.log(1 - compression / 500)), (torsion, 250 * twist**2)):
        wanted = np.gradient(energy, motion.drive)[1:-1]
        torque = four_bar(loads, drive=fine).table["driver_torque"][1:-1]
        assert torque == pytest.approx(wanted, abs=1e-4 * np.abs(wanted).max())


def test_a_slide_that_drives_needs_a_force_and_its_guide_carries_the_weight():
    """A crosshead that creeps: its guide carries its weight, and rubs with a tenth of it."""
    block = {"masses": {"slider": {"mass_kg": 2}}}
    friction = {"slide_friction": [{"slide": "slide", "coefficient": 0.1}]}
    slow = {"stroke": {"start": 110, "end": 170, "speed": 1e-3}, "linkage": {"driver": "slider"}}
    free, rubbing = slider_crank(block, **slow).table, slider_crank(block | friction, **slow).table
    assert free["driver_force"] == pytest.approx(0, abs=1e-9)
    assert rubbing["driver_force"] == pytest.approx(0.1 * 2 * 9.81, rel=1e-9)
    assert free["slide_normal_force"] == pytest.approx(2 * 9.81, rel=1e-9)
    pushed = slider_crank({"slide_forces": [{"slide": "slide", "force_n": -100}]}, **slow)
    assert pushed.table["driver_force"] == pytest.approx(100, rel=1e-9)


def test_friction_of_a_pin_makes_the_driver_work_more():
    force = {"forces": [{"body": "rocker", "point": "rocker_pin", "force_n": [0, -50]}]}
    friction = {"pin_friction": [{"pin": "rocker_pin", "coefficient": 0.2, "radius": 3}]}
    turn = {"speed_rpm": 60, "step_deg": 2}
    linkage = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
    without, with_friction = (
        gk.load({"kind": "four-bar", "linkage": linkage, "drive": turn, "loads": loads}).aspect("loads").analysis
        for loads in (force, force | friction)
    )
    # Over a turn the weight gives back what it took.
    assert abs(without.work) < 1e-6 * np.abs(without.driver).max()
    assert with_friction.work > 0.01 * np.abs(without.driver).max()


def test_the_summary_has_peak_and_mean_and_the_page_has_plots():
    recipe = four_bar({"masses": MASSES})
    loads, torque = recipe.notes["loads"], recipe.table["driver_torque"]
    effort = loads["driver_torque_N_mm"]
    peak = np.argmax(np.abs(torque))
    # Between two rows.
    assert 0 <= effort["peak"] / torque[peak] - 1 < 1e-3 and effort["peak_at_deg"] == pytest.approx(
        120 + 10 * peak, abs=10
    )
    # The mean of the squares between the rows too, by steps of 0.1 deg.
    drive = dataclasses.replace(recipe.drive, step_deg=0.1)
    fine = dataclasses.replace(recipe, drive=drive).table["driver_torque"]
    assert effort["rms"] == pytest.approx(np.sqrt(np.trapezoid(fine**2) / (len(fine) - 1)), rel=1e-4)
    for pin, force in loads["largest_pin_force_N"].items():
        sizes = [
            recipe.table[id] for id in recipe.table.ids if id.startswith(f"{pin}_force") and id[-2:] not in ("_x", "_y")
        ]
        assert 0 <= force / max(map(np.max, sizes)) - 1 + 1e-8 < 0.01
    assert len(loads["largest_pin_force_N"]) == 4 and loads["undetermined"] == []
    plotted = {id for plot in recipe.scene.plots for id in plot.columns}
    assert {"driver_torque", "crank_pin_force_on_coupler", "rocker_pivot_force_on_rocker"} <= plotted


def test_arrows_at_the_pins_are_the_forces_of_the_table_at_one_scale():
    recipe = four_bar({"masses": MASSES}, drive=DRIVE | {"end_deg": 480})
    arrows = {mark.label.split(" force, ")[0]: mark for mark in recipe.scene.marks if mark.role == "force"}
    assert len(arrows) == 4
    scales = []
    for name, mark in arrows.items():
        pin, _, body = name.partition(" on ")
        assert mark.place == pytest.approx(recipe.motion.point(pin).position)
        x, y = (recipe.table[f"{pin}_force_on_{body}_{axis}"] for axis in "xy")
        ratio = mark.vector / (x + 1j * y)
        # The longest arrows are shortened, none is turned.
        assert np.abs(ratio.imag).max() < 1e-9 * np.abs(ratio).max()
        scales.append(ratio.real.max())
    assert scales == pytest.approx([scales[0]] * 4, rel=1e-9)


def test_where_the_linkage_is_open_forces_are_unknown_and_the_summary_leaves_them_out():
    linkage = {"ground": 100, "crank": 60, "coupler": 70, "rocker": 60}
    turn, loads = {"step_deg": 5}, {"masses": {"coupler": {"mass_kg": 1}}}
    recipe = gk.load({"kind": "four-bar", "linkage": linkage, "drive": turn, "loads": loads})
    known = np.isfinite(recipe.table["driver_torque"])
    assert known.any() and not known[~recipe.motion.assembled].any()
    torque = recipe.table["driver_torque"][known]
    assert abs(recipe.notes["loads"]["driver_torque_N_mm"]["peak"]) == pytest.approx(np.abs(torque).max())


def test_loads_that_do_nothing_are_refused():
    """Such as gravity alone, if the material was forgotten."""
    with pytest.raises(gk.DesignError) as error:
        four_bar({}).table
    assert (error.value.field, error.value.id) == ("loads", "missing-key")


def test_a_scaled_linkage_under_the_same_forces_has_the_same_joint_forces():
    loads = {
        "gravity_m_per_s2": [0, 0],
        "forces": [{"body": "rocker", "point": "rocker_pin", "force_n": [0, -50]}],
        "springs": [{"body": "rocker", "point": [55, 0], "to_body": "ground", "to_point": [0, 300], "stiffness": 0.2}],
        "pin_friction": [{"pin": "crank_pin", "coefficient": 0.2, "radius": 3}],
    }
    one, two = four_bar(loads), four_bar(loads, scale=2)
    assert two.loads.forces[0] == one.loads.forces[0] and two.loads.springs[0].point == 110
    assert two.table["driver_torque"] == pytest.approx(2 * one.table["driver_torque"], rel=1e-9)
    name = "rocker_pin_force_on_rocker"
    assert two.table[name] == pytest.approx(one.table[name], rel=1e-9)


def test_every_key_survives_writing_and_reading():
    loads = {
        "gravity_m_per_s2": [9.81, 0],
        "masses": MASSES,
        "forces": [{"body": "coupler", "point": [1, -2], "force_n": [3, 4]}],
        "torques": [{"body": "rocker", "torque_n_mm": -5}],
        "springs": [{"body": "rocker", "point": "rocker_pin", "to_body": "ground", "to_point": [0, 300], "preload": 6}],
        "pin_friction": [{"pin": "crank_pin", "viscous": 7}],
        "motor": "37d-30",
    }
    loads["forces"].append({"body": "coupler", "point": [1, 2], "over_deg": [[0, 1, 2], [90, 3, 4]]})
    recipe = four_bar(loads)
    again = gk.load(gk.recipe.to_toml(recipe))
    assert again == recipe and again.loads.forces[0].point == 1 - 2j


def test_a_force_over_the_drive_is_the_same_at_each_angle_as_a_constant_one():
    """At angles of the table and between them, also a turn later; at two equal angles the force makes a step."""
    rows = [[0, 0, 0], [90, 30, -10], [180, 0, 0], [180, 50, 0], [270, 50, 0]]
    turn = {"speed_rpm": 60, "step_deg": 15, "start_deg": -360, "end_deg": 360}
    linkage = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}

    def torque(**force):
        loads = {"gravity_m_per_s2": [0, 0], "forces": [{"body": "coupler", "point": [40, 20], **force}]}
        return gk.load({"kind": "four-bar", "linkage": linkage, "drive": turn, "loads": loads}).table["driver_torque"]

    varying = torque(over_deg=rows)
    for angle, force in ((0, None), (45, [15, -5]), (90, [30, -10]), (150, [10, -10 / 3]), (225, [50, 0])):
        constant = torque(force_n=force) if force else np.zeros(49)
        for frame in ((360 + angle) // 15, angle // 15):
            assert varying[frame] == pytest.approx(constant[frame], rel=1e-9, abs=1e-9)
    assert varying == pytest.approx(torque(over_deg=rows, force_n=[0, 5]) - torque(force_n=[0, 5]), abs=1e-9)


ROWS = [[0, 0], [90, 300], [180, -120], [180, 50], [270, 50]]
OVER = np.array([0, 15, 45, 90, 150, 200, 300])
# Between the rows, and from the last back to the first a turn later.
LOAD = np.array([0, 50, 150, 300, 20, 50, 100 / 3])


def test_a_torque_over_the_drive_needs_its_virtual_power():
    turn = {"speed_rpm": 60, "step_deg": 15}
    load = {"torques": [{"body": "rocker", "over_deg": ROWS}], "gravity_m_per_s2": [0, 0]}
    bars = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
    for scale in (1, 2):
        recipe = gk.load({"kind": "four-bar", "linkage": bars, "drive": turn, "loads": load, "scale": scale})
        table, frames = recipe.table, OVER // 15
        ratio = table["rocker_omega"][frames] / (2 * np.pi)
        assert table["driver_torque"][frames] == pytest.approx(-scale * LOAD * ratio, rel=1e-9, abs=1e-9)


def test_a_gas_force_over_the_drive_needs_its_virtual_power():
    recipe = slider_crank(
        {"slide_forces": [{"slide": "slide", "force_n": 7, "over_deg": ROWS}], "gravity_m_per_s2": [0, 0]},
        drive={"speed_rpm": 60, "step_deg": 15},
    )
    table, frames = recipe.table, OVER // 15
    ratio = table["slide_velocity"][frames] / (2 * np.pi)
    assert table["driver_torque"][frames] == pytest.approx(-(LOAD + 7) * ratio, rel=1e-9, abs=1e-9)


STROKE_ROWS = [[110, 0], [130, 300], [150, -120], [150, 50]]


@pytest.mark.parametrize("units", [1, 25.4])
def test_loads_over_the_stroke_of_a_driving_slide_need_its_virtual_power(units):
    """Against the crank as it turns, and along the slide itself; before the first row and beyond the last it is constant."""
    rows = [[place / units, load] for place, load in STROKE_ROWS]
    loads = {"slide_forces": [{"slide": "slide", "force_n": 7, "over_stroke": rows}], "gravity_m_per_s2": [0, 0],
             "torques": [{"body": "crank", "over_stroke": rows}],
             "forces": [{"body": "slider", "point": "slider_pin", "over_stroke": [[110 / units, 1, 2], [160 / units, 11, 2]]}]}  # fmt: skip
    table = gk.load({"kind": "slider-crank", "linkage": {"crank": 40 / units, "coupler": 140 / units, "driver": "slider"},
                     "stroke": {"start": 106 / units, "end": 176 / units, "step": 5 / units, "speed": 10 / units},
                     "loads": loads, "units": "mm" if units == 1 else "in"}).table  # fmt: skip
    at = np.arange(106, 177, 5)
    load = np.interp(at, [110, 130, 150 - 1e-9, 150], [0, 300, -120, 50])
    along = np.interp(at, [110, 160], [1, 11])
    ratio = table["crank_omega"] / 10
    known = np.isfinite(table["driver_force"])
    assert known.sum() > 10
    assert table["driver_force"][known] == pytest.approx(
        (-(load + 7) - along - load * ratio)[known], rel=1e-6, abs=1e-6
    )


@pytest.mark.parametrize(
    ("rows", "sliding", "key"),
    [({"over_deg": ROWS}, True, "over_deg"), ({"over_stroke": ROWS}, False, "over_stroke"),
     ({"over_stroke": STROKE_ROWS[::-1]}, True, "over_stroke")],
)  # fmt: skip
def test_rows_over_the_drive_of_another_driver_are_refused_by_name(rows, sliding, key):
    more = {"stroke": {"start": 110, "end": 170}, "linkage": {"driver": "slider"}} if sliding else {}
    with pytest.raises(gk.RecipeError) as refused:
        slider_crank({"slide_forces": [{"slide": "slide", **rows}]}, **more)
    assert [problem.key for problem in refused.value.problems] == [f"loads.slide_forces[0].{key}"]


def test_the_motor_is_the_one_named_or_mounted_or_the_smallest_that_suffices():
    weight = {"forces": [{"body": "rocker", "point": "rocker_pin", "force_n": [0, -10]}]}
    turn = {"drive": {"speed_rpm": 60}, "linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}}

    def motor(loads, **more):
        recipe = gk.load({"kind": "four-bar", **turn, "loads": weight | loads, **more})
        (check,) = [check for check in recipe.checks if check.id == "motor_torque"]
        return recipe, check

    recipe, check = motor({})
    duty = recipe.aspect("loads").duty
    lighter = [one for one in gk.making.MOTORS.values() if one.mass_g < recipe.aspect("loads").motor.mass_g]
    assert check.passed and check.value >= 1.5 and lighter and all(one.margin(duty) < 1.5 for one in lighter)
    assert recipe.notes["loads"]["motor"] == {
        "motor": next(key for key, one in gk.making.MOTORS.items() if one == recipe.aspect("loads").motor),
        "name": recipe.aspect("loads").motor.name,
        "margin": pytest.approx(check.value, rel=1e-5),
    }
    weak, check = motor({"motor": "28byj-48"})
    assert (
        weak.aspect("loads").motor.name.startswith("28BYJ-48")
        and not check.passed
        and recipe.aspect("loads").motor.name in check.advice
    )
    own = {"name": "own", "torque_n_mm": 4000, "speed_rpm": 120, "lasting_torque_n_mm": 5000, "mass_g": 1}
    recipe, check = motor({"motor": own}, scale=2)
    # At half of the speed without load half of the torque is left, for twice the torque of the smaller linkage.
    assert check.value == pytest.approx(2000 / (2 * duty.peak_torque), rel=1e-9)
    assert motor({}, stock={"motor": "nema17"})[0].aspect("loads").motor == gk.making.motor("nema17")
    with pytest.raises(gk.RecipeError, match="shaft"):
        loads = {"masses": {"slider": {"mass_kg": 1}}, "motor": "nema17"}
        slider_crank(loads, stroke={"start": 110, "end": 170}, linkage={"driver": "slider"})


def test_pins_and_plates_are_checked_if_the_material_is_known():
    force = {"forces": [{"body": "rocker", "point": "rocker_pin", "force_n": [0, -50]}]}
    holds = {"pin_shear", "pin_pressure", "plate_stress"}
    recipe = four_bar(force, stock=STEEL)
    checks = {check.id: check for check in recipe.checks}
    assert holds <= set(checks) and not holds & {check.id for check in four_bar(force).checks}
    at = [abs(value - checks["pin_pressure"].at) for value in np.degrees(recipe.motion.drive)]
    largest = max(abs(recipe.aspect("loads").analysis.pin(pin, body)).max() for pin, body in
                  [("crank_pivot", "crank"), ("rocker_pivot", "rocker"), ("crank_pin", "crank"), ("rocker_pin", "rocker"),
                   ("crank_pin", "coupler"), ("rocker_pin", "coupler")])  # fmt: skip
    assert min(at) < 1e-9 and checks["pin_pressure"].value == pytest.approx(largest / (4 * 3))


PIN_TO_PIN = {"body": "rocker", "point": "rocker_pin", "to_body": "coupler", "to_point": "rocker_pin", "stiffness": 1}


@pytest.mark.parametrize(
    ("loads", "key", "id"),
    [
        ({"gravity_m_per_s2": [0, -9810], "masses": MASSES}, "loads.gravity_m_per_s2[1]", "out-of-range"),
        ({"forces": [{"body": "rocker", "point": "pen", "force_n": [0, 1]}]}, "loads.forces[0].point", "unknown-key"),
        ({"forces": [{"body": "rod", "point": "pen", "force_n": [0, 1]}]}, "loads.forces[0].body", "unknown-key"),
        ({"torques": [{"body": "rod", "torque_n_mm": 1}]}, "loads.torques[0].body", "unknown-key"),
        ({"slide_forces": [{"slide": "slide", "force_n": 1}]}, "loads.slide_forces[0].slide", "unknown-key"),
        ({"pin_friction": [{"pin": "pen"}]}, "loads.pin_friction[0].pin", "unknown-key"),
        ({"slide_friction": [{"slide": "slide"}]}, "loads.slide_friction[0].slide", "unknown-key"),
        ({"masses": {"rod": {"mass_kg": 1}}}, "loads.masses", "unknown-key"),
        ({"masses": {"rocker": {"mass_kg": -1}}}, "loads.masses.rocker.mass_kg", "out-of-range"),
        ({"forces": [{"body": "rocker", "point": "rocker_pin", "force": 1}]}, "loads.forces[0].force", "unknown-key"),
        ({"forces": [{"body": "rocker", "point": "rocker_pin"}]}, "loads.forces[0].force_n", "missing-key"),
        ({"torques": [{"body": "rocker"}]}, "loads.torques[0].torque_n_mm", "missing-key"),
        ({"torques": [{"body": "rocker", "over_deg": [[0, 1], [400, 1]]}]}, "loads.torques[0].over_deg", "conflict"),
        ({"motor": "nema99"}, "loads.motor", "impossible-geometry"),
        (
            {"forces": [{"body": "rocker", "point": "rocker_pin", "over_deg": [[0, 1, 1], [-90, 2, 2]]}]},
            "loads.forces[0].over_deg",
            "conflict",
        ),
        # Both ends are at one pin, apart from rounding.
        ({"springs": [PIN_TO_PIN]}, "loads.springs[0]", "impossible-geometry"),
        ({"torsion_springs": [{"body": "rod", "to_body": "rocker"}]}, "loads.torsion_springs[0].body", "unknown-key"),
        (
            {"torsion_springs": [{"body": "rocker", "to_body": "rod"}]},
            "loads.torsion_springs[0].to_body",
            "unknown-key",
        ),
        (
            {"torsion_springs": [{"body": "rocker", "to_body": "rocker"}]},
            "loads.torsion_springs[0].to_body",
            "conflict",
        ),
    ],
)
def test_a_load_that_the_linkage_cannot_have_is_refused_by_its_key(loads, key, id):
    assert (key, id) in problems(loads)


@pytest.mark.parametrize("table", [{"loads": {}}, {"both_modes": True}, {"tolerances": {"of": "C"}}])
def test_bodies_that_no_driver_moves_are_refused_by_their_key_below_the_linkage(table):
    bodies = {"ground": {"A": [0, 0]}, "crank": {"A": [0, 0], "B": [30, 0]}, "bar": {"B": [30, 0], "C": [70, 50]}}
    with pytest.raises(gk.RecipeError) as error:
        gk.load({"kind": "linkage", "linkage": {"driver": "crank", "bodies": bodies}, **table})
    assert [found.key for found in error.value.problems] == ["linkage.bodies"]


def test_an_unknown_key_about_loads_names_their_table():
    with pytest.raises(gk.RecipeError, match=r"\[loads\]"):
        gk.load({"kind": "four-bar", "linkage": BARS, "gravity": 9.81})
    with pytest.raises(gk.RecipeError) as error:
        gk.load({"kind": "spur-gear", "gear": {"teeth": 24, "module": 2}, "torque": 9.81})
    assert "[loads]" not in str(error.value)


def test_the_shaking_force_is_minus_the_rate_of_momentum_of_all_masses():
    """Second differences of the centres of mass over time; the moment is about the crank's pivot."""
    recipe = four_bar({"masses": MASSES}, drive=DRIVE | {"end_deg": 124, "step_deg": 0.01})
    table, force, moment = recipe.table, 0, 0
    step = table["time"][1] - table["time"][0]
    for name, mass in MASSES.items():
        body = recipe.motion.bodies[name]
        place = body.point(complex(*mass["centre"])).position
        acceleration = np.diff(place, 2) / step**2
        turning = np.diff(np.unwrap(np.angle(body.direction)), 2) / step**2
        force = force - 1e-3 * mass["mass_kg"] * acceleration
        moment = moment - 1e-3 * mass["mass_kg"] * np.imag(np.conj(place[1:-1]) * acceleration)
        moment = moment - 1e-3 * mass["inertia_kg_mm2"] * turning
    assert table["shaking_force_x"][1:-1] == pytest.approx(force.real, rel=1e-4)
    assert table["shaking_force_y"][1:-1] == pytest.approx(force.imag, rel=1e-4)
    assert table["shaking_force"][1:-1] == pytest.approx(np.abs(force), rel=1e-4)
    assert table["shaking_moment"][1:-1] == pytest.approx(moment, rel=1e-3)


def test_the_torque_of_the_shaft_changes_the_energy_of_all_copies_that_the_scene_shows():
    recipe = gk.load({
        "kind": "four-bar",
        "linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70},
        "drive": {"speed_rpm": 60, "step_deg": 0.5},
        "copies": [{"phase_deg": 75}, {"phase_deg": 40, "mirrored": True}],
        "loads": {"masses": MASSES | {"coupler": {"mass_kg": 0.5, "centre": [60, 20], "inertia_kg_mm2": 900}},
                  "gravity_m_per_s2": [3, -9], "motor": "nema23"},
    })  # fmt: skip
    shown, time = recipe.scene, recipe.table["time"]
    energy = np.zeros(len(time))
    for number in (1, 2, 3):
        mirrored = number == 3
        for name, mass in recipe.loads.masses.items():
            (body,) = (b for b in shown.bodies if b.name == (name if number == 1 else f"{name}, copy {number}"))
            centre = -np.conj(mass.centre) if mirrored else mass.centre
            place = body.origin + body.direction * centre
            speed = np.gradient(place, time)
            spin = np.gradient(np.unwrap(np.angle(body.direction)), time)
            energy += mass.mass_kg * (np.abs(speed) ** 2 / 2 - 1000 * np.real(place * np.conj(3 - 9j)))
            energy += mass.inertia_kg_mm2 * spin**2 / 2
    # kg mm2/s2 is 1e-3 N mm. Differences at the first and last frames are one-sided.
    torque = 1e-3 * np.gradient(energy, np.radians(0.5))
    known = slice(4, -4)
    assert recipe.table["shaft_torque"][known] == pytest.approx(torque[known], abs=2e-4 * np.abs(torque).max())
    (check,) = (check for check in recipe.checks if check.id == "motor_torque")
    assert check.value <= 1260 / np.abs(recipe.table["shaft_torque"]).max() and check.column == "shaft_torque"


def test_copies_half_a_turn_apart_balance_the_weight_of_their_cranks():
    masses = {"crank": MASSES["crank"]}
    turn = {"linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}, "copies": [{"phase_deg": 180}]}
    table = gk.load({"kind": "four-bar", **turn, "loads": {"masses": masses}}).table
    assert np.abs(table["shaft_torque"]).max() < 1e-9 < np.abs(table["driver_torque"]).max()


def test_power_and_work_of_a_pump_and_its_flywheel_are_those_of_its_force():
    """20 N against the slider: the work is the force by the way; a disc of the sheet has the flywheel's inertia."""
    force = {"forces": [{"body": "slider", "point": "slider_pin", "force_n": [20, 0]}]}
    turn = {"speed_rpm": 120, "step_deg": 5}
    stock = {"thickness": 4, "material": "steel-S235"}
    pump = {"kind": "slider-crank", "linkage": {"crank": 20, "coupler": 70}, "drive": turn, "stock": stock,
            "loads": {**force, "gravity_m_per_s2": [0, 0], "speed_fluctuation": 0.02, "masses": {body: {"mass_kg": 0} for body in ("crank", "coupler", "slider")}}}  # fmt: skip
    recipe = gk.load(pump)
    loads, table = recipe.notes["loads"], recipe.table
    angle = np.radians(table["crank_angle"])
    root = np.sqrt(70**2 - (20 * np.sin(angle)) ** 2)
    torque = 20 * (20 * np.sin(angle) * (1 + 20 * np.cos(angle) / root))
    assert table["input_power"] == pytest.approx(1e-3 * torque * 4 * np.pi, abs=1e-9)
    assert loads["work_N_mm"] == pytest.approx(0, abs=1e-6) and loads["mean_power_W"] == pytest.approx(0, abs=1e-9)
    # The slider takes 20 N by 40 mm and gives it back.
    wheel = loads["flywheel"]
    assert wheel["inertia_kg_mm2"] == pytest.approx(1e3 * 800 / (0.02 * (4 * np.pi) ** 2), rel=1e-4)
    mass = np.pi / 4 * wheel["disc_diameter_mm"] ** 2 * 4 * 7850e-9
    assert wheel["disc_mass_kg"] == pytest.approx(mass, rel=1e-6)
    # The diameter is rounded up to four digits.
    assert 1 <= mass * wheel["disc_diameter_mm"] ** 2 / 8 / wheel["inertia_kg_mm2"] < 1.005


def test_friction_locks_a_pump_near_its_dead_centres():
    """At 2 deg a load that drives the crank takes less than friction, the couple of each pin by its relative rotation."""
    pins = [{"pin": pin, "coefficient": 0.15, "radius": 5} for pin in ("crank_pivot", "crank_pin", "slider_pin")]
    loads = {"forces": [{"body": "slider", "point": "slider_pin", "force_n": [-100, 0]}], "pin_friction": pins}
    pump = {"kind": "slider-crank", "linkage": {"crank": 40, "coupler": 140}, "drive": {"step_deg": 2},
            "loads": {"gravity_m_per_s2": [0, 0], **loads}}  # fmt: skip
    recipe = gk.load(pump)
    locked, torque = recipe.table["self_locking"], recipe.table["driver_torque"]
    turned = 40 * np.cos(np.radians(2)) / 140
    couple = 100 * 5 * np.sin(np.arctan(0.15))
    without = -100 * 40 * np.sin(np.radians(2)) * (1 + turned)
    assert torque[1] == pytest.approx(without + couple * (1 + (1 + turned) + turned), abs=0.1) and torque[1] > 0
    assert locked[1] == 1 and locked[45] == 0
    assert recipe.notes["loads"]["self_locking_percent"] == pytest.approx(100 * locked.mean(), rel=1e-5)


@pytest.mark.parametrize("drive", [{"end_deg": 200}, {"acceleration_rad_per_s2": 3}])
def test_a_flywheel_without_a_whole_turn_at_a_constant_speed_is_refused(drive):
    pump = {"kind": "slider-crank", "linkage": {"crank": 40, "coupler": 140}, "drive": drive,
            "loads": {"masses": {"slider": {"mass_kg": 1}}, "speed_fluctuation": 0.02}}  # fmt: skip
    with pytest.raises(gk.RecipeError) as refused:
        gk.load(pump)
    assert [problem.key for problem in refused.value.problems] == ["loads.speed_fluctuation"]

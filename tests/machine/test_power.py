"""Power through whole machines against the virtual power of all their bodies, and the losses of their gears."""

import tomllib

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import DesignError
from geomkin.recipe.load import from_table
from tests.texts import template_of

GRAVITY = -9810j
PAIR = {"kind": "gear-pair", "first": {"teeth": 12, "module": 2, "profile_shift": 0.3}, "second": {"teeth": 24, "module": 2}}  # fmt: skip
PUMP = {"kind": "slider-crank", "linkage": {"crank": 20, "coupler": 70}, "drive": {"step_deg": 1},
        "loads": {"forces": [{"body": "slider", "point": "slider_pin", "force_n": [10, 0]}]}}  # fmt: skip


def random_machine(rng):
    """A tree of pairs, each with linkages on its gears, some mirrored, under masses, forces and gravity."""
    modules, mechanisms = {}, {}
    for k in range(int(rng.integers(1, 3))):
        teeth = rng.choice([12, 16, 24, 36], 2)
        shafts = [f"pair{j}.second" for j in range(k)]
        first, second = ({"teeth": int(z), "module": 2, "profile_shift": 0.3 * (z == 12)} for z in teeth)
        mechanisms[f"pair{k}"] = {"recipe": {"kind": "gear-pair", "first": first, "second": second}}
        if shafts:
            mechanisms[f"pair{k}"]["turned_by"] = shafts[-1]
        modules[k] = teeth
    for k in range(int(rng.integers(1, 4))):
        if rng.random() < 0.5:
            linkage = {"crank": rng.uniform(10, 25), "coupler": rng.uniform(60, 90)}
            kind, output, spring = "slider-crank", "slider", "slider_pin"
        else:
            linkage = {"ground": 120, "crank": rng.uniform(15, 30), "coupler": rng.uniform(95, 105), "rocker": 70}
            kind, output, spring = "four-bar", "rocker", "rocker_pin"
        mass = {body: {"mass_kg": rng.uniform(0, 1), "centre": rng.uniform(-20, 40, 2).tolist(),
                       "inertia_kg_mm2": rng.uniform(0, 500)} for body in ("crank", "coupler", output)}  # fmt: skip
        force = {"body": output, "point": spring, "force_n": rng.uniform(-50, 50, 2).tolist()}
        recipe = {"kind": kind, "linkage": linkage, "drive": {"step_deg": 30},
                  "loads": {"masses": mass, "forces": [force]}}  # fmt: skip
        pair = int(rng.integers(len(modules)))
        mechanisms[f"body{k}"] = {
            "recipe": recipe, "turned_by": f"pair{pair}.{rng.choice(['first', 'second'])}",
            "phase_deg": float(rng.integers(-180, 180)), "angle_deg": float(rng.integers(-180, 180)),
            "mirrored": bool(rng.random() < 0.5),
        }  # fmt: skip
    return gk.load({"kind": "machine", "mechanisms": mechanisms,
                    "drive": {"speed_rpm": float(rng.choice([-1, 1]) * rng.uniform(20, 400))}})  # fmt: skip


def virtual_power(machine, turns):
    """Power of inertia less that of weights and forces, N mm/s, of all moving bodies of a machine in the world."""
    total = 0.0
    for name, mechanism in machine.mechanisms.items():
        recipe = mechanism.recipe
        if not hasattr(recipe, "linkage"):
            continue
        rate = float(machine.graph.speeds[name])
        speed = rate * machine.drive.speed_rpm * np.pi / 30
        turn = 2 * np.pi * rate * turns + np.radians(mechanism.phase_deg)
        motion = gk.move(recipe.linkage, np.remainder(turn, 2 * np.pi), 1, speed=speed)
        gravity = GRAVITY * np.exp(-1j * np.radians(mechanism.angle_deg))
        gravity = -np.conj(gravity) if mechanism.mirrored else gravity
        for body, mass in recipe.loads.masses.items():
            pose = motion.bodies[body]
            arm = pose.direction * mass.centre
            velocity = pose.origin.velocity + 1j * pose.omega * arm
            acceleration = pose.origin.acceleration + (1j * pose.alpha - pose.omega**2) * arm
            pull = 1e-3 * mass.mass_kg * (acceleration - gravity)
            total = total + (np.conj(pull) * velocity).real + 1e-3 * mass.inertia_kg_mm2 * pose.alpha * pose.omega
        for force in recipe.loads.forces:
            total = total - (np.conj(complex(*force.force_n)) * motion.point(force.point).velocity).real
    return total


@pytest.mark.parametrize("seed", range(10))
def test_power_of_the_driver_is_the_virtual_power_of_all_bodies(seed):
    """Ten machines each, at 40 positions."""
    for number in range(10):
        machine = random_machine(np.random.default_rng([seed, number]))
        turns = np.linspace(0, float(machine.graph.period), 40) * np.sign(machine.drive.speed_rpm)
        power = virtual_power(machine, turns)
        torque = machine.torques.input_at(turns)
        ours = torque * machine.drive.speed_rpm * np.pi / 30
        assert ours == pytest.approx(power, abs=1e-10 * np.abs(power).max())


def lifted(friction, speed=60):
    train = {"kind": "gear-train", "train": {"stages": [[12, 36], [12, 48]], "module": 1, "friction": friction}}
    pump = {"recipe": PUMP, "turned_by": "train.driven_2"}
    return gk.load({"kind": "machine", "mechanisms": {"train": {"recipe": train}, "pump": pump},
                    "drive": {"speed_rpm": speed}})  # fmt: skip


@pytest.mark.parametrize("speed", [60, -60])
def test_gears_lose_power_in_either_direction_by_the_efficiency_of_their_train(speed):
    ideal, real = lifted(0.0, speed).torques.input, lifted(0.1, speed)
    efficiency = real.recipes["train"].design.efficiency
    assert 0.9 < efficiency < 1
    forwards = ideal * speed > 0
    assert forwards.any() and not forwards.all()
    assert real.torques.input == pytest.approx(np.where(forwards, ideal / efficiency, ideal * efficiency), rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "body"), [("gear-pair", "second"), ("internal-gear-pair", "ring"), ("planetary", "carrier")]
)
def test_friction_of_gears_raises_the_torque_of_the_driver_by_their_efficiency(kind, body):
    def torque(friction):
        table = {**tomllib.loads(template_of(kind)), "friction": friction}
        pump = {"recipe": PUMP, "turned_by": f"gears.{body}"}
        machine = gk.load({"kind": "machine", "mechanisms": {"gears": {"recipe": table}, "pump": pump}})
        notes = str(machine.recipes["gears"].notes)
        return machine.torques.input, machine.recipes["gears"].efficiency, "'efficiency'" in notes

    (ideal, none, hidden), (real, efficiency, shown) = torque(0.0), torque(0.1)
    assert 0.9 < efficiency < 1 == none and shown and not hidden
    assert real == pytest.approx(np.where(ideal > 0, ideal / efficiency, ideal * efficiency), rel=1e-12)


def test_summary_of_a_machine_has_its_loads():
    """10 N on a stroke of 40 mm, there and back: no work, 5/6 of the power by the force on the way against it."""
    pair = PAIR | {"first_stock": {"material": "steel-S235"}, "second_stock": {"material": "steel-S235"}}
    pump = {"recipe": PUMP, "turned_by": "pair.second"}
    machine = gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, "pump": pump}})
    loads = machine.notes["loads"]
    turn = np.linspace(0, 2 * np.pi, 100_001)
    x = 20 * np.cos(turn) + np.sqrt(70**2 - 400 * np.sin(turn) ** 2)
    torque = 10 * np.gradient(x, turn)
    torques = loads["driver_torques_N_mm"]
    assert torques["pump"] == pytest.approx(np.abs(torque).max(), rel=1e-4)
    assert abs(loads["input_torque_N_mm"]["peak"]) == pytest.approx(np.abs(torque).max() / 2, rel=1e-4)
    assert loads["input_torque_N_mm"]["rms"] == pytest.approx(np.sqrt(np.mean(torque**2)) / 2, rel=1e-4)
    assert loads["work_N_mm"] == pytest.approx(0, abs=1e-3 * 400)
    assert loads["largest_power_W"] == pytest.approx(1e-3 * np.pi * np.abs(torque).max(), rel=1e-4)
    # Discs of the pitch diameter are a little lighter than gears with their tips, and the second turns at half speed.
    discs = sum(
        0.5 * np.pi * 7850e-9 * machine.recipes["pair"].first_stock.thickness * radius**4 * rate**2
        for radius, rate in ((12, 1), (24, 0.5))
    )
    assert loads["inertia_of_gears_kg_mm2"] == pytest.approx(discs, rel=0.2)


@pytest.mark.parametrize(("force", "suffices"), [(1, True), (3000, False)])
def test_a_machine_without_a_motor_names_the_lightest_or_the_nearest(force, suffices):
    load = {"forces": [{"body": "slider", "point": "slider_pin", "force_n": [force, 0]}]}
    pump = {"recipe": PUMP | {"loads": load}, "turned_by": "pair.second"}
    machine = gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": PAIR}, "pump": pump}})
    check = next(check for check in machine.checks if check.id == "motor_torque")
    motor, duty = gk.making.motor(machine.notes["loads"]["motor"]["motor"]), machine.torques.duty
    margins = {name: other.margin(duty) for name, other in gk.making.MOTORS.items()}
    assert check.passed == suffices == (max(margins.values()) >= 1.5) and check.value == motor.margin(duty)
    enough = [other.mass_g for name, other in gk.making.MOTORS.items() if margins[name] >= 1.5]
    assert motor.mass_g == min(enough) if suffices else check.value == max(margins.values())


def test_motor_of_a_driver_turns_the_whole_machine():
    """A pump that turns a pair, which turns a heavier pump: the motor named in the loads of the first one drives both."""
    own = PUMP | {"loads": PUMP["loads"] | {"motor": "37d-50"}}
    mechanisms = {"pump": {"recipe": own}, "pair": {"recipe": PAIR, "turned_by": "pump.crank"},
                  "other": {"recipe": PUMP, "turned_by": "pair.first"}}  # fmt: skip
    machine = gk.load({"kind": "machine", "mechanisms": mechanisms})
    (check,) = (check for check in machine.design_checks if check.id.endswith("motor_torque"))
    motor, torque = gk.making.motor("37d-50"), np.abs(machine.torques.input).max()
    rms = np.sqrt(np.trapezoid(machine.torques.input**2, machine.turns) / machine.turns[-1])
    by_hand = min(motor.torque_n_mm * (1 - 60 / 200) / torque, motor.lasting_torque_n_mm / rms)
    assert check.id == "motor_torque" and check.value == pytest.approx(by_hand, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "key"),
    [({"loads": {"motor": "tt"}}, "loads.motor"), ({"loads": {"motors": ["tt"]}}, "loads.motors"),
     ({"loads": {"speed_fluctuation": 0.1}}, "loads.speed_fluctuation"),
     ({"drive": {"acceleration_rad_per_s2": 5}}, "drive.acceleration_rad_per_s2")],
)  # fmt: skip
def test_keys_that_a_machine_decides_are_refused_by_name(change, key):
    recipe = {**PUMP, **{table: {**PUMP[table], **values} for table, values in change.items()}}
    with pytest.raises(gk.RecipeError) as refused:
        gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": PAIR},
                                                   "pump": {"recipe": recipe, "turned_by": "pair.second"}}})  # fmt: skip
    assert [problem.key for problem in refused.value.problems] == [f"mechanisms.pump.recipe.{key}"]


def test_loads_above_the_mechanisms_are_refused_with_the_place_where_they_belong():
    with pytest.raises(gk.RecipeError) as refused:
        gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": PAIR}, "pump": {"recipe": PUMP, "turned_by": "pair.second"}},
                 "loads": {}})  # fmt: skip
    assert "recipe.loads" in refused.value.problems[0].remedy


def test_a_flywheel_of_a_machine_whose_speed_no_load_changes_is_refused_by_name():
    pump = {key: value for key, value in PUMP.items() if key != "loads"}
    mechanisms = {"pair": {"recipe": PAIR}, "pump": {"recipe": pump, "turned_by": "pair.second"}}
    machine = gk.load({"kind": "machine", "mechanisms": mechanisms, "drive": {"speed_fluctuation": 0.1}})
    with pytest.raises(DesignError) as refused:
        assert machine.checks
    assert refused.value.field == "drive.speed_fluctuation"


STEEL = {"material": "steel-C45", "thickness": 6, "bore": 5}
TURNING = {
    "pair": ({**PAIR, "first_stock": STEEL, "second_stock": STEEL, "loads": {"torque_n_mm": 1e-3}}, "second"),
    "train": ({"kind": "gear-train", "train": {"stages": [[12, 36], [12, 48]], "module": 1, "friction": 0.1},
               "stock": STEEL, "loads": {"output_torque_n_mm": 1e-3}}, "driven_2"),
    "planetary": ({"kind": "planetary", "sun_stock": STEEL, "planet_stock": STEEL, "ring_stock": {"material": "steel-C45"}, "loads": {"torque_n_mm": 1e-3}}, "carrier"),
    "belt": ({"kind": "belt-drive", "pulleys": [{"teeth": 20}, {"teeth": 40, "at": [60, 0]}], "loads": {"torques_n_mm": [7]}}, None),
    "cycloidal": ({"kind": "cycloidal-drive", "loads": {"torque_n_mm": 7}}, "output"),
}  # fmt: skip


def turning(name, mirrored=False):
    """What turns the pump of 10 N, and its recipe in the machine."""
    given, body = TURNING[name]
    table = {**tomllib.loads(template_of(given["kind"])), **given}
    body = body or list(from_table(table).rotating_bodies)[1]
    pump = {"recipe": PUMP, "turned_by": f"drive.{body}", "mirrored": mirrored}
    machine = gk.load({"kind": "machine", "mechanisms": {"drive": {"recipe": table}, "pump": pump}})
    return machine, machine.recipes["drive"].notes["loads"]


def pump_torque():
    turn = np.linspace(0, 2 * np.pi, 100_001)
    return np.abs(10 * np.gradient(20 * np.cos(turn) + np.sqrt(70**2 - 400 * np.sin(turn) ** 2), turn)).max()


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    ("name", "torque"),
    [
        ("pair", lambda loads: 2 * loads["torque_n_mm"]["first"]),
        ("train", lambda loads: loads["torque_n_mm"]["driven_2"]),
        ("planetary", lambda loads: abs(loads["torque_n_mm"]["carrier"])),
        ("belt", lambda loads: 2 * loads["driver_torque_n_mm"] - 7),
        ("cycloidal", lambda loads: 10 * loads["input_torque_n_mm"] - 7),
    ],
)
def test_gears_and_belts_carry_the_torque_of_what_they_turn(name, torque, mirrored):
    machine, loads = turning(name, mirrored)
    assert torque(loads) == pytest.approx(pump_torque(), rel=1e-3)
    # Their own torque is not counted twice.
    most = np.abs(machine.torques.input).max()
    assert most < 1.1 * (pump_torque() + 7)
    assert machine.notes["loads"]["driver_torques_N_mm"]["pump"] == pytest.approx(pump_torque(), rel=1e-3)


def test_strength_of_gears_in_a_machine_is_that_of_a_pair_under_this_torque():
    machine, loads = turning("pair")
    checks = {check.id: check.value for check in machine.checks}
    apart = gk.load({**TURNING["pair"][0], "loads": {"torque_n_mm": loads["torque_n_mm"]["first"]}})
    for check in apart.checks:
        if "safety" in check.id:
            assert checks[f"drive_{check.id}"] == pytest.approx(check.value, rel=1e-6)


def test_a_larger_torque_of_the_recipe_stays():
    given, body = TURNING["pair"]
    pump = {"recipe": PUMP, "turned_by": f"drive.{body}"}
    heavy = {**given, "loads": {"torque_n_mm": 1e4}}
    machine = gk.load({"kind": "machine", "mechanisms": {"drive": {"recipe": heavy}, "pump": pump}})
    assert machine.recipes["drive"].notes["loads"]["torque_n_mm"]["first"] == 1e4


HEAVY = {**PUMP, "drive": {"step_deg": 5}, "loads": {"masses": {
    "crank": {"mass_kg": 0.2, "centre": [12, 3], "inertia_kg_mm2": 40}, "slider": {"mass_kg": 0.9},
    "coupler": {"mass_kg": 0.3, "centre": [30, -4], "inertia_kg_mm2": 90}}}}  # fmt: skip


@pytest.mark.parametrize("speed", [90, -90])
def test_shaking_of_a_machine_is_the_change_of_the_momentum_of_its_bodies(speed):
    """By central differences of the positions in the drawing of the machine, of copies and mirrored linkages too."""
    four = {"kind": "four-bar", "linkage": {"ground": 120, "crank": 25, "coupler": 100, "rocker": 70},
            "copies": [{"phase_deg": 70}, {"phase_deg": 20, "mirrored": True}], "drive": {"step_deg": 5},
            "loads": {"masses": {"rocker": {"mass_kg": 0.5, "centre": [35, 8], "inertia_kg_mm2": 300}}}}  # fmt: skip
    mechanisms = {"pair": {"recipe": PAIR}, "pump": {"recipe": HEAVY, "turned_by": "pair.first", "mirrored": True,
                                                     "phase_deg": 30, "angle_deg": 50},
                  "bars": {"recipe": four, "turned_by": "pair.second", "angle_deg": -20}}  # fmt: skip
    machine = gk.load({"kind": "machine", "mechanisms": mechanisms, "drive": {"speed_rpm": speed}})
    step = 60 / abs(speed) * (machine.turns[1] - machine.turns[0]) * np.sign(speed)
    bodies = {body.name: body for body in machine.scene.bodies}
    momentum, spin = 0, 0
    for name, body in bodies.items():
        mechanism, _, own = name.partition("/")
        own, _, copy = own.partition(", copy ")
        if mechanism == "pair" or own not in (masses := machine.mechanisms[mechanism].recipe.loads.given_masses):
            continue
        mass, over = masses[own], machine.mechanisms[mechanism].mirrored != (copy == "3")
        place = body.origin + body.direction * (-mass.centre.conjugate() if over else mass.centre)
        velocity = np.gradient(place, abs(step), edge_order=2)
        omega = np.gradient(np.unwrap(np.angle(body.direction)), abs(step), edge_order=2)
        momentum = momentum + 1e-3 * mass.mass * velocity
        spin = spin + 1e-3 * (mass.mass * (place.conj() * velocity).imag + mass.inertia * omega)
    force, moment = (-np.gradient(values, abs(step), edge_order=2) for values in (momentum, spin))
    ours, inner = machine.torques.shaking, slice(3, -3)
    assert ours[0][inner] == pytest.approx(force[inner], abs=0.02 * np.abs(force).max())
    assert ours[1][inner] == pytest.approx(moment[inner], abs=0.02 * np.abs(moment).max())
    assert machine.table["shaking_force"] == pytest.approx(np.abs(ours[0]))


def test_phase_of_a_second_pump_balances_shaking_or_torque():
    """Of two equal pumps on one shaft; opposite ones balance the first harmonic, those a quarter apart the torque."""
    table = {"kind": "machine", "drive": {"speed_rpm": 300},
             "mechanisms": {"one": {"recipe": HEAVY}, "two": {"recipe": HEAVY, "turned_by": "one.crank"}}}  # fmt: skip

    def measured(phase):
        mechanisms = {**table["mechanisms"], "two": {**table["mechanisms"]["two"], "phase_deg": phase}}
        made = gk.load({**table, "mechanisms": mechanisms}).table
        return made["shaking_force"].max(), np.ptp(made["input_torque"])

    shaking, ripple = np.array([measured(phase) for phase in (0.0, 90.0, 180.0)]).T
    assert shaking[2] < 0.4 * shaking[0] and ripple[1] < 0.5 * ripple[0] and ripple[1] < ripple[2]


@pytest.mark.campaign
def test_phase_of_a_second_pump_is_optimised_for_shaking():
    mechanisms = {"one": {"recipe": HEAVY}, "two": {"recipe": HEAVY, "turned_by": "one.crank"}}
    table = {"kind": "machine", "drive": {"speed_rpm": 300}, "mechanisms": mechanisms}
    best = gk.optimise(gk.load(table), {"mechanisms.two.phase_deg": (100, 250)}, "max(shaking_force)", starts=1)
    (phase,) = best.values.values()
    assert phase == pytest.approx(180, abs=2)


@pytest.mark.parametrize("placed", [{}, {"mirrored": True}, {"mirrored": True, "angle_deg": 40}])
@pytest.mark.parametrize("discs", [1, 2])
def test_discs_of_a_cycloidal_drive_shake_the_frame_unless_two_balance(discs, placed):
    """Outwards to the disc's centre, at the speed of the input; the eccentric is heavy on the same side."""
    cycloidal = {"pins": 11, "circle": 100, "pin": 8, "eccentricity": 3, "discs": discs}
    drive = {"kind": "cycloidal-drive", "cycloidal": cycloidal, "stock": {"material": "steel-S235"}}
    free = {name: value for name, value in CRANK.items() if name != "loads"}
    mechanisms = {"drive": {"recipe": drive, **placed}, "free": {"recipe": free, "turned_by": "drive.output"}}
    machine = gk.load({"kind": "machine", "mechanisms": mechanisms, "drive": {"speed_rpm": 3000}})
    (disc,) = (body for body in machine.scene.bodies if body.name == "drive/disc")
    direction = (disc.origin - disc.origin[:-1].mean()) / 3
    force, moment = machine.torques.shaking
    masses = from_table(drive).body_masses
    outwards = (
        1e-3 * (100 * np.pi) ** 2 * (3 * masses["disc"].mass + masses["input"].mass * masses["input"].centre.real)
    )
    expected = outwards * direction if discs == 1 else 0
    assert force == pytest.approx(expected, abs=1e-9 * outwards) and not moment.any()


def test_shaking_is_unknown_with_the_loads_of_a_cam():
    cam = tomllib.loads(template_of("disk-cam", ["loads"]))
    mechanisms = {"one": {"recipe": HEAVY}, "cam": {"recipe": cam, "turned_by": "one.crank"}}
    machine = gk.load({"kind": "machine", "mechanisms": mechanisms})
    assert machine.torques.shaking is None and "shaking_force" not in machine.table.ids


def test_flywheel_of_a_machine_keeps_the_speed_under_a_constant_torque():
    """The energy of the wheels rises and falls by the work of the mean torque less that of the loads."""
    pair = PAIR | {"first_stock": {"material": "steel-S235"}, "second_stock": {"material": "steel-S235"}}
    drive = {"speed_rpm": 200, "speed_fluctuation": 0.05}
    pump = {"recipe": PUMP, "turned_by": "pair.second"}
    machine = gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, "pump": pump}, "drive": drive})
    entry = machine.notes["loads"]["flywheel"]
    turns = np.linspace(0, 2, 20_001)
    torque = machine.torques.input_at(turns)
    spare = np.concatenate(
        [[0], np.cumsum((torque.mean() - (torque[1:] + torque[:-1]) / 2) * np.diff(2 * np.pi * turns))]
    )
    inertia = entry["inertia_kg_mm2"] + machine.torques.inertia_of_gears
    mean = 200 * np.pi / 30
    speed = np.sqrt(mean**2 + 2 * (spare - (spare.max() + spare.min()) / 2) / (1e-3 * inertia))
    assert np.ptp(speed) / mean == pytest.approx(0.05, rel=1e-3)
    disc = entry["disc_mass_kg"] * (entry["disc_diameter_mm"] / 2) ** 2 / 2
    assert disc == pytest.approx(entry["inertia_kg_mm2"], rel=1e-6)


@pytest.mark.parametrize("name", ["belt", "cycloidal"])
def test_stated_efficiency_of_a_drive_raises_its_own_torque_and_that_of_a_machine(name):
    given, _ = TURNING[name]
    table = {**tomllib.loads(template_of(given["kind"])), **given}
    free = {name: value for name, value in CRANK.items() if name != "loads"}

    def own_torque(share):
        others = {"free": {"recipe": free, "turned_by": f"drive.{list(from_table(table).rotating_bodies)[1]}"}}
        mechanisms = {"drive": {"recipe": table | {"efficiency": share}}, **others}
        return gk.load({"kind": "machine", "mechanisms": mechanisms}).torques.input

    ideal, real = own_torque(1.0), own_torque(0.8)
    assert ideal.min() > 0 and real == pytest.approx(ideal / 0.8)

    def input_torque(share):
        body = list(from_table(table).rotating_bodies)[1]
        drive = {key: value for key, value in table.items() if key != "loads"} | {"efficiency": share}
        pump = {"recipe": PUMP, "turned_by": f"drive.{body}"}
        return gk.load({"kind": "machine", "mechanisms": {"drive": {"recipe": drive}, "pump": pump}}).torques.input

    ideal, real = input_torque(1.0), input_torque(0.8)
    assert real == pytest.approx(np.where(ideal > 0, ideal / 0.8, 0.8 * ideal), rel=1e-12)


CRANK = {
    "kind": "four-bar",
    "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70},
    "loads": {
        "masses": {"crank": {"mass_kg": 1, "centre": [30, 0]}, "coupler": {"mass_kg": 0}, "rocker": {"mass_kg": 0}}
    },
}


def weight(angle):
    """Torque of the weight of one of these cranks, N mm, at its angle, rad."""
    return 9.81 * 30 * np.cos(angle)


def test_weights_that_balance_on_one_shaft_send_no_power_through_the_teeth():
    pair = PAIR | {"friction": 0.3}
    legs = {
        name: {"recipe": CRANK, "turned_by": "pair.second", "phase_deg": phase}
        for name, phase in (("a", 0), ("b", 180))
    }
    machine = gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, **legs}})
    assert np.abs(machine.torques.input).max() < 1e-9


@pytest.mark.parametrize("name", ["belt", "cycloidal"])
@pytest.mark.parametrize("speed", [60, -60])
def test_a_load_takes_up_what_a_weight_gives_back(name, speed):
    """The net torque of the body goes through the drive, more than that of the motor where it is positive and else less."""
    given, _ = TURNING[name]
    table = {**tomllib.loads(template_of(given["kind"])), **given, "efficiency": 0.8}
    drive = from_table(table)
    body = list(drive.rotating_bodies)[1]
    load = sum(float(turning.load or 0) * abs(turning.speed) for turning in drive.rotating_bodies.values())
    mechanisms = {"drive": {"recipe": table}, "crank": {"recipe": CRANK, "turned_by": f"drive.{body}"}}
    machine = gk.load({"kind": "machine", "mechanisms": mechanisms, "drive": {"speed_rpm": speed}})
    ratio = float(drive.rotating_bodies[body].speed)
    net = np.sign(speed) * load + ratio * weight(2 * np.pi * ratio * machine.graph.turns)
    assert load > 0 > (net * speed).min() and (net * speed).max() > 0
    expected = np.where(net * speed > 0, net / 0.8, net * 0.8)
    assert machine.torques.input == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


def test_each_mesh_of_a_train_carries_the_net_power_of_all_that_lies_beyond_it():
    stages = [[12, 36], [14, 28]]
    table = {"kind": "gear-train", "train": {"stages": stages, "module": 1, "friction": 0.25}}
    train = from_table(table)
    first, second = train.design.efficiencies
    legs = {
        "near": {"recipe": CRANK, "turned_by": "train.driven_1"},
        "far": {"recipe": CRANK, "turned_by": "train.driven_2", "phase_deg": 120},
    }
    machine = gk.load({"kind": "machine", "mechanisms": {"train": {"recipe": table}, **legs}})
    turns, speeds = machine.graph.turns, [float(speed) for speed in train.design.speeds]

    def through(power, share):
        return np.where(power > 0, power / share, power * share)

    near = speeds[1] * weight(2 * np.pi * speeds[1] * turns)
    far = speeds[2] * weight(2 * np.pi * speeds[2] * turns + np.radians(120))
    assert machine.torques.input == pytest.approx(through(near + through(far, second), first), abs=1e-9)

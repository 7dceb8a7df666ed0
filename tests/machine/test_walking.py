"""Machines on feet: legs that are mechanisms of their own against one walker with copies, and what cannot walk."""

import tomllib
from functools import cache

import numpy as np
import pytest

import geomkin as gk

PAIR = {"recipe": {"kind": "gear-pair", "first": {"teeth": 20, "module": 2}, "second": {"teeth": 20, "module": 2}}}
LEGS = [(0, False), (0, True), (180, False), (180, True), (0, False), (0, True)]
ROOM = 24


def tables(step=8):
    """The walker of the gallery with given masses and no motor: as it is, and one of its legs."""
    walker = tomllib.loads(gk.recipe.to_toml(gk.load("recipes/motor-walker.toml")))
    loads = walker["loads"]
    for key in ("motors", "battery_wh", "motor", "carried"):
        del loads[key]
    loads["masses"] = {
        body: {"mass_kg": 0.02 * (k + 1), "centre": [5 * k, 3], "inertia_kg_mm2": 3 * k}
        for k, body in enumerate(walker["linkage"]["bodies"])
    }
    del walker["stock"]["motor"], walker["stock"]["material"], walker["expected_failures"]
    walker["drive"]["step_deg"] = step
    leg = {key: value for key, value in walker.items() if key not in ("copies", "foot")}
    return walker, {**leg, "loads": {**loads, "foot_friction": 0.0}}


def walker(**loads):
    table, leg = tables(30)
    return {**table, "loads": {**leg["loads"], **loads}}


def machine(leg, legs=LEGS, on_feet=None, **further):
    """Legs above one another; the crank of one that is turned over points the other way at its own first position."""
    mechanisms = {
        f"leg{k}": {"recipe": leg, "foot": "foot", "turned_by": "pair.second", "mirrored": over,
                    "phase_deg": phase + 180 * over - 360 * (phase and over > 0), "gap": ROOM * (k > 0)}
        for k, (phase, over) in enumerate(legs)
    }  # fmt: skip
    table = {"kind": "machine", "mechanisms": {**mechanisms, "pair": PAIR}, "drive": {"speed_rpm": -60}, **further}
    return gk.load(table if on_feet is None else {**table, "walker": on_feet})


@cache
def geared_legs():
    return gk.load("recipes/geared-legs.toml")


@pytest.mark.campaign
def test_separate_legs_walk_as_one_linkage_with_copies():
    copies, leg = tables()
    one = gk.load({**copies, "loads": {**copies["loads"], "carried": [{"mass_kg": 0.7, "along": 5, "across": 140}]}})
    made = machine(leg, on_feet={"foot_friction": 0.5, "carried": [{"mass_kg": 0.7, "along": 5, "across": 140}]})
    ours, theirs = made.torques.walking, one.aspect("loads").walking
    assert ours.stance.mass == pytest.approx(theirs.stance.mass, rel=1e-12)
    assert ours.stance.least_margin[0] == pytest.approx(theirs.stance.least_margin[0], rel=1e-9)
    assert ours.walking.largest == pytest.approx(theirs.largest, rel=1e-9)
    assert ours.summary["walking"]["step_mm"] == pytest.approx(theirs.step, rel=1e-7)
    shaft = one.table["shaft_torque"]
    again = made.torques.input_at(-np.radians(one.table["crank_angle"]) / (2 * np.pi))
    # The pair turns the machine's driver the other way.
    assert again == pytest.approx(-shaft, abs=1e-8 * np.abs(shaft).max())
    loads = [made.table[f"foot_{k}_load"] for k in range(1, 7)]
    assert np.sum(loads, axis=0) == pytest.approx(9.81 * ours.stance.mass, rel=1e-9)


@pytest.mark.campaign
def test_weight_of_all_mechanisms_and_of_the_motor_counts():
    """The walker of the gallery: masses of plates and screws of eight legs, of its gears, motor and payload."""
    made = geared_legs()
    leg = sum(float(mass.mass) for mass in made.recipes["left"].body_masses.values())
    gears = sum(
        part.count * float(part.mass.mass) for part in made.parts if part.name.startswith("train_") and part.mass
    )
    motor = 1e-3 * gk.making.motor("25d-75").mass_g
    notes = made.notes
    assert notes["stance"]["mass_kg"] == pytest.approx(8 * leg + gears + motor + 0.5, rel=1e-6)
    assert notes["walking"]["weight_N"] == pytest.approx(9.81 * notes["stance"]["mass_kg"], rel=1e-6)
    checks = {check.id: check.passed for check in made.torques.walking.checks}
    assert checks == {"support_margin": True, "tilt_along": True, "tilt_across": True}


def test_energy_of_a_step_is_the_work_of_friction():
    """Over a turn of the legs weight and inertia take no work; what the train loses by its teeth is added."""
    made = geared_legs()
    walking = made.torques.walking.walking
    velocity, speed = walking.stance.velocity, walking.speed
    shares = walking.stance.shares
    slid = (shares * np.abs(velocity + speed)).sum(axis=0)
    power = 0.5 * walking.weight * np.trapezoid(slid, walking.stance.drive) / np.ptp(walking.stance.drive)
    turns, torques = made.torques.dense
    legs = sum(np.trapezoid(torques[name], turns) for name in ("left", "right")) / (turns[-1] * 12)
    own = np.trapezoid(torques["train"], turns) / turns[-1]
    rate = 2 * np.pi * 60 / 60
    assert legs * rate == pytest.approx(power, rel=0.05)
    assert own > legs > 0


@pytest.mark.campaign
def test_payload_beyond_the_feet_tips_the_machine_and_the_suggestion_sets_it_up_again():
    _, leg = tables(30)
    carried = {"mass_kg": 3.0, "along": 200, "across": 140}
    tipping = machine(leg, on_feet={"carried": [carried]})
    checks = {check.id: check for check in tipping.torques.walking.checks}
    assert not checks["support_margin"].passed and checks["weight_carried"].value == 0
    (suggestion,) = checks["support_margin"].suggestions
    moved = {key.rpartition(".")[2]: value for key, value in suggestion.values.items()}
    assert set(suggestion.values) == {"walker.carried[0].along", "walker.carried[0].across"}
    standing = machine(leg, on_feet={"carried": [carried | moved]})
    assert {check.id: check.passed for check in standing.torques.walking.checks}["support_margin"]
    assert standing.torques.walking.walking is not None


def test_legs_without_loads_walk_at_the_speed_of_the_machine_on_what_is_carried():
    _, leg = tables(30)
    leg = {key: value for key, value in leg.items() if key != "loads"}
    carried = {"foot_friction": 0.1, "carried": [{"mass_kg": 0.7}]}
    slow, fast = (machine(leg, on_feet=carried, drive={"speed_rpm": rpm}).torques.walking for rpm in (-60, -180))
    assert slow.stance.mass == 0.7 and slow.walking.step == pytest.approx(fast.walking.step)
    assert 3 * slow.walking.mean_speed == pytest.approx(fast.walking.mean_speed)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (lambda t: t["mechanisms"]["leg0"].update(foot="hoof"), "mechanisms.leg0.foot"),
        (lambda t: t["mechanisms"]["pair"].update(foot="foot"), "mechanisms.pair.foot"),
        (lambda t: [t["mechanisms"].pop(f"leg{k}") for k in range(2, 6)], "mechanisms.leg0.foot"),
        (lambda t: t["mechanisms"]["leg1"].update(turned_by="slow.second"), "mechanisms.leg1.foot"),
        (lambda t: [t["mechanisms"][f"leg{k}"].pop("foot") for k in range(6)], "walker"),
        (lambda t: t["mechanisms"]["leg3"]["recipe"]["loads"].update(
            forces=[{"body": "leg", "point": "foot", "force_n": [0, 1]}]), "mechanisms.leg3.recipe.loads.forces"),
        (lambda t: t["mechanisms"].update(leg0={"recipe": walker(carried=[{"mass_kg": 1}]), "turned_by": "pair.second"}),
         "mechanisms.leg0.recipe.loads.carried"),
        (lambda t: t["mechanisms"].update(leg0={"recipe": walker(foot_friction=0.3), "turned_by": "pair.second"}),
         "mechanisms.leg0.recipe.loads.foot_friction"),
        (lambda t: t["mechanisms"]["leg2"]["recipe"]["loads"].update(gravity_m_per_s2=[0, 9.81]),
         "mechanisms.leg2.recipe.loads.gravity_m_per_s2"),
    ],
)  # fmt: skip
def test_what_cannot_walk_is_refused_by_name(change, key):
    _, leg = tables(30)
    legs = {f"leg{k}": {"recipe": {**leg, "loads": dict(leg["loads"])}, "foot": "foot", "turned_by": "pair.second"}
            for k in range(6)}  # fmt: skip
    slow = {"kind": "gear-pair", "first": {"teeth": 20, "module": 2}, "second": {"teeth": 40, "module": 2}}
    table = {"kind": "machine", "walker": {"foot_friction": 0.2},
             "mechanisms": {**legs, "pair": dict(PAIR), "slow": {"recipe": slow, "turned_by": "pair.second"}}}  # fmt: skip
    change(table)
    with pytest.raises(gk.RecipeError) as refused:
        gk.load(table)
    assert [problem.key for problem in refused.value.problems] == [key]

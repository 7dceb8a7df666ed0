"""What linkages are refused for, word by word, and that what is advised works."""

import numpy as np
import pytest

import geomkin as gk
from tests.linkage.examples import FOUR_BAR, between, boom, locked

S = gk.Slider
TURN = np.linspace(0, 2 * np.pi, 9)
BARS = {
    "ground": {"O": 0, "C": 100},
    "crank": {"O": 0, "A": 30},
    "coupler": {"A": 0, "B": 90},
    "rocker": {"C": 0, "B": 70},
}
SIX_BAR = gk.StephensonSixBar(FOUR_BAR, 80, 60, 60 + 120j)
TRIPLE_ROCKER = gk.FourBar(4, 3, 2, 2.5, 1 + 1j)
PISTON = gk.SliderCrank(30, 90, driver="slider")


def bars(sliders=(), driver="crank", **changed):
    return gk.Linkage(BARS | changed, driver, sliders)


def moved(linkage=FOUR_BAR, **more):
    return gk.move(linkage, TURN, **more)


def held_twice(freed):
    """A rocker pinned to the ground at two places, and bars that hang loose instead."""
    hanging = {"hanging": {"A": 0, "H": 5}, "last": {"H": 0, **freed}}
    return bars(ground={"O": 0, "C": 100, "E": 120}, rocker={"C": 0, "B": 70, "E": 20}, **hanging)


def actuator_with_pins_at_one_place():
    bodies = {"ground": {"C": 0, "O": 0}, "cylinder": {"C": 0}, "rod": {"B": 0}, "bar": {"O": 0, "B": 60}}
    return gk.Linkage(bodies, "push", (gk.Slider("push", "rod", "cylinder"),))


def sled(span=None):
    """A rod leans on two rails that move along with the driving sled, which nothing stops."""
    bodies = {"ground": {}, "sled": {"P": 0}, "rod": {"P": 0, "Q": 50}, "lift": {"Q": 0}}
    sliders = S("way", "sled", "ground"), S("up", "lift", "sled", direction_deg=90)
    return gk.driver_limits(gk.Linkage(bodies, "sled", sliders), span=span)


NOT_BODIES = [
    {"ground": {"O": 0}, "crank": 3},
    {"ground": {"O": 0}, "crank": {"O": 0, "A": "x"}},
    {"ground": {"O": 0}, 3: {"O": 0}},
    [1],
]
REFUSED = [
    (lambda: bars(crank={"O": 0, "A": np.full(3, 30)}, rocker={"C": 0, "B": np.full(2, 70.0)}), "bodies"),
    (lambda: bars(crank={"O": 0, "A": np.zeros(0)}), "bodies"),
    (lambda: bars(rocker={"C": 0, "B": complex(70, np.nan)}), "bodies"),
    (lambda: bars(crank={"O": 0, "A": -np.inf}), "bodies"),
    (lambda: bars(crank={"O": 0, "A": np.array([30, 1e70])}), "bodies"),
    *((lambda bodies=bodies: gk.Linkage(bodies, "crank"), "bodies") for bodies in NOT_BODIES),
    (lambda: gk.Linkage({"ground": {"O": 0}}, "crank"), "bodies"),
    (lambda: bars((S("s", "rocker", "ground"),), "handle"), "driver"),
    (lambda: bars(driver="ground"), "driver"),
    (lambda: bars((S("s", "block", "ground"),)), "sliders"),
    (lambda: bars((S("s", "rocker", "frame"),)), "sliders"),
    (lambda: bars((S("s", "rocker", "rocker"),)), "sliders"),
    (lambda: bars((S("s", "rocker", "ground"), S("s", "crank", "coupler"))), "sliders"),
    (lambda: gk.Linkage(boom().bodies, "rod", boom().sliders), "driver"),
    (lambda: gk.Linkage(boom().bodies | {"ground": {"O": 0, "B": 60}}, "cylinder", boom().sliders), "driver"),
    (lambda: bars((S("s", "lever", "rod"),), "rod", lever={"X": 0}, bar={"X": 0, "Y": 5}, rod={"Y": 0}), "driver"),
    (lambda: bars((S("rod", "rod", "crank"),), "rod", rod={"B": 0}), "driver"),
    (lambda: gk.SliderCrank(30, 90, -120), "offset"),
    (lambda: gk.InvertedSliderCrank(80, 30, -110), "offset"),
    (lambda: gk.Shaper(90, 90, 180, 60, 85), "crank"),
    (lambda: gk.FourBar(100, 30, 90, 220), "rocker"),
    (lambda: gk.move(bars(loose={"X": 0}), 1.0), "bodies"),
    (lambda: gk.move(bars(brace={"A": 0, "C": 50}), 1.0), "bodies"),
    (lambda: gk.move(bars((S("s", "tip", "tail"),), tail={"A": 0, "T": 50}, tip={}), 1.0), "bodies"),
    (lambda: gk.move(bars(coupler={"A": 5, "B": 5}), 1.0), "bodies"),
    (lambda: gk.move(held_twice({}), 1.0), "bodies"),
    (lambda: moved(SIX_BAR, branch={"pin": 1}), "branch"),
    (lambda: gk.move(locked()[0], 1.0, {"pin": 1}), "branch"),
    (lambda: moved(branch=2), "branch"),
    (lambda: gk.Continuation("follow"), "start"),
    (lambda: moved(branch={"rocker_pin": 2}), "branch"),
    (lambda: moved(SIX_BAR, branch={"rocker_pin": 1, "coupler_point": 5j, "output_pin": 3}), "branch"),
    (lambda: moved(branch={"pen": 1j}), "branch"),
    (lambda: gk.move(gk.Linkage(locked()[0].bodies, "out", estimate={"A": 30}), 1.0), "estimate"),
    (lambda: gk.move(locked()[0], [0.0, 300.0]).assembled, "drive"),
    (lambda: gk.move(SIX_BAR, [0, 1e5], "follow").assembled, "drive"),
    (lambda: gk.linkage.dead_centres(FOUR_BAR, "ground"), "output"),
    (lambda: gk.linkage.mechanical_advantage(moved(), "ground"), "output"),
    (lambda: gk.driver_limits(FOUR_BAR, span=(1.0, 1.0)), "span"),
    (sled, "span"),
    (lambda: gk.driver_limits(PISTON, "follow"), "span"),
    (lambda: gk.driver_limits(PISTON, {"crank_pin": 30j}), "span"),
    (lambda: gk.driver_limits(between()[0]), "span"),
    (lambda: gk.linkage.circuits(FOUR_BAR, moved(gk.FourBar(100, 30, 90, 71))), "motion"),
    (lambda: gk.linkage.motion_table(moved(gk.FourBar(100, np.array([20.0, 30, 25]), 90, 70))), "motion"),
    (lambda: gk.linkage.velocity_polygon(moved(), frame=9), "frame"),
    (lambda: gk.linkage.velocity_polygon(moved(), frame=-10), "frame"),
    (lambda: gk.linkage.instant_centre(moved(), "coupler", "frame"), "body"),
    (lambda: gk.linkage.instant_centre(moved(), "coupler", "coupler"), "other"),
    (lambda: gk.linkage.path_curvature(moved(), "bar", 1.0), "body"),
    (lambda: gk.linkage.inflection_circle(moved(), "bar"), "body"),
    (lambda: gk.linkage.DirectContact(1j, 1j, 5, 5), "follower_pivot"),
    (lambda: gk.linkage.DirectContact(1j, 1j, 5, 5, follower_pivot=50, follower_direction=1), "follower_pivot"),
    (lambda: gk.linkage.DirectContact(1j, 1j, 5, np.array([5.0, 6]), follower_pivot=50).linkage, "follower_radius"),
    (lambda: gk.linkage.euler_savary(point=1.0, centre=2.0), "euler_savary"),
    (gk.linkage.euler_savary, "euler_savary"),
    (lambda: gk.CouplerCurve(FOUR_BAR, "pen"), "point_name"),
    (lambda: gk.CouplerCurve(PISTON, "crank_pin"), "span"),
    (lambda: gk.CouplerCurve(TRIPLE_ROCKER, "rocker_pin"), "span"),
    (lambda: gk.linkage.coupler_grid(1, -1, 2, 2), "height"),
    (lambda: gk.linkage.coupler_grid(1, 1, 0, 2), "rows"),
    (lambda: gk.linkage.coupler_curves(moved(), [1.0], "bar"), "body"),
    (lambda: gk.linkage.roberts_linkage(TRIPLE_ROCKER, start=3.0), "start"),
    (lambda: gk.linkage.cognates(gk.FourBar(100, 30, 90, 70, coupler_point=90)), "coupler_point"),
    (lambda: gk.linkage.cognates(gk.FourBar(100, 30, 90, 70)), "coupler_point"),
    (lambda: gk.linkage.shaking_force(moved(), gk.linkage.SliderCrankMasses()), "motion"),
    (lambda: gk.linkage.best_counterbalance(gk.SliderCrank(30, 42, -12), gk.linkage.SliderCrankMasses()), "coupler"),
    (lambda: gk.linkage.central_difference(np.zeros((9, 1)), 0.1), "samples"),
    (lambda: gk.linkage.newton_raphson(lambda x: x, lambda x: 1, np.zeros((2, 2))), "estimate"),
    (lambda: gk.move(actuator_with_pins_at_one_place(), [60.0]), "bodies"),
]


@pytest.mark.parametrize(("call", "field"), REFUSED)
def test_invalid_arguments_are_refused(call, field):
    with pytest.raises(gk.DesignError) as caught:
        call()
    assert caught.value.field == field and caught.value.remedy


def test_remedies_work():
    gk.SliderCrank(30, 90, -119.9), gk.InvertedSliderCrank(80, 30, -109.9), gk.FourBar(100, 30, 90, 219.9)
    gk.linkage.best_counterbalance(gk.SliderCrank(30, 42.1, -12), gk.linkage.SliderCrankMasses(slider=1.0))
    assert sled((-100.0, 100.0)) == ((-100.0, 100.0),)
    gk.CouplerCurve(PISTON, "crank_pin", span=(60.1, 119.9))
    gk.CouplerCurve(TRIPLE_ROCKER, "rocker_pin", span=(4.9117, 6.2831))
    assert gk.linkage.velocity_polygon(moved(), frame=-9) == gk.linkage.velocity_polygon(moved(), frame=0)
    linkage, drive = locked()
    assert gk.move(linkage, drive[0] + np.array([0, -251.3])).assembled[0]
    # Joined to the ground instead of the rocker, which is pinned there twice.
    freed = held_twice({"L": 3 + 4j})
    bodies = dict(freed.bodies) | {"rocker": BARS["rocker"], "ground": {"O": 0, "C": 100, "L": 33 + 4j}}
    assert gk.move(gk.Linkage(bodies, "crank"), [0.1, 0.0]).assembled.all()

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


def sled(span=None):
    """A rod leans on two rails that move along with the driving sled, which nothing stops."""
    bodies = {"ground": {}, "sled": {"P": 0}, "rod": {"P": 0, "Q": 50}, "lift": {"Q": 0}}
    sliders = S("way", "sled", "ground"), S("up", "lift", "sled", direction_deg=90)
    return gk.driver_limits(gk.Linkage(bodies, "sled", sliders), span=span)


BOTH = "so its angle may be meant or its displacement"
EACH = "each a table of its points, x + yj"
OF_ONE = "give one of ground, crank, coupler, rocker"
SPLIT = ", which turns as it does, for its angle"
SHRINKS = (
    "where one cognate shrinks to a point; give a point away from both pins: at a pin the coupler curve is an arc, "
    "which the one link traces"
)
REFUSED = [
    # Bodies, sliders and a driver that are none.
    (
        lambda: bars(crank={"O": 0, "A": np.full(3, 30)}, rocker={"C": 0, "B": np.full(2, 70.0)}),
        "bodies: found points of 2 and 3 linkages; give one place, or as many of each",
    ),
    (
        lambda: bars(crank={"O": 0, "A": np.zeros(0)}),
        "bodies: found points of 0 linkages; give one place, or as many of each",
    ),
    (
        lambda: bars(rocker={"C": 0, "B": complex(70, np.nan)}),
        "bodies: point B of rocker is (70+nanj); give finite coordinates below 1e+60 mm",
    ),
    (
        lambda: bars(crank={"O": 0, "A": -np.inf}),
        "bodies: point A of crank is -inf; give finite coordinates below 1e+60 mm",
    ),
    (
        lambda: bars(crank={"O": 0, "A": np.array([30, 1e70])}),
        "bodies: point A of crank is not finite everywhere; give finite coordinates below 1e+60 mm",
    ),
    *(
        (lambda bodies=bodies: gk.Linkage(bodies, "crank"), f"bodies: found {bodies}; give a table of bodies, {EACH}")
        for bodies in (
            {"ground": {"O": 0}, "crank": 3},
            {"ground": {"O": 0}, "crank": {"O": 0, "A": "x"}},
            {"ground": {"O": 0}, 3: {"O": 0}},
            [1],
        )
    ),
    (
        lambda: gk.Linkage({"ground": {"O": 0}}, "crank"),
        "bodies: found 1; give the fixed body first and at least one that moves",
    ),
    (
        lambda: bars((S("s", "rocker", "ground"),), "handle"),
        "driver: found 'handle'; give one of crank, coupler, rocker, s",
    ),
    (lambda: bars(driver="ground"), "driver: found 'ground'; give one of crank, coupler, rocker"),
    (lambda: bars((S("s", "block", "ground"),)), f"sliders: s names 'block'; {OF_ONE}"),
    (lambda: bars((S("s", "rocker", "frame"),)), f"sliders: s names 'frame'; {OF_ONE}"),
    (lambda: bars((S("s", "rocker", "rocker"),)), "sliders: s slides rocker on itself; give two bodies"),
    (
        lambda: bars((S("s", "rocker", "ground"), S("s", "crank", "coupler"))),
        "sliders: two have the same name; give each a name of its own",
    ),
    # Drivers that could be meant in two ways.
    (
        lambda: gk.Linkage(boom().bodies, "rod", boom().sliders),
        f"driver: rod slides on cylinder and is not pinned to the ground, {BOTH}; give lift, the slider, for its "
        f"displacement, or cylinder{SPLIT}",
    ),
    (
        lambda: gk.Linkage(boom().bodies | {"ground": {"O": 0, "B": 60}}, "cylinder", boom().sliders),
        f"driver: cylinder slides on rod and is not pinned to the ground, {BOTH}; give lift, the slider, for its "
        f"displacement, or rod{SPLIT}",
    ),
    (
        lambda: bars((S("s", "lever", "rod"),), "rod", lever={"X": 0}, bar={"X": 0, "Y": 5}, rod={"Y": 0}),
        f"driver: rod slides on lever and is not pinned to the ground, {BOTH}; give s, the slider, for its displacement",
    ),
    (
        lambda: bars((S("rod", "rod", "crank"),), "rod", rod={"B": 0}),
        "driver: rod is the name of a body and of a slider; give the slider another name",
    ),
    # Sizes with which nothing closes.
    (
        lambda: gk.SliderCrank(30, 90, -120),
        "offset: found -120 mm, but crank and coupler together reach only 120 mm, so the loop cannot close; give less "
        "than 120 mm or lengthen the others",
    ),
    (
        lambda: gk.InvertedSliderCrank(80, 30, -110),
        "offset: found -110 mm, but the crank pin comes no farther than 110 mm from the rocker pivot; give less than "
        "110 mm",
    ),
    (
        lambda: gk.Shaper(90, 90, 180, 60, 85),
        "crank: found 90 mm, but the lever turns over at the 90 mm to its pivot and more; give less than 90 mm",
    ),
    (
        lambda: gk.FourBar(100, 30, 90, 220),
        "rocker: found 220 mm, but the other three links together reach only 220 mm, so the loop cannot close; give "
        "rocker less than 220 mm or lengthen the others",
    ),
    # Freedoms.
    (
        lambda: gk.move(bars(loose={"X": 0}), 1.0),
        "bodies: loose is joined to nothing; give it a point that another body has too",
    ),
    (
        lambda: gk.move(bars(brace={"A": 0, "C": 50}), 1.0),
        "bodies: 4 moving bodies with 6 pins and 0 sliders have 0 freedoms, so the linkage is rigid with one driver; "
        "take a bar away, or a pin",
    ),
    (
        lambda: gk.move(bars((S("s", "tip", "tail"),), tail={"A": 0, "T": 50}, tip={}), 1.0),
        "bodies: 5 moving bodies with 5 pins and 1 sliders have 3 freedoms, so the linkage is loose with one driver; "
        "pin another bar to two bodies that move apart",
    ),
    (
        lambda: gk.move(bars(coupler={"A": 5, "B": 5}), 1.0),
        "bodies: A and B are at one place of coupler; move them apart, or pin its neighbours",
    ),
    (
        lambda: gk.move(held_twice({}), 1.0),
        "bodies: hanging, last have 4 conditions for 6 freedoms, so they are loose; join them to more bodies, and take "
        "away as much elsewhere",
    ),
    # Branches.
    (lambda: moved(SIX_BAR, branch={"pin": 1}), "branch: found 'pin'; give signs of rocker_pin, output_pin"),
    (lambda: gk.move(locked()[0], 1.0, {"pin": 1}), "branch: found 'pin'; give signs of none"),
    (
        lambda: moved(branch=2),
        'branch: found 2; give +1, -1, "follow", or a table of signs by joint or of places of pins as complex numbers',
    ),
    (
        lambda: gk.Continuation("follow"),
        "start: found 'follow'; give +1, -1, or a table of signs by joint or of places of pins as complex numbers",
    ),
    (
        lambda: moved(branch={"rocker_pin": 2}),
        "branch: found 2; give +1 or -1, or a place as a finite complex number, mm",
    ),
    (
        lambda: moved(SIX_BAR, branch={"rocker_pin": 1, "coupler_point": 5j, "output_pin": 3}),
        "branch: found 3; give +1 or -1, or a place as a finite complex number, mm",
    ),
    (
        lambda: moved(branch={"pen": 1j}),
        "branch: found 'pen'; give places of crank_pivot, crank_pin, rocker_pin, coupler_point, rocker_pivot",
    ),
    # What is followed.
    (
        lambda: gk.move(gk.Linkage(locked()[0].bodies, "out", estimate={"A": 30}), 1.0),
        "estimate: crank, coupler, rocker, rod are no chain of dyads and need a start; missing: B, P; give roughly "
        "where each of these pins is when the driver is at its first position",
    ),
    (
        lambda: gk.move(locked()[0], [0.0, 300.0]).assembled,
        "drive: goes 300 from its first value in a linkage that is no chain of dyads; give drives within 251.327 of "
        "the first",
    ),
    (
        lambda: gk.move(SIX_BAR, [0, 1e5], "follow").assembled,
        "drive: found 5.72958e+06 deg to follow a branch over; give at most 399997 deg",
    ),
    # Measures.
    (
        lambda: gk.linkage.dead_centres(FOUR_BAR, "ground"),
        "output: found 'ground'; give one of crank, coupler, rocker",
    ),
    (
        lambda: gk.linkage.mechanical_advantage(moved(), "ground"),
        "output: found 'ground'; give one of crank, coupler, rocker",
    ),
    (lambda: gk.driver_limits(FOUR_BAR, span=(1.0, 1.0)), "span: found (1.0, 1.0); give two different ends"),
    (sled, "span: the linkage closes at places without end; give a span, such as (-100.0, 100.0)"),
    (
        lambda: gk.driver_limits(PISTON, "follow"),
        "span: a slide drives, and such a branch needs a first place; give a span that starts there",
    ),
    (
        lambda: gk.driver_limits(PISTON, {"crank_pin": 30j}),
        "span: a slide drives, and such a branch needs a first place; give a span that starts there",
    ),
    (
        lambda: gk.driver_limits(between()[0]),
        "span: a slide drives, and the estimate needs a first place; give a span that starts there",
    ),
    (
        lambda: gk.linkage.circuits(FOUR_BAR, moved(gk.FourBar(100, 30, 90, 71))),
        "motion: it is of another linkage; give the motion of this one",
    ),
    (
        lambda: gk.linkage.motion_table(moved(gk.FourBar(100, np.array([20.0, 30, 25]), 90, 70))),
        "motion: found (3,) linkages; give one at a time",
    ),
    # One moment of a motion.
    (
        lambda: gk.linkage.velocity_polygon(moved(), frame=9),
        "frame: found 9; give 0 to 8: the motion has so many frames",
    ),
    (
        lambda: gk.linkage.velocity_polygon(moved(), frame=-10),
        "frame: found -10; give 0 to 8: the motion has so many frames",
    ),
    (lambda: gk.linkage.instant_centre(moved(), "coupler", "frame"), f"body: found 'frame'; {OF_ONE}"),
    (
        lambda: gk.linkage.instant_centre(moved(), "coupler", "coupler"),
        "other: found 'coupler' twice; give two different bodies",
    ),
    (lambda: gk.linkage.path_curvature(moved(), "bar", 1.0), f"body: found 'bar'; {OF_ONE}"),
    (lambda: gk.linkage.inflection_circle(moved(), "bar"), f"body: found 'bar'; {OF_ONE}"),
    (
        lambda: gk.linkage.DirectContact(1j, 1j, 5, 5),
        "follower_pivot: of it and follower_direction found neither; give one of them",
    ),
    (
        lambda: gk.linkage.DirectContact(1j, 1j, 5, 5, follower_pivot=50, follower_direction=1),
        "follower_pivot: of it and follower_direction found both; give one of them",
    ),
    (
        lambda: gk.linkage.DirectContact(1j, 1j, 5, np.array([5.0, 6]), follower_pivot=50).linkage,
        "follower_radius: found (2,) positions; give one position",
    ),
    (
        lambda: gk.linkage.euler_savary(point=1.0, centre=2.0),
        "euler_savary: found point, centre; give exactly three of instant_centre, point, centre, inflection",
    ),
    (
        gk.linkage.euler_savary,
        "euler_savary: found none; give exactly three of instant_centre, point, centre, inflection",
    ),
    # Curves.
    (
        lambda: gk.CouplerCurve(FOUR_BAR, "pen"),
        "point_name: found 'pen'; give one of crank_pivot, rocker_pivot, crank_pin, rocker_pin, coupler_point",
    ),
    (
        lambda: gk.CouplerCurve(PISTON, "crank_pin"),
        "span: is missing where a slide drives; give its first and last place, mm: the linkage closes from -120 to -60 "
        "and 60 to 120",
    ),
    (
        lambda: gk.CouplerCurve(TRIPLE_ROCKER, "rocker_pin"),
        "span: the linkage closes only from 0 to 1.37156 and 4.91162 to 6.28319; give a span inside it",
    ),
    (lambda: gk.linkage.coupler_grid(1, -1, 2, 2), "height: found -1; give a finite number of at least 0"),
    (lambda: gk.linkage.coupler_grid(1, 1, 0, 2), "rows: found 0; give a finite number of at least 1"),
    (lambda: gk.linkage.coupler_curves(moved(), [1.0], "bar"), f"body: found 'bar'; {OF_ONE}"),
    (
        lambda: gk.linkage.roberts_linkage(TRIPLE_ROCKER, start=3.0),
        "start: found 3 rad, where the linkage is open; give a drive that it reaches",
    ),
    (
        lambda: gk.linkage.cognates(gk.FourBar(100, 30, 90, 70, coupler_point=90)),
        f"coupler_point: found 90 mm, at the rocker pin, {SHRINKS}",
    ),
    (
        lambda: gk.linkage.cognates(gk.FourBar(100, 30, 90, 70)),
        f"coupler_point: found 0+0j mm, at the crank pin, {SHRINKS}",
    ),
    # Masses and samples.
    (
        lambda: gk.linkage.shaking_force(moved(), gk.linkage.SliderCrankMasses()),
        "motion: its bodies are ground, crank, coupler, rocker; give the motion of a slider-crank",
    ),
    (
        lambda: gk.linkage.best_counterbalance(gk.SliderCrank(30, 42, -12), gk.linkage.SliderCrankMasses()),
        "coupler: found 42 mm, so the crank cannot turn fully; give more than 42 mm, crank and offset together",
    ),
    (
        lambda: gk.linkage.central_difference(np.zeros((9, 1)), 0.1),
        "samples: found shape (9, 1); give one row of at least 9",
    ),
    (
        lambda: gk.linkage.newton_raphson(lambda x: x, lambda x: 1, np.zeros((2, 2))),
        "estimate: found shape (2, 2); give a number or a row (n,)",
    ),
]


@pytest.mark.parametrize(("call", "text"), REFUSED, ids=[text for _, text in REFUSED])
def test_what_was_found_and_what_to_give_is_told_in_full(call, text):
    with pytest.raises(gk.DesignError) as caught:
        call()
    assert str(caught.value) == text


def test_what_the_refusals_advise_works():
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

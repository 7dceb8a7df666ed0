"""Whatever is given to a public call of the gears that it cannot use is refused by name, without raw errors."""

import math

import numpy as np
import pytest

import geomkin as gk

GEAR, RACK = gk.SpurGear(24, 2), gk.gear.GearRack(12, 2)
POINTS = (3.55 + 32.6j, 2.95 + 34.4j, 2.35 + 36j, 1.75 + 37.4j, 0.75 + 39j)


def pointed():
    return gk.gear.PointToothGear(24, 3, POINTS)


def pair():
    return gk.GearPair(GEAR, gk.SpurGear(30, 2))


def planets():
    return gk.gear.PlanetarySet(GEAR, gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))


def mate():
    return gk.conjugate(pointed().outline.piece, 24, 36.0, 32, 2.0)


# What is called, with what it is well given.
CALLS = {
    "SpurGear": (
        lambda: gk.SpurGear,
        {
            "teeth": 24,
            "module": 2.0,
            "profile_shift": 0.0,
            "rack": gk.gear.RackCutter(),
            "addendum": 1.0,
            "tooth_thickness_allowance": 0.0,
            "tip_rounding": 0.0,
            "tip_chamfer": 0.0,
            "pointed": "refuse",
            "diametral_pitch": None,
        },
    ),
    "RingGear": (
        lambda: gk.RingGear,
        {
            "teeth": 60,
            "module": 2.0,
            "profile_shift": 0.0,
            "cutter": gk.gear.PinionCutter(),
            "addendum": 1.0,
            "tooth_thickness_allowance": 0.0,
        },
    ),
    "GearRack": (
        lambda: gk.gear.GearRack,
        {"teeth": 12, "module": 2.0, "rack": gk.gear.RackCutter(), "height": 5.0, "tooth_thickness_allowance": 0.0},
    ),
    "Rack": (
        lambda: gk.gear.RackCutter,
        {"pressure_angle_deg": 20.0, "addendum": 1.0, "dedendum": 1.25, "tip_radius": 0.3},
    ),
    "PinionCutter": (
        lambda: gk.gear.PinionCutter,
        {"teeth": 24, "pressure_angle_deg": 20.0, "addendum": 1.25, "tip_radius": 0.2, "profile_shift": 0.0},
    ),
    "GearPair": (lambda: gk.GearPair, {"first": GEAR, "second": gk.SpurGear(30, 2), "centre_distance": None}),
    "RackPair": (lambda: gk.gear.RackPair, {"pinion": GEAR, "rack": RACK, "distance": None}),
    "PlanetarySet": (
        lambda: gk.gear.PlanetarySet,
        {"sun": GEAR, "planet": gk.SpurGear(18, 2), "ring": gk.RingGear(60, 2, addendum=0.8), "planets": 3},
    ),
    "LanternPinion": (lambda: gk.gear.LanternPinion, {"pins": 12, "module": 4.0, "pin_diameter": 5.0}),
    "StraightSidedGear": (
        lambda: gk.gear.StraightSidedGear,
        {"teeth": 40, "module": 2.0, "flank_angle_deg": 25.0, "addendum": 1.0, "dedendum": 1.2},
    ),
    "PointToothGear": (lambda: gk.gear.PointToothGear, {"teeth": 24, "module": 3.0, "points": POINTS}),
    "FlankGear": (
        lambda: gk.gear.FlankGear,
        {"flank": gk.plane.Segment(3 + 33j, 1 + 38j), "teeth": 24, "pitch_radius": 36.0},
    ),
    "conjugate": (
        lambda: gk.conjugate,
        {
            "tooth": gk.gear.FlankGear(gk.plane.Segment(3 + 33j, 1 + 38j), 24, 36.0).outline.piece,
            "teeth": 24,
            "pitch_radius": 36.0,
            "mate_teeth": 32,
            "addendum": 2.0,
            "internal": False,
        },
    ),
    "chord": (lambda: gk.gear.chord, {"gear": GEAR, "radius": None}),
    "span": (lambda: gk.gear.span, {"gear": GEAR, "teeth": None}),
    "over_pins": (lambda: gk.gear.over_pins, {"gear": GEAR, "pin": None}),
    "balanced_shifts": (lambda: gk.gear.balanced_shifts, {"first": 20, "second": 30, "rack": None, "total": 0.0}),
    "undercut_free_shift": (lambda: gk.gear.undercut_free_shift, {"teeth": 12, "rack": None}),
    "GearPair.sliding": (lambda: pair().sliding, {"along": 1.0}),
    "GearPair.poses": (lambda: pair().poses, {"turn": 1.0}),
    "RackPair.sliding": (lambda: gk.gear.RackPair(GEAR, RACK).sliding, {"along": 1.0}),
    "RackPair.poses": (lambda: gk.gear.RackPair(GEAR, RACK).poses, {"turn": 1.0}),
    "PlanetarySet.poses": (lambda: planets().poses, {"turn": 1.0}),
    "PlanetarySet.speeds": (lambda: planets().speeds, {"sun": 1.0, "ring": 0.0}),
    "SpurGear.thickness": (lambda: GEAR.thickness, {"radius": 24.0}),
    "RingGear.thickness": (lambda: gk.RingGear(60, 2).thickness, {"radius": 59.0}),
    "FlankGear.cutter": (lambda: pointed().cutter, {"clearance": 0.1, "backlash": 0.1}),
    "LanternPinion.cutter": (lambda: gk.gear.LanternPinion(12, 4, 5).cutter, {"clearance": 0.1, "backlash": 0.1}),
    "Conjugate.contact": (lambda: mate().contact, {"t": 0.5}),
    "Conjugate.contact_ratio": (lambda: mate().contact_ratio, {"start": 0.0, "end": 1.0}),
}
# Numbers that may or may not do: no more is asked than a plain answer. 1e-300 and below leave the range of numbers.
NUMBERS = [math.nan, math.inf, -math.inf, 5e-324, 1e-300, -1e-300, 1e308, -1, 0, 1.5, 10**400]
# What never does, but for the angles and places that may be arrays.
OTHERS = [
    True,
    "24",
    "x",
    b"x",
    (1, 2),
    [1, 2],
    {},
    1 + 2j,
    object(),
    (1 + 2j, "a"),
    gk.plane.Pose(0j, 1),
    [GEAR, GEAR],
]
ARRAYS = [np.array([24.0, 2.0]), np.array([]), np.array([24]), np.array([GEAR, GEAR], dtype=object)]
MANY = {"turn", "along", "t"}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", CALLS)
def test_what_a_call_cannot_use_is_refused_by_name(name):
    call, good = CALLS[name][0](), CALLS[name][1]
    call(**good)
    for key in good:
        for bad in [*NUMBERS, *OTHERS, *ARRAYS, *(None,) * (good[key] is not None and key != "addendum")]:
            try:
                call(**good | {key: bad})
            except gk.DesignError as error:
                assert error.remedy and str(error).isprintable()
            else:
                may = any(bad is number for number in NUMBERS) or (key == "internal" and bad is True)
                assert may or (key in MANY and np.asarray(bad).dtype.kind in "iuf"), (key, bad)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: gk.SpurGear(24, 2, on_pointed_tip=math.nan), "pointed"),
        (lambda: gk.SpurGear(24, 2, on_pointed_tip="maybe"), "pointed"),
        (lambda: gk.GearPair(1, 2), "first"),
        (lambda: gk.GearPair(gk.RingGear(60, 2), GEAR), "first"),
        (lambda: gk.SpurGear(24, 5e-324), "module"),
        (lambda: gk.SpurGear(24, diametral_pitch=1e-9), "diametral_pitch"),
        (lambda: gk.gear.span(gk.RingGear(60, 2)), "gear"),
    ],
)
def test_the_field_that_is_wrong_is_the_one_named(make, field):
    with pytest.raises(gk.DesignError) as caught:
        make()
    assert caught.value.field == field


@pytest.mark.parametrize("unit", [1e-7, 1e-3, 1e5])
def test_gears_of_any_size_that_can_be_are_alike(unit):
    one, large = gk.SpurGear(17, 1.0, tip_rounding=0.1), gk.SpurGear(17, unit, tip_rounding=0.1)
    t = np.linspace(0, 17, 200)
    assert np.abs(large.outline.point(t) / unit - one.outline.point(t)).max() < 1e-10


@pytest.mark.parametrize("place", [1.75 + 2.5e8j, 2.5e8 + 36j, 1.75 - 2.5e8j, 145 + 0j])
def test_points_far_off_the_pitch_circle_are_refused_with_a_reach_that_is_looked_at(place):
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.PointToothGear(24, 3, (*POINTS[:3], place, POINTS[4]))
    assert caught.value.field == "points"
    named = float(caught.value.remedy.split(" mm")[0].split()[-1])

    def tall(reach):
        return gk.gear.PointToothGear(24, 3, (3 + 33j, 2 + 60j, 0.1 + 1j * reach))

    assert tall(named - 1e-3).tip_radius == pytest.approx(named, rel=1e-4)
    with pytest.raises(gk.DesignError, match="lies"):
        tall(named * 1.0001)


def test_a_flank_far_off_the_pitch_circle_is_refused_before_it_is_looked_at():
    with pytest.raises(gk.DesignError, match="reaches"):
        gk.gear.FlankGear(gk.plane.Segment(3 + 33j, 1 + 2.5e8j), 24, 36.0)


def test_more_points_than_a_flank_can_use_are_refused_with_the_most():
    def flank(count):
        return tuple(complex(3.5 - 2.7 * s, 32.6 + 6.4 * s) for s in np.linspace(0, 1, count).tolist())

    with pytest.raises(gk.DesignError) as caught:
        gk.gear.PointToothGear(24, 3, flank(101))
    most = int(caught.value.remedy.split()[-1])
    assert most == 100 and len(gk.gear.PointToothGear(24, 3, flank(most)).points) == most


def shows():
    """What public calls of the gears give."""
    toothed, meshing = mate(), pair()
    yield from (GEAR, GEAR.tooth, RACK, gk.RingGear(60, 2), gk.RingGear(60, 2).tooth, pointed(), meshing, planets())
    yield from (gk.gear.RackPair(GEAR, RACK), toothed, toothed.contact([0.2, 0.4]), *toothed.untouched, *toothed.steps)
    yield from (gk.gear.span(GEAR), gk.gear.over_pins(GEAR), gk.gear.chord(GEAR))
    yield gk.gear.GearStock(bore=8, web=gk.gear.Web(hub=20, rim=3))


def test_gears_show_on_one_line():
    for thing in shows():
        assert len(repr(thing)) <= 120 and repr(thing).isprintable(), type(thing)

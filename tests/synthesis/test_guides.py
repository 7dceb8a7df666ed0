"""Linkages by where their pins stand at poses, against known linkages that were moved there."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.guidance.guides import guides_of, usable

PLACE = {"origin": 10 - 20j, "ground_angle_deg": 25.0}
KINDS = {
    "four-bar": gk.FourBar(90, 30, 80, 70, 40 + 45j, **PLACE),
    "crank-slider": gk.SliderCrank(30, 80, 12, 40 + 15j, **PLACE),
    "slider-crank": gk.SliderCrank(30, 80, -12, 40 + 15j, driver="slider", **PLACE),
    "rod": gk.EllipticTrammel(60, 40 + 15j, 70.0, **PLACE),
    "shuttle": gk.EllipticTrammel(60, 40 + 15j, 70.0, driver="shuttle", **PLACE),
}
PINS = {"four-bar": "rocker_pin", "crank-slider": "slider_pin", "slider-crank": "slider_pin"}
DRIVES = {"slider-crank": [60.0, 75, 95], "shuttle": [-20.0, 10, 40]}


def held(kind, sides=(1, 1)):
    """The dyads of a known linkage, which stand twice beside each other, and its motion."""
    known = KINDS[kind]
    motion = gk.move(known, DRIVES.get(kind, [0.4, 1.1, 1.9]))
    ahead = np.exp(1j * np.radians(PLACE["ground_angle_deg"]))
    trammel = isinstance(known, gk.EllipticTrammel)
    pins = [motion.point(n).position for n in (("shuttle_pin", "cross_pin") if trammel else ("crank_pin", PINS[kind]))]
    slot = ahead * np.exp(1j * np.radians(70))
    ends = (ahead, slot) if trammel else (known.origin, known.origin + 90 * ahead if kind == "four-bar" else ahead)
    if trammel or kind != "four-bar":
        # Directions of slides may be reported reversed.
        ends = (sides[0] * ends[0] if trammel else ends[0], sides[1] * ends[1])
    both = [(np.stack([pin, pin], axis=1), np.array([end, end])) for pin, end in zip(pins, ends)]
    name = "elliptic-trammel" if trammel else kind
    return guides_of(name, kind in ("slider-crank", "shuttle"), *both), motion


@pytest.mark.parametrize("kind", KINDS)
def test_a_linkage_comes_back_from_its_pins_with_its_drive_and_its_angle(kind):
    guides, motion = held(kind)
    known, body = KINDS[kind], motion.bodies["rod" if "rod" in motion.bodies else "coupler"]
    again = guides.linkage(1, 40 + 15j)
    sizes = {n: v for n, v in known.__dict__.items() if n not in ("coupler_point", "rod_point", "linkage")}
    for name, value in sizes.items():
        reported = getattr(again, name)
        assert reported == value if isinstance(value, str) else reported == pytest.approx(value, rel=1e-9)
    assert guides.defects.none.all() and guides.defects.drive[:, 1] == pytest.approx(
        np.array(DRIVES.get(kind, [0.4, 1.1, 1.9]))
    )
    ways = np.linspace(guides.defects.drive[0, 0], guides.defects.drive[-1, 0], 4001)
    least = gk.least_transmission_angle(gk.move(known, ways))
    assert guides.angle == pytest.approx([least, least], abs=1e-6)
    # A place and a direction on the body, seen from its own frame.
    place, angle = guides.holds(
        0, complex(body.origin.position[0] + (7 - 3j) * body.direction[0]), complex(body.direction[0] * 1j)
    )
    assert place == pytest.approx(7 - 3j) and angle == pytest.approx(np.pi / 2)
    lengths = [getattr(known, n) for n in ("ground", "crank", "coupler", "rocker", "rod") if hasattr(known, n)]
    assert sorted(float(v[0]) for v in guides.links) == pytest.approx(sorted(lengths))
    assert guides.ratio == pytest.approx(np.full(2, max(lengths) / min(lengths)))


@pytest.mark.parametrize("kind", KINDS)
def test_usable_linkages_have_all_joints_in_the_box(kind):
    guides, _ = held(kind)
    places = np.concatenate([guides.joints, guides.first, guides.second])[:, 0]
    assert abs(places - PLACE["origin"]).min() < 1e-9
    low, high = complex(places.real.min(), places.imag.min()), complex(places.real.max(), places.imag.max())
    hair = 1e-6 * (1 + 1j)
    assert usable(guides, low - hair, high + hair).all()
    for less in (1e-3, 1e-3j):
        assert not usable(guides, low + less - hair, high + hair).any()
        assert not usable(guides, low - hair, high - less + hair).any()
    # A link of next to no length, beside the box, is none.
    assert not usable(guides, -1e12 * (1 + 1j), 1e12 * (1 + 1j)).any()


@pytest.mark.parametrize("kind", ["rod", "shuttle"])
def test_slots_of_a_trammel_may_be_given_in_either_order(kind):
    plain, _ = held(kind)
    for sides in ((-1, 1), (1, -1), (-1, -1)):
        guides, motion = held(kind, sides)
        again = guides.linkage(0, 0j)
        assert again.angle_deg == pytest.approx(70) and again.origin == pytest.approx(PLACE["origin"])
        assert guides.defects.none.all()
        assert guides.angle == pytest.approx(plain.angle)
        moved = gk.move(again, guides.defects.drive[:, 0], int(guides.defects.sign[0, 0]))
        for name in ("shuttle_pin", "cross_pin"):
            assert moved.point(name).position == pytest.approx(motion.point(name).position)


def test_slots_that_are_nearly_one_make_no_trammel():
    rng = np.random.default_rng(2)
    slots = np.exp(1j * np.radians(np.array([3, 9.9, 10.1, 30, 90, 169.9, 170.1, 177, 190.1, -9.9, -10.1])))
    pins = rng.normal(size=(3, 11)) + 1j * rng.normal(size=(3, 11))
    way = np.exp(0.4j)
    # Each pin on its own slot, through the same place.
    first, second = 5 + way * pins.real, 5 + way * slots * pins.imag
    guides = guides_of("elliptic-trammel", True, (first, np.full(11, way)), (second, way * slots))
    fits = np.isfinite(guides.joints[0])
    assert fits.tolist() == [False, False, True, True, True, True, False, False, True, False, True]
    assert guides.joints[0, fits] == pytest.approx(5)
    for k in np.flatnonzero(fits):
        assert 10 <= guides.linkage(k, 0j).angle_deg <= 170

"""Polygons against the construction by hand: lines of known direction that meet, and closed forms differentiated."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.instant.polygons import POLE, acceleration_polygon, velocity_polygon
from geomkin.linkage.linkage import Linkage, Slider
from geomkin.linkage.named_linkages import SliderCrank

FOUR_BAR = gk.FourBar(100, 30, 90, 70, 40 + 25j)
# Crank-shaper: the crank's pin carries a block that slides on a lever pivoted 80 mm below.
SHAPER = Linkage(
    {
        "ground": {"crank_pivot": 0j, "lever_pivot": -80j},
        "crank": {"crank_pivot": 0j, "crank_pin": 30 + 0j},
        "block": {"crank_pin": 0j},
        "lever": {"lever_pivot": 0j, "tip": 150 + 0j},
    },
    "crank",
    (Slider("slide", "block", "lever"),),
)


def meet(start_1, along_1, start_2, along_2):
    """Where two lines of a hand construction cross."""
    share = np.imag(np.conj(start_2 - start_1) * along_2) / np.imag(np.conj(along_1) * along_2)
    return start_1 + share * along_1


def of(polygon, kind, body, start, end):
    """The one vector of a kind between two points of a body, 0 where it is left out."""
    found = [v for v in polygon.vectors if (v.kind, v.body, v.start, v.end) == (kind, body, start, end)]
    assert len(found) <= 1
    return found[0].value if found else 0j


@pytest.mark.parametrize("angle", [0.4, 4.0])
@pytest.mark.parametrize("branch", [1, -1])
def test_a_four_bar_by_hand(angle, branch):
    """Velocities from lines square to the links; accelerations from normal parts and lines square to the links."""
    speed, gain = 7.0, -3.0
    motion = gk.move(FOUR_BAR, [angle], branch, speed, gain)
    a, b, c = (complex(motion.point(n).position[0]) for n in ("crank_pin", "rocker_pin", "coupler_point"))
    va = 1j * speed * a
    vb = meet(0, 1j * (b - 100), va, 1j * (b - a))
    vc = meet(va, 1j * (c - a), vb, 1j * (c - b))
    v = velocity_polygon(motion)
    for name, value in {"crank_pin": va, "rocker_pin": vb, "coupler_point": vc, "rocker_pivot": 0}.items():
        assert v.points[name] / v.scale == pytest.approx(value, rel=1e-10)

    aa = (1j * gain - speed**2) * a
    normal_ba = -(abs(vb - va) ** 2) / abs(b - a) ** 2 * (b - a)
    normal_b = -(abs(vb) ** 2) / abs(b - 100) ** 2 * (b - 100)
    ab = meet(normal_b, 1j * (b - 100), aa + normal_ba, 1j * (b - a))
    normal_ca, normal_cb = (-(abs(vc - v) ** 2) / abs(c - p) ** 2 * (c - p) for v, p in ((va, a), (vb, b)))
    ac = meet(aa + normal_ca, 1j * (c - a), ab + normal_cb, 1j * (c - b))
    p = acceleration_polygon(motion)
    for name, value in {"crank_pin": aa, "rocker_pin": ab, "coupler_point": ac}.items():
        assert p.points[name] / p.scale == pytest.approx(value, rel=1e-9)
    assert of(p, "normal", "coupler", "crank_pin", "rocker_pin") == pytest.approx(normal_ba, rel=1e-9)
    assert of(p, "normal", "rocker", "rocker_pivot", "rocker_pin") == pytest.approx(normal_b, rel=1e-9)
    assert of(p, "tangential", "crank", "crank_pivot", "crank_pin") == pytest.approx(1j * gain * a, rel=1e-9)


@pytest.mark.parametrize("polygon_of", [velocity_polygon, acceleration_polygon])
@pytest.mark.parametrize("linkage", [FOUR_BAR, SliderCrank(30, 90, 10, 50 - 20j), SHAPER])
def test_vectors_lead_from_tip_to_tail_and_chains_close(polygon_of, linkage):
    p = polygon_of(gk.move(linkage, [1.0], speed=5.0, acceleration=3.0))
    for v in p.vectors:
        assert (v.tip - v.tail) / p.scale == pytest.approx(v.value)
        if v.kind in ("absolute", "difference"):
            assert v.tail == p.points[v.start] and v.tip == p.points[v.end]
    assert POLE == "pole" and p.points[POLE] == 0
    wholes = {(v.body, v.start, v.end): v.value for v in p.vectors if v.kind == "difference"}
    for (body, start, end), whole in wholes.items():
        if polygon_of is acceleration_polygon:
            parts = [of(p, kind, body, start, end) for kind in ("normal", "tangential")]
            assert sum(parts) == pytest.approx(whole)
            assert abs(np.real(np.conj(parts[0]) * parts[1])) < 1e-9 * abs(whole) ** 2
    for v in p.vectors:
        if v.kind == "sliding":
            chain = of(p, "coriolis", v.body, v.start, v.end) + v.value
            assert p.points[v.start] + p.scale * chain == pytest.approx(p.points[v.end])


@pytest.mark.parametrize("polygon_of", [velocity_polygon, acceleration_polygon])
def test_the_image_of_a_body_is_similar_to_it(polygon_of):
    motion = gk.move(FOUR_BAR, [1.0, 2.0], speed=5.0, acceleration=3.0)
    p = polygon_of(motion, frame=1)
    assert p.images["coupler"] == ("crank_pin", "rocker_pin", "coupler_point")
    image = np.array([p.points[name] for name in p.images["coupler"]])
    body = np.array([motion.point(name).position[1] for name in p.images["coupler"]])
    turned = np.diff(image) / np.diff(body) / p.scale
    assert turned[0] == pytest.approx(turned[1])
    omega, alpha = motion.coupler.omega[1], motion.coupler.alpha[1]
    if polygon_of is velocity_polygon:
        assert turned[0].real == pytest.approx(0, abs=1e-12) and turned[0].imag == pytest.approx(omega)
    else:
        assert abs(turned[0]) == pytest.approx(np.hypot(alpha, omega**2))


def test_coriolis_and_sliding_parts_of_the_shaper_are_those_of_its_closed_form():
    speed, step = 5.0, 1e-4
    time = np.array([-step, 0.0, step])
    pin = 30 * np.exp(1j * (1.0 + speed * time)) + 80j  # from the lever's pivot
    lever, along = np.angle(pin), np.abs(pin)
    turning, sliding = (lever[2] - lever[0]) / (2 * step), (along[2] - along[0]) / (2 * step)
    line = pin[1] / along[1]
    motion = gk.move(SHAPER, [1.0], -1, speed)  # the tip beyond the block
    v, p = velocity_polygon(motion), acceleration_polygon(motion)
    names = "block", "slide on lever", "crank_pin"
    assert of(v, "sliding", *names) == pytest.approx(sliding * line, rel=1e-6)
    assert v.points["slide on lever"] / v.scale == pytest.approx(1j * turning * along[1] * line, rel=1e-6)
    assert of(p, "coriolis", *names) == pytest.approx(2j * turning * sliding * line, rel=1e-6)
    assert of(p, "sliding", *names) == pytest.approx(np.diff(along, 2)[0] / step**2 * line, rel=1e-5)
    assert p.points["crank_pin"] / p.scale == pytest.approx(-(speed**2) * (pin[1] - 80j))
    # The lever's image has its pivot at the pole, its tip, and the point under the block between or beyond.
    assert p.points["slide on lever"] / p.points["tip"] == pytest.approx(along[1] / 150)


@pytest.mark.parametrize("size", [30.0, 170.0])
@pytest.mark.parametrize("speed", [300.0])
def test_the_scale_is_the_largest_round_one_that_fits(size, speed):
    motion = gk.move(FOUR_BAR, [1.0], speed=speed)
    for polygon_of in (velocity_polygon, acceleration_polygon):
        p = polygon_of(motion, size=size)
        ends = np.array([0, *(v.tip for v in p.vectors)])
        extent = max(np.ptp(ends.real), np.ptp(ends.imag))
        mantissa = p.scale / 10 ** np.floor(np.log10(p.scale) + 1e-9)
        next_step = {1: 2, 2: 2.5, 5: 2}[round(mantissa)]
        assert mantissa == pytest.approx(round(mantissa))
        assert extent <= size * (1 + 1e-9) < extent * next_step
        given = polygon_of(motion, scale=2 * p.scale)
        assert given.points["crank_pin"] == pytest.approx(2 * p.points["crank_pin"])


def test_published_velocities_of_a_slider_crank():
    """AME 352: crank 0.12, rod 0.26 m, 65 deg, 1.6 rad/s: slider -0.211 m/s, -0.035 m/s2."""
    motion = gk.move(SliderCrank(120, 260), np.radians([65]), speed=1.6)
    v, a = velocity_polygon(motion), acceleration_polygon(motion)
    assert v.points["slider_pin"] / v.scale == pytest.approx(-211, abs=0.5)
    assert a.points["slider_pin"] / a.scale == pytest.approx(-35, abs=0.5)


@pytest.mark.parametrize("polygon_of", [velocity_polygon, acceleration_polygon])
@pytest.mark.parametrize("linkage", [FOUR_BAR, SHAPER, gk.StephensonSixBar(FOUR_BAR, 120, 90, 100 + 100j)])
def test_every_body_has_its_image_and_vectors_once_around_it(polygon_of, linkage):
    """Of two points one vector, of three or more as many as there are points, from each to the next."""
    motion = gk.move(linkage, [1.0], speed=5.0, acceleration=3.0)
    p, general = polygon_of(motion), motion.linkage
    under = {s.along: f"{s.name} on {s.along}" for s in general.sliders if s.along != general.ground}
    for body, points in general.bodies.items():
        names = (*points, *([under[body]] if body in under else []))
        around = list(zip(names, (*names[1:], names[0]))) if len(names) > 2 else list(zip(names, names[1:]))
        moving = body != general.ground
        assert p.images.get(body, ()) == (names if moving and len(names) > 1 else ())
        drawn = [(v.start, v.end) for v in p.vectors if v.kind == "difference" and v.body == body]
        assert drawn == (around if moving else [])
    pins = {name for points in general.bodies.values() for name in points} - set(general.bodies[general.ground])
    assert sorted(v.end for v in p.vectors if v.kind == "absolute") == sorted(pins | set(under.values()))

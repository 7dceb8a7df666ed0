"""Every make of linkage by what its sizes mean: distances, sides and lines, seen from its ground line."""

import numpy as np
import pytest

import geomkin as gk

TURN = np.linspace(0.1, 6.3, 25)
PLACED = {"origin": 12 - 7j, "ground_angle_deg": 33.0}


class Seen:
    """A motion's points and directions, seen from the ground line."""

    def __init__(self, linkage, drive=TURN, branch=1):
        self.motion = gk.move(linkage, drive, branch)
        assert self.motion.assembled.any()
        self.kept = self.motion.assembled
        self.back = np.exp(-1j * np.radians(33.0))

    def __call__(self, name):
        return (self.motion.point(name).position[self.kept] - PLACED["origin"]) * self.back

    def along(self, body):
        return self.motion.bodies[body].direction[self.kept] * self.back

    def drive(self):
        return self.motion.drive[self.kept]


def left(line, place):
    return np.imag(np.conj(line) * place)


def ahead(line, place):
    return np.real(np.conj(line) * place)


def fixed(value):
    return pytest.approx(value, abs=1e-11)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("driver", ["crank", "coupler", "rocker"])
def test_a_four_bar(driver, branch):
    seen = Seen(gk.FourBar(100, 30, 90, 70, 40 + 25j, driver=driver, **PLACED), branch=branch)
    a, b = seen("crank_pin"), seen("rocker_pin")
    assert seen("crank_pivot") == fixed(0j) and seen("rocker_pivot") == fixed(100 + 0j)
    assert abs(a) == fixed(30.0) and abs(b - a) == fixed(90.0) and abs(b - 100) == fixed(70.0)
    assert seen("coupler_point") == pytest.approx(a + (b - a) / 90 * (40 + 25j))
    assert seen.along("crank") == pytest.approx(a / 30) and seen.along("coupler") == pytest.approx((b - a) / 90)
    assert seen.along("rocker") == pytest.approx((b - 100) / 70)
    assert seen.along(driver) == pytest.approx(np.exp(1j * seen.drive()))


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("driver", ["crank", "coupler", "slider"])
def test_a_slider_crank(driver, branch):
    drive = np.linspace(60, 118, 20) if driver == "slider" else TURN
    seen = Seen(gk.SliderCrank(30, 90, 12, 40 + 25j, driver=driver, **PLACED), drive, branch)
    a, s = seen("crank_pin"), seen("slider_pin")
    assert abs(a) == fixed(30.0) and abs(s - a) == fixed(90.0) and s.imag == fixed(12.0)
    assert seen("coupler_point") == pytest.approx(a + (s - a) / 90 * (40 + 25j))
    assert seen.along("coupler") == pytest.approx((s - a) / 90) and seen.along("slider") == pytest.approx(1 + 0j)
    if driver == "slider":
        assert s.real == pytest.approx(seen.drive()) and (branch * left(s, a) > -1e-9).all()
    else:
        assert seen.along(driver) == pytest.approx(np.exp(1j * seen.drive()))
    if driver == "crank":
        assert (branch * (s - a).real > 0).all()
    assert seen.motion.slide("slide").displacement[seen.kept] == pytest.approx(s.real)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("driver", ["crank", "rocker"])
@pytest.mark.parametrize("line", ["rocker", "coupler"])
@pytest.mark.parametrize(("ground", "crank"), [(80, 30), (20, 60)])
def test_an_inverted_slider_crank(ground, crank, line, driver, branch):
    linkage = gk.InvertedSliderCrank(ground, crank, 7, line, 130 + 5j, driver=driver, **PLACED)
    seen = Seen(linkage, branch=branch)
    a, c = seen("crank_pin"), seen("rocker_pivot")
    assert abs(a) == fixed(float(crank)) and c == fixed(ground + 0j)
    turn = seen.along(line)
    assert seen.along("coupler") == pytest.approx(seen.along("rocker"))
    pin, other, point = (c, a, "rocker_point") if line == "rocker" else (a, c, "coupler_point")
    assert left(turn, other - pin) == fixed(7.0)
    assert seen(point) == pytest.approx(pin + turn * (130 + 5j))
    if driver == "crank":
        assert (branch * ahead(turn, other - pin) > 0).all()
    assert seen.along(driver) == pytest.approx(np.exp(1j * seen.drive()))
    assert abs(seen.motion.slide("slide").displacement[seen.kept]) == pytest.approx(abs(ahead(turn, other - pin)))


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("driver", ["rod", "shuttle"])
def test_an_elliptic_trammel(driver, branch):
    drive = np.linspace(-60, 60, 24) if driver == "shuttle" else TURN
    seen = Seen(gk.EllipticTrammel(60, 100 - 20j, 75, driver, **PLACED), drive, branch)
    one, two = seen("shuttle_pin"), seen("cross_pin")
    slot = np.exp(1j * np.radians(75))
    assert one.imag == fixed(0.0) and left(slot, two) == fixed(0.0) and abs(two - one) == fixed(60.0)
    assert seen("rod_point") == pytest.approx(one + (two - one) / 60 * (100 - 20j))
    if driver == "rod":
        assert two - one == pytest.approx(60 * np.exp(1j * seen.drive()))
    else:
        assert one.real == pytest.approx(seen.drive())
        # From the foot of the first shuttle on the second's slot.
        assert (branch * (ahead(slot, two) - ahead(slot, one)) > 0).all()


def test_a_scotch_yoke():
    seen = Seen(gk.ScotchYoke(30, 100, 70, **PLACED))
    a, end = seen("crank_pin"), seen("yoke_end")
    slot = np.exp(1j * np.radians(70))
    assert a == pytest.approx(30 * np.exp(1j * seen.drive())) and end.imag == fixed(0.0)
    # The slot's middle stands the guide's length behind the end, and the pin in the slot.
    assert left(slot, a - (end - 100)) == fixed(0.0)
    assert seen.motion.slide("way").displacement + 100 == pytest.approx(end.real)
    assert seen.motion.slide("slot").displacement == pytest.approx(ahead(slot, a - (end - 100)))


def test_an_oldham_coupling():
    seen = Seen(gk.OldhamCoupling(6, **PLACED))
    turn = np.exp(1j * seen.drive())
    middle = (seen.motion.disc.origin.position - PLACED["origin"]) * seen.back
    assert seen("driven_pivot") == fixed(6 + 0j)
    for body in ("driving", "disc", "driven"):
        assert seen.along(body) == pytest.approx(turn)
    # Each tongue leads through its shaft, and the two stand square: the middle runs round the circle over both shafts.
    assert left(turn, middle) == fixed(0.0) and ahead(turn, middle - 6) == fixed(0.0)
    assert abs(middle - 3) == fixed(3.0)


@pytest.mark.parametrize("branch", [1, -1])
def test_a_shaper(branch):
    seen = Seen(gk.Shaper(90, 30, 180, 60, 85, **PLACED), branch={"slide": 1, "ram_pin": branch})
    a, pivot, tip, ram = (seen(name) for name in ("crank_pin", "lever_pivot", "lever_tip", "ram_pin"))
    assert a == pytest.approx(30 * np.exp(1j * seen.drive())) and pivot == fixed(90 + 0j)
    assert tip == pytest.approx(pivot + 180 * (a - pivot) / abs(a - pivot)) and abs(ram - tip) == fixed(60.0)
    assert ram.real == fixed(-85.0) and (branch * (ram - tip).imag > 0).all()
    assert seen.motion.slide("ram_slide").displacement == pytest.approx(ram.imag)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("make", ["stephenson", "watt"])
def test_a_six_bar(make, branch):
    four_bar = gk.FourBar(100, 30, 90, 70, 40 + 25j, **PLACED)
    linkage, name = {
        "stephenson": (gk.StephensonSixBar(four_bar, 80, 60, 60 + 120j), "coupler_point"),
        "watt": (gk.WattSixBar(four_bar, 50 - 30j, 90, 65, 180 + 5j), "rocker_point"),
    }[make]
    seen = Seen(linkage, branch={"output_pin": branch})
    start, pin, pivot = seen(name), seen("output_pin"), seen("output_pivot")
    c, b = seen("rocker_pivot"), seen("rocker_pin")
    assert pivot == fixed(complex(linkage.output_pivot))
    assert abs(pin - start) == fixed(float(linkage.link)) and abs(pin - pivot) == fixed(float(linkage.output))
    assert (branch * left(pivot - start, pin - start) > 0).all()
    if make == "watt":
        assert start == pytest.approx(c + (b - c) / 70 * (50 - 30j))

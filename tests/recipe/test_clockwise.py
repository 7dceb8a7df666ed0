"""A driver that turns clockwise, or slides backwards, and one that has an acceleration, through recipes."""

import csv
import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.settings import Drive, Stroke, Turn
from tests.campaign import by_default
from tests.texts import parse, template_of

RPM = 30 / np.pi
RECIPES = Path(__file__).parents[2] / "recipes"


def rows_of(tmp_path, text):
    """The rows of the CSV that a recipe's file makes, by the driver's angle in whole deg."""
    file = tmp_path / "example.toml"
    file.write_text(text)
    gk.make(gk.load(file), tmp_path / "out")
    (made,) = (tmp_path / "out").rglob("example.csv")
    with made.open() as lines:
        rows = [{key: float(cell or "nan") for key, cell in row.items()} for row in csv.DictReader(lines)]
    return {round(row["crank_angle_deg"]): row for row in rows}


def text_of(kind, linkage, speed, acceleration, more=""):
    sizes = "\n".join(f"{key} = {value}" for key, value in linkage.items())
    return (
        f'kind = "{kind}"\n{more}[linkage]\n{sizes}\n[drive]\nspeed_rpm = {speed * RPM!r}\n'
        f'acceleration_rad_per_s2 = {acceleration}\nstep_deg = 30\n[files]\nwrite = ["csv"]\n'
    )


ANGLES = ("rocker_angle_deg", "coupler_angle_deg")
RATES = ("rocker_omega_rad_per_s", "coupler_omega_rad_per_s", "rocker_alpha_rad_per_s2", "coupler_alpha_rad_per_s2")


@pytest.mark.parametrize("sense", [1, -1])
def test_a_recipe_and_its_mirror_image_have_the_motion_of_the_library(tmp_path, sense):
    linkage = {"ground": 600, "crank": 300, "coupler": 360, "rocker": 360}
    text = text_of("four-bar", linkage, 10 * sense, -30 * sense, f"branch = {sense}\n")
    rows = rows_of(tmp_path, text)
    for crank_deg in (0, 30, 60, 90, 270, 300, 330):
        motion = gk.move(gk.FourBar(**linkage), [np.radians(crank_deg)], speed=10, acceleration=-30)
        bodies = [motion["rocker"], motion["coupler"]]
        rates = [body.omega[0] for body in bodies] + [body.alpha[0] for body in bodies]
        row = rows[sense * crank_deg]
        for name, body in zip(ANGLES, bodies):
            assert np.exp(1j * sense * np.radians(row[name])) == pytest.approx(body.direction[0], abs=1e-6)
        assert [sense * row[name] for name in RATES] == pytest.approx(rates, rel=1e-5)
    assert all(np.isnan(rows[sense * angle]["rocker_angle_deg"]) for angle in (120, 180, 240))


DRIVES = {
    "four-bar": "[drive]\nspeed_rpm = -90\nacceleration_rad_per_s2 = 40\n",
    "inverted-slider-crank": "[drive]\nspeed_rpm = -30\nacceleration_rad_per_s2 = -15\nstart_deg = 80\nend_deg = 20\n",
    "watt-six-bar": "[drive]\nspeed_rpm = -20\nacceleration_rad_per_s2 = 7\nend_deg = -50\n",
    "slider-crank": "[stroke]\nstart = 110\nend = 80\nspeed = -200\nacceleration_mm_per_s2 = 3000\n",
}


@pytest.mark.parametrize("kind", DRIVES)
def test_rates_are_those_of_a_driver_that_speeds_up_at_its_place(kind):
    """By central differences of positions along q + w t + a t2 / 2, whose rates at t = 0 are the driver's own."""
    slides = "[stroke]" in DRIVES[kind]
    text = template_of(kind, ["stroke"] if slides else [])
    head = text.split("[stroke]" if slides else "[drive]")[0]
    recipe = parse(head + DRIVES[kind])
    way = recipe.input_range
    assert way.speed < 0 and way.frames[-1] < way.frames[0] and np.all(np.diff(way.frames) < 0)
    h, motion = 1e-4, recipe.motion
    t = np.array([-2, -1, 0, 1, 2]) * h
    for k in (0, len(way.frames) // 2, -1):
        q = way.frames[k] + way.speed * t + way.acceleration * t**2 / 2
        moved = gk.move(recipe.linkage, q, recipe.made.branch)
        for name, body in moved.bodies.items():
            angle = np.unwrap(np.angle(body.direction))
            omega = angle @ [1, -8, 0, 8, -1] / (12 * h)
            alpha = angle @ [-1, 16, -30, 16, -1] / (12 * h**2)
            size = 1 + abs(omega) + abs(alpha)
            assert motion.bodies[name].omega[k] == pytest.approx(omega, abs=1e-7 * size)
            assert motion.bodies[name].alpha[k] == pytest.approx(alpha, abs=1e-5 * size)


# Of the gallery: a slide, copies, a branch that is followed, slots, loops that are iterated, a goal that slides.
SAME_PARTS = ("slider-crank-by-slider", "walker", "parallelogram", "sieve", "centrodes")


@pytest.mark.parametrize("name", by_default(SAME_PARTS, set(SAME_PARTS) - {"walker"}))
def test_parts_do_not_depend_on_the_sense_of_the_driver(name):
    data = tomllib.loads((RECIPES / f"{name}.toml").read_text())
    turned = tomllib.loads((RECIPES / f"{name}.toml").read_text())
    if stroke := turned.get("stroke"):
        stroke |= {"start": stroke["end"], "end": stroke["start"], "speed": -stroke.get("speed", 50)}
    else:
        drive = turned.setdefault("drive", {})
        drive["speed_rpm"] = -drive.get("speed_rpm", 60)
        if "start_deg" in drive or "end_deg" in drive:
            drive |= {"start_deg": drive.get("end_deg", 360), "end_deg": drive.get("start_deg", 0)}
    one, other = gk.load(data), gk.load(turned)
    assert [part.name for part in one.parts] == [part.name for part in other.parts]

    def boxes(recipe):
        for part in recipe.parts:
            curves = (part.outline, *part.holes, *part.marks)
            ends = [gk.flatten(curve, 0.01) for curve in curves if curve is not None]
            yield sorted(round(f(z), 6) + 0.0 for z in ends for f in (lambda z: z.real.min(), lambda z: z.imag.max()))

    for before, after in zip(boxes(one), boxes(other)):
        assert after == pytest.approx(before, abs=1e-6)
    assert [c.value for c in one.checks] == pytest.approx(
        [c.value for c in other.checks], rel=1e-9, abs=1e-9, nan_ok=True
    )
    first, last = one.table.columns[0].values[[0, -1]]
    start, end = other.table.columns[0].values[[0, -1]]
    assert (end - start) == pytest.approx(first - last)
    assert np.all(np.diff(other.scene.time) > 0)


def test_without_a_start_and_an_end_a_clockwise_turn_goes_to_minus_360():
    assert Turn(speed_rpm=-60).span_deg == (0, -360) and Turn().span_deg == (0, 360)
    assert Turn(speed_rpm=-60, start_deg=90).span_deg == (90, -360)
    time = gk.load({"kind": "four-bar", "linkage": BAR, "drive": {"speed_rpm": -60}}).table["time"]
    assert time[0] == 0 and not np.signbit(time[0]) and time[-1] == pytest.approx(1)


BAR = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}


def test_an_end_where_the_speed_does_not_go_is_refused():
    for make, field in [
        (lambda: Turn(speed_rpm=-60, start_deg=0, end_deg=90), "end_deg"),
        (lambda: Turn(speed_rpm=60, start_deg=0, end_deg=-90), "end_deg"),
        (lambda: Turn(speed_rpm=-60, end_deg=360), "end_deg"),
        (lambda: Turn(start_deg=400), "start_deg"),
        (lambda: Turn(speed_rpm=-60, start_deg=-360), "start_deg"),
        (lambda: Turn(speed_rpm=0), "speed_rpm"),
        (lambda: Drive(speed_rpm=-1e-4), "speed_rpm"),
        (lambda: Drive(acceleration_rad_per_s2=float("inf")), "acceleration_rad_per_s2"),
        (lambda: Stroke(start=0, end=10, speed=-5), "end"),
        (lambda: Stroke(start=10, end=0), "end"),
        (lambda: Stroke(start=0, end=10, speed=0), "speed"),
    ]:
        with pytest.raises(gk.DesignError) as caught:
            make()
        assert caught.value.field == field


def test_a_clockwise_goal_makes_a_clockwise_recipe():
    data = tomllib.loads((RECIPES / "wiper.toml").read_text()) | {"drive": {"speed_rpm": -40}}
    found = gk.load(data).design
    assert found.drive.span_deg == (0, -360) and found.drive.speed_rpm == -40
    data = tomllib.loads((RECIPES / "poses-by-slider.toml").read_text())
    forth, back = (
        gk.load(data | {"drive": {"speed_rpm": rpm, "acceleration_rad_per_s2": 3}}).design.stroke for rpm in (30, -30)
    )
    assert (back.start, back.end, back.speed) == (forth.end, forth.start, -forth.speed)
    # Half a turn's time for the whole way, and the same share of it per s2.
    assert forth.acceleration_mm_per_s2 / (forth.end - forth.start) == pytest.approx(3 / np.pi)

"""Sizes of what is sold, as the standards print them: what is bought by another would not fit."""

from fractions import Fraction
from math import cos, pi

import pytest

import geomkin as gk
from geomkin.making.bores import LENGTHS as KEY_LENGTHS
from geomkin.making.bores import PARALLEL_KEYS, key_of
from geomkin.making.fasteners import LENGTHS, SIZES
from geomkin.recipe.load import to_toml

# DIN 6885-1: shaft up to, width, height, depth in the shaft, in the hub, lengths from and to.
KEYS = """
  8  2  2  1.2  1.0   6  20
 10  3  3  1.8  1.4   6  36
 12  4  4  2.5  1.8   8  45
 17  5  5  3.0  2.3  10  56
 22  6  6  3.5  2.8  14  70
 30  8  7  4.0  3.3  18  90
 38 10  8  5.0  3.3  22 110
 44 12  8  5.0  3.3  28 140
 50 14  9  5.5  3.8  36 160
 58 16 10  6.0  4.3  45 180
 65 18 11  7.0  4.4  50 200
 75 20 12  7.5  4.9  56 220
 85 22 14  9.0  5.4  63 250
 95 25 14  9.0  5.4  70 280
110 28 16 10.0  6.4  80 320
130 32 18 11.0  7.4  90 360
150 36 20 12.0  8.4 100 400
170 40 22 13.0  9.4 100 400
200 45 25 15.0 10.4 110 400
230 50 28 17.0 11.4 125 400
"""
# Thread, its pitch, the head's diameter and height (ISO 7380-1, below M3 ISO 4762), lengths from and to, the nut's
# corners and height (ISO 7040, below M3 ISO 4032), the washer's outer diameter and thickness (ISO 7089).
SCREWS = """
1.6 0.35  3.0 1.60  3 16  3.41 1.3  4 0.3
2.0 0.40  3.8 2.00  3 20  4.32 1.6  5 0.3
2.5 0.45  4.5 2.50  4 25  5.45 2.0  6 0.5
3.0 0.50  5.7 1.65  6 30  6.01 4.5  7 0.5
4.0 0.70  7.6 2.20  8 40  7.66 6.0  9 0.8
5.0 0.80  9.5 2.75 10 50  8.79 6.8 10 1.0
6.0 1.00 10.5 3.30 10 60 11.05 8.0 12 1.6
8.0 1.25 14.0 4.40 12 80 14.38 9.5 16 1.6
"""
# R20 and R10 numbers as shops have them: ISO 888 of screws, DIN 6885-1 of keys.
OF_SCREWS = "3 4 5 6 8 10 12 16 20 25 30 35 40 45 50 55 60 65 70 80"
OF_KEYS = """6 8 10 12 14 16 18 20 22 25 28 32 36 40 45 50 56 63 70 80 90 100 110 125 140 160 180 200 220 250 280 400"""


def rows(table):
    return [[float(number) for number in line.split()] for line in table.split("\n") if line.strip()]


def test_keys_are_those_of_the_standard():
    found = [
        [k.thickest, k.width, k.height, k.shaft_depth, k.hub_depth, *k.lengths] for k in PARALLEL_KEYS
    ]  # fmt: skip
    assert found == rows(KEYS)
    assert [list(KEY_LENGTHS)] == rows(OF_KEYS.replace("\n", " "))


# ASME B17.1, table 2: shaft, width of the square key, and the distances S and T from the bottom of the keyway in shaft and
# hub to the opposite side, in.
INCH_KEYS = """
0.5    0.125   0.430 0.560
0.625  0.1875  0.517 0.709
0.75   0.1875  0.644 0.837
1.0    0.25    0.859 1.114
1.25   0.25    1.112 1.367
1.5    0.375   1.289 1.669
2.0    0.5     1.718 2.223
2.5    0.625   2.148 2.778
3.0    0.75    2.577 3.332
4.0    1.0     3.437 4.442
"""


def test_keys_of_inch_shafts_are_those_of_the_standard():
    for shaft, width, across_shaft, across_hub in rows(INCH_KEYS):
        key = key_of(25.4 * shaft)
        assert key.width == pytest.approx(25.4 * width) and key.height == pytest.approx(key.width)
        assert shaft - key.shaft_depth / 25.4 == pytest.approx(across_shaft, abs=6e-4)
        assert shaft + key.hub_depth / 25.4 == pytest.approx(across_hub, abs=6e-4)
    # Metric shafts, and inch shafts below the range, have metric keys.
    assert [key_of(shaft).width for shaft in (12.0, 127.0, 7.9375)] == [4, 32, 2]


def test_inch_gear_is_keyed_and_billed_by_the_inch_standard():
    gear = {"kind": "spur-gear", "units": "in", "gear": {"teeth": 24, "module": 0.1}}
    recipe = gk.load({**gear, "stock": {"bore": 0.5, "bore_form": "keyed", "thickness": 0.25}})
    assert recipe.stock.keyway == pytest.approx((3.175, 25.4 * (0.560 - 0.5)), abs=0.02)
    (key,) = (item.name for item in recipe.bought if "B17.1" in item.name)
    assert "1/8 in" in key and gk.load(to_toml(recipe)).stock == recipe.stock


def test_screws_nuts_and_washers_are_those_of_the_standards():
    metric = {d: s for d, s in SIZES.items() if s.thread.startswith("M")}
    found = [[d, s.pitch, *s.head, *s.lengths, s.nut_width, s.nut_height, *s.washer] for d, s in metric.items()]
    assert found == rows(SCREWS)
    assert [list(LENGTHS)] == rows(OF_SCREWS)
    assert {s.screw.split()[-1] for d, s in metric.items() if d < 3} == {"4762"}
    assert {s.nut.split()[-1] for d, s in metric.items() if d >= 3} == {"7040"}


# Thread, diameter and height of a button head (ASME B18.3), width across the flats of the nut and its height (B18.6.3 of
# #2, B18.16.6 of the others), the washer's outer diameter and thickness (B18.21.1): inches.
INCH_SCREWS = {
    "#2-56": (0.164, 0.046, 3 / 16, 0.066, 0.250, 0.020),
    "#4-40": (0.213, 0.059, 1 / 4, 0.163, 0.312, 0.032),
    "#6-32": (0.262, 0.073, 5 / 16, 0.188, 0.375, 0.049),
    "#8-32": (0.312, 0.087, 11 / 32, 0.239, 0.438, 0.049),
    "#10-24": (0.361, 0.101, 3 / 8, 0.249, 0.500, 0.049),
    "1/4-20": (0.437, 0.132, 7 / 16, 0.328, 0.625, 0.065),
    "5/16-18": (0.547, 0.166, 1 / 2, 0.359, 0.688, 0.065),
}


def test_inch_screws_are_those_of_the_standards():
    inch = {size.thread: (diameter, size) for diameter, size in SIZES.items() if not size.thread.startswith("M")}
    assert list(inch) == list(INCH_SCREWS)
    for thread, (head, high, flats, nut, washer, thick) in INCH_SCREWS.items():
        diameter, size = inch[thread]
        number, per_inch = thread.split("-")
        # ASME B1.1: the diameter of a numbered size is 0.060 in and 0.013 in for each number.
        major = 0.06 + 0.013 * int(number[1:]) if number[0] == "#" else float(Fraction(number))
        assert diameter == pytest.approx(25.4 * major, abs=1e-9)
        assert size.pitch * int(per_inch) == pytest.approx(25.4)
        assert [*size.head, size.nut_height, *size.washer] == pytest.approx(
            [25.4 * length for length in (head, high, nut, washer, thick)]
        )
        # The largest width across corners is that of sharp ones.
        assert size.nut_width == pytest.approx(25.4 * flats / cos(pi / 6), abs=0.02)


@pytest.mark.parametrize("thread", [*INCH_SCREWS, "M3", "M4"])
def test_thread_in_a_recipe_is_its_diameter_and_is_written_back(thread):
    stock = {"thickness": 3, "pin_diameter": thread}
    linkage = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
    recipe = gk.load({"kind": "four-bar", "linkage": linkage, "stock": stock})
    (screw,) = (item.name for item in recipe.bought if " x " in item.name)
    assert screw.startswith(f"{thread} x ")
    assert gk.load(to_toml(recipe)).stock == recipe.stock
    assert thread.startswith("M") or f'"{thread}"' in to_toml(recipe)
    # The screw reaches through plates, washer and nut.
    length = screw.split(" x ")[1].split(" button")[0].split(" cap")[0].split(" in")[0]
    long = float(sum(Fraction(part) for part in length.split("-"))) * (1 if thread.startswith("M") else 25.4)
    size = recipe.stock.fastener_used.size
    assert long >= 6 + size.washer[1] + size.nut_height + size.pitch


def test_threads_of_bases_and_motors_have_names_too():
    gear = {"teeth": 24, "module": 2}
    pair = {"kind": "gear-pair", "first": gear, "second": gear, "first_stock": {"bore": 8}, "second_stock": {"bore": 8}}
    recipe = gk.load(pair | {"base": {"screw": "1/4-20"}})
    assert any(item.name.startswith("screw 1/4-20, at least") for item in recipe.bought)
    with pytest.raises(gk.RecipeError, match=r"#6-32"):
        gk.load(pair | {"base": {"screw": "#7-32"}})

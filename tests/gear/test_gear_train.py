"""Gear trains: every train within small bounds tried, teeth laid over each other, losses integrated, arbors measured."""

from fractions import Fraction
from itertools import combinations, product
from math import prod
from pathlib import Path

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.plane import region
from geomkin.recipe.load import parse, to_toml

CASES = Path(__file__).parents[1] / "cases"
LOW, HIGH = 6, 11
PAIRS = list(product(range(LOW, HIGH + 1), repeat=2))
BOUNDS = {"least_teeth": LOW, "most_teeth": HIGH}


def ratio_of(stages):
    return prod(Fraction(driven, driver) for driver, driven in stages)


def every_train(most_stages=3, choice=lambda stages: True):
    """Fewest stages, fewest teeth, ratio of every train within the bounds."""
    trains = {}
    for count in range(1, most_stages + 1):
        for stages in product(PAIRS, repeat=count):
            if choice(stages):
                key = (count, ratio_of(stages))
                trains[key] = min(sum(map(sum, stages)), trains.get(key, 10**9))
    return [(count, teeth, ratio) for (count, ratio), teeth in trains.items()]


@pytest.fixture(scope="module")
def trains():
    return every_train()


@pytest.mark.campaign
@pytest.mark.parametrize("error", [0.0, 1e-3, 0.02])
def test_the_search_finds_the_fewest_gears_and_teeth_of_all_trains(trains, error):
    generator = np.random.default_rng(29)
    ratios = [trains[k][2] * Fraction(j) for k in generator.integers(len(trains), size=6) for j in (1, "1.0004")]
    for ratio in ratios:
        fits = [(n, teeth, abs(r / ratio - 1)) for n, teeth, r in trains if abs(r / ratio - 1) <= max(error, 1e-12)]
        if not fits:
            with pytest.raises(gk.DesignError, match="ratio") as caught:
                gk.gear_train(float(ratio), error=error, **BOUNDS)
            nearest = min(abs(r / ratio - 1) for _, _, r in trains)
            advised = float(caught.value.remedy.split()[1])
            assert abs(advised / float(ratio) - 1) == pytest.approx(float(nearest), rel=1e-6)
            assert abs(gk.gear_train(advised, error=1e-10, **BOUNDS).ratio) == pytest.approx(advised, rel=1e-10)
            continue
        train = gk.gear_train(float(ratio), error=error, **BOUNDS)
        found = ratio_of(train.stages)
        assert abs(train.ratio) == float(found) and np.sign(train.ratio) == (-1) ** len(train.stages)
        assert (len(train.stages), sum(map(sum, train.stages))) == min(fits)[:2]
        assert abs(found / ratio - 1) == pytest.approx(float(min(fits)[2]), abs=1e-12)


def test_reverted_trains_and_given_centre_distances_have_the_fewest_teeth():
    reverted = every_train(2, lambda stages: len(stages) == 2 and sum(stages[0]) == sum(stages[1]))
    for _, teeth, ratio in reverted[::9]:
        train = gk.gear_train(float(ratio), reverted=True, **BOUNDS)
        fewest = min(n for _, n, r in reverted if r == ratio)
        assert sum(map(sum, train.stages)) == fewest <= teeth and ratio_of(train.stages) == ratio
        assert abs(train.axes[2] - train.axes[0]) < 1e-12 and train.arbors == ("A", "B", "A")
    train = gk.gear_train(7, 1.5, centre_distance=36)
    assert ratio_of(train.stages) == 7 and np.diff(train.axes) == pytest.approx([36] * 3)
    assert all(sum(teeth) == 48 for teeth in train.stages)


def test_published_trains_are_found():
    # Two stages of 60: a clock; 12: its motion work; 100 needs a third stage up to 60 teeth (by full enumeration).
    assert gk.gear_train(60, least_teeth=8, most_teeth=80).stages == ((8, 60), (8, 64))
    assert gk.gear_train(12, least_teeth=8, reverted=True).stages == ((10, 30), (8, 32))
    assert sum(map(sum, gk.gear_train(100).stages)) == 204
    assert sum(map(sum, gk.gear_train(100, most_teeth=120, most_stages=2).stages)) == 264
    # The largest ratio of three stages up to 44 teeth is (44/12)^3.
    with pytest.raises(gk.DesignError) as caught:
        gk.gear_train(50, most_teeth=44)
    assert float(caught.value.remedy.split()[1]) == pytest.approx((44 / 12) ** 3, rel=1e-11)


TRAINS = {
    "reverted": gk.GearTrain(((10, 30), (8, 32)), 2, (0, 180)),
    "folded": gk.GearTrain(((12, 36), (20, 21), (40, 17)), 1.5, (30, -75.5, 260)),
}


@pytest.mark.parametrize("train", TRAINS.values(), ids=TRAINS)
def test_teeth_mesh_without_overlap_until_the_backlash_is_used_up(train):
    for turn in (0.0, 0.07, 2.9, 31.4):
        poses = train.poses(turn)
        for k, pair in enumerate(train.pairs):
            first, second = (gk.flatten(gear.outline, 1e-4) for gear in (pair.first, pair.second))
            placed = poses[k].place(first)
            assert abs(poses[k + 1].origin - train.axes[k + 1]) < 1e-12
            assert region.overlap([placed], [poses[k + 1].place(second)]) < 1e-3
            # Half the backlash on each side of a tooth.
            for side in (1, -1):
                for share, meets in ((0.4, False), (0.8, True)):
                    play = side * share * train.backlash * train.module / pair.second.pitch_radius
                    turned = poses[k + 1].place(second * np.exp(1j * play))
                    assert (region.overlap([placed], [turned]) > 1e-3) == meets


@pytest.mark.parametrize("train", TRAINS.values(), ids=TRAINS)
def test_pitch_circles_roll_without_slip(train):
    step, speeds = 1e-4, [float(speed) for speed in train.speeds]
    before, after = train.poses(1 - step), train.poses(1 + step)
    assert [float(np.angle(b.direction / a.direction)) / 2 / step for a, b in zip(before, after)] == pytest.approx(
        speeds, rel=1e-7
    )
    for k, pair in enumerate(train.pairs):
        one, two = pair.working_radii
        assert one * speeds[k] == pytest.approx(-two * speeds[k + 1])
    assert train.ratio == pytest.approx(1 / speeds[-1])


@pytest.mark.parametrize("teeth", [(12, 48), (20, 40), (30, 10), (45, 45)])
def test_efficiency_is_one_less_the_friction_work_of_the_flanks(teeth):
    train = gk.GearTrain((teeth,), 2, friction=0.08)
    (pair,) = train.pairs
    start, end = pair.contact_lengths
    pitch = pair.first.base_pitch
    along = np.linspace(start, end, 200_001)
    # Normal force 1, shared by the pairs of flanks in contact; speed 1 along the line of action.
    pairs = sum((along + k * pitch >= start) & (along + k * pitch <= end) for k in (-1, 0, 1))
    omega = np.array([1, teeth[0] / teeth[1]]) / pair.first.base_radius
    pitch_point = np.sqrt(pair.working_radii[0] ** 2 - pair.first.base_radius**2)
    sliding = np.abs(along - pitch_point) * omega.sum()
    lost = 0.08 * np.trapezoid(sliding / pairs, along) / pitch
    assert train.efficiency == pytest.approx(1 - lost, rel=1e-4)
    assert gk.GearTrain((teeth, teeth), 2, friction=0.08).efficiency == pytest.approx((1 - lost) ** 2, rel=2e-4)


def loaded(**train):
    return gk.load({"kind": "gear-train", "train": {"module": 2, **train}, "stock": {"thickness": 4}})


FOLDED = {"stages": [[14, 36], [12, 40], [13, 44]], "directions_deg": [0, 100, 60]}


@pytest.mark.parametrize(
    ("train", "nearest", "passes"),
    [
        pytest.param({**FOLDED, "directions_deg": [0, 100, 20]}, "", True, marks=pytest.mark.campaign),
        pytest.param({**FOLDED, "directions_deg": [0, 100, 60]}, "", True, marks=pytest.mark.campaign),
        ({**FOLDED, "directions_deg": [0, 100, 215]}, "collar on A", False),
        ({"stages": [[14, 36], [12, 32]]}, "tube on C", True),
    ],
)
def test_the_gap_beside_arbors_is_that_of_the_swept_gears(train, nearest, passes):
    recipe = loaded(**train)
    train, sheet, solids = recipe.design, 4, []
    for part in recipe.parts[:-1]:
        stage, outline = int(part.name[-1]) - 1, gk.flatten(part.outline, 1e-3)
        axis = stage + part.name.startswith("driven")
        solids.append((axis, stage, disc(train.axes[axis], np.abs(outline).max()), stage * sheet, (stage + 1) * sheet))
    for axis, z in enumerate(train.axes):
        # Arbors of 5 mm with tubes of 7 mm below the gears; collars of DIN 705 A are 10 mm wide and 8 mm high at most.
        foot, top = max(axis - 1, 0) * sheet, min(axis + 1, len(train.stages)) * sheet
        for radius, low, high in ((3.5, 0, foot), (2.5, foot, top), (5, top, top + 8)):
            solids.append((axis, None, disc(z, radius), low, high))
    gaps = [
        one.distance(other)
        for (k, i, one, low, high), (m, j, other, least, most) in combinations(solids, 2)
        if k != m and (i is None or i != j) and max(low, least) < min(high, most)
    ]
    check = next(check for check in recipe.checks if check.id == "arbor_gap")
    assert max(check.value, 0) == pytest.approx(min(gaps), abs=1e-3)
    assert check.passed == passes and nearest in check.name


def disc(centre, radius):
    return shapely.Point(centre.real, centre.imag).buffer(radius, quad_segs=500)


def test_parts_fit_on_their_arbors_and_the_bill_counts_them():
    recipe = loaded(**FOLDED)
    train, parts = recipe.design, {part.name: part for part in recipe.parts}
    base = parts["base"]
    centres = {name: hole.centre for name, hole in zip(base.hole_names, base.holes) if name}
    assert [centres[letter] for letter in "ABCD"] == pytest.approx(list(train.axes), abs=1e-9)
    for k in (1, 2):
        lower, upper = parts[f"driven_{k}"], parts[f"driver_{k + 1}"]
        assert [(h.centre, h.radius) for h in lower.holes] == [(h.centre, h.radius) for h in upper.holes]
        assert len(lower.holes) == 3
    bought = {item.name.split(",")[0]: item.count for item in recipe.bought}
    assert bought["pin 2 mm"] == 4 and bought["shaft collar DIN 705 A"] == 8
    # Arbors end above their highest gear, with room for both collars: base 4, layers of 4, collars of 8.
    lengths = {item.joints: item.name for item in recipe.bought if item.name.startswith("shaft 5 mm")}
    assert "24 mm" in lengths[("A",)] and "28 mm" in lengths[("B",)] and "32 mm" in lengths[("C", "D")]
    scene = recipe.scene
    assert {body.name: body.layer for body in scene.bodies} == {
        "ground": 0, "driver_1": 1, "driven_1": 1, "driver_2": 2, "driven_2": 2, "driver_3": 3, "driven_3": 3
    }  # fmt: skip
    for k in (1, 2):
        one, two = (next(b for b in scene.bodies if b.name == name) for name in (f"driven_{k}", f"driver_{k + 1}"))
        assert np.array_equal(one.direction, two.direction) and np.array_equal(one.origin, two.origin)


@pytest.mark.parametrize(
    ("recipe", "field"),
    [
        ({"train": {"module": 2}}, "train.ratio"),
        ({"train": {"module": 2, "ratio": 12, "stages": [[12, 36]]}}, "train.ratio"),
        ({"train": {"module": 2, "ratio": 50, "most_teeth": 44}}, "train.ratio"),
        ({"train": {"module": 2, "ratio": 7, "centre_distance": 48.3}}, "train.centre_distance"),
        ({"train": {"module": 2, "ratio": 1, "centre_distance": 24}}, "train.centre_distance"),
        ({"train": {"module": 2, "ratio": 100.003, "most_teeth": 400}}, "train.most_teeth"),
        ({"train": {"module": 2, "stages": [[12, 36], [12, 40]], "arrangement": "reverted"}}, "train.stages"),
        ({"train": {"module": 2, "stages": [[12, 36]], "directions_deg": [0, 0]}}, "train.directions_deg"),
        ({"train": {"module": 2, "stages": [[12, 5]]}}, "train.stages"),
        ({"train": {"module": 2, "ratio": 4}, "stock": {"motor": "nema17"}}, "stock.motor"),
        ({"train": {"module": 2, "ratio": 4}, "first_stock": {"thickness": 3, "bore": 5}}, "first_stock.thickness"),
        ({"train": {"module": 1, "ratio": 12}, "stock": {"bore": 6}}, "stock.pin"),
        (
            {
                "train": {"module": 2, "ratio": 12, "arrangement": "reverted"},
                "first_stock": {"bore": 5, "fit": "press"},
                "last_stock": {"bore": 5, "fit": "press"},
            },
            "last_stock.fit",
        ),
        (
            {"train": {"module": 2, "ratio": 12, "arrangement": "reverted"}, "last_stock": {"bore": 6}},
            "last_stock.bore",
        ),
    ],
)
def test_trains_that_cannot_be_made_are_refused_by_key(recipe, field, tmp_path):
    with pytest.raises(gk.RecipeError) as caught:
        gk.make({"kind": "gear-train", **recipe}, tmp_path)
    assert [problem.key.partition("[")[0] for problem in caught.value.problems] == [field]


@pytest.mark.parametrize("wanted", [Fraction(10, 3), Fraction(22, 7), Fraction(5, 4), Fraction(200, 7)])
def test_a_fraction_is_found_from_its_text_from_python_and_from_ten_digits_of_it(wanted):
    text = (CASES / "train-ratio-text.toml").read_text("utf-8")
    recipe = parse(text.replace('"10/3"', f'" {wanted.numerator} / {wanted.denominator}"'))
    trains = [recipe.design] + [gk.gear_train(ratio) for ratio in (wanted, float(f"{float(wanted):.10g}"))]
    assert [abs(ratio_of(train.stages)) for train in trains] == 3 * [wanted]
    assert parse(to_toml(recipe)) == recipe
    # Fewer digits are meant exactly.
    assert gk.gear_train(float(f"{float(wanted):.6g}"), error=1e-5).stages


def test_a_rounded_fraction_with_few_digits_is_no_fraction():
    with pytest.raises(gk.DesignError) as caught:
        gk.gear_train(3.33333, most_stages=2)
    assert caught.value.field == "ratio"


def test_every_ratio_of_a_recipe_may_be_a_fraction():
    table = {
        "kind": "pantograph",
        "linkage": {"arm": 150, "forearm": 150, "ratio": "5/2", "crank": 10, "crank_pivot": [60, 0]},
    }
    assert gk.load(table).linkage.ratio == 2.5
    assert gk.linkage.Pantograph(150, 150, Fraction(5, 2), 10, 60 + 0j).ratio == 2.5


@pytest.mark.parametrize("text", ["10/0", "x", "12", "1/10000000000", "10/3/2", "1e3/2"])
def test_a_text_that_is_no_ratio_in_range_is_refused_by_its_key(text):
    with pytest.raises(gk.RecipeError) as caught:
        parse((CASES / "train-ratio-text.toml").read_text("utf-8").replace("10/3", text))
    assert [problem.key for problem in caught.value.problems] == ["train.ratio"]


def test_a_wrong_number_of_teeth_is_named_by_its_place():
    with pytest.raises(gk.RecipeError) as caught:
        gk.load(CASES / "train-stages-message.toml")
    (problem,) = caught.value.problems
    assert problem.key == "train.stages[1][1]" and problem.id == "out-of-range"
    for word in ("tuple", "row", "list"):
        assert word not in problem.remedy

"""The key `scale` and `gk.scaled`: every length of a mechanism and of a goal's wishes, and nothing else."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.kinds import KINDS, recipe_class
from geomkin.recipe.load import whole_table
from geomkin.recipe.recipe import UNSCALED
from tests.campaign import by_default
from tests.texts import choices_of, parse, schema_of_all, template_of

RECIPES = Path(__file__).parents[2] / "recipes"
SCALED = [name for name in KINDS if recipe_class(name).can_be_scaled]
BAR = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": [40, 25]}
BIG = 1.5
# Lengths to which power a column's unit has them; forces of the same masses are m a.
POWER = {"mm": 1, "mm/s": 1, "mm/s2": 1, "mm/s3": 1, "N": 1, "1/mm": -1}
# Columns that a table has no unit for, as the polygons' own.
SIZES = {"polygons": {"size"}}


def gallery(name):
    return tomllib.loads((RECIPES / f"{name}.toml").read_text())


def test_linkages_and_cams_take_it_and_gears_do_not():
    assert set(KINDS) - set(SCALED) == {
        name
        for name in KINDS
        if "gear" in name
        or name in ("belt-drive", "chain-drive", "rack-and-pinion", "planetary", "fit-test", "machine")
    }
    defined = schema_of_all()["$defs"]
    for name in KINDS:
        held = template_of(name)
        assert ("# scale = 1 " in held) == (name in SCALED)
        assert ("scale" in defined[recipe_class(name).__name__]["properties"]) == (name in SCALED)
        if name in SCALED:
            assert parse(held.replace("# scale = 1 ", "scale = 1 ")) == parse(held)
    with pytest.raises(gk.RecipeError, match="scale"):
        parse("scale = 2\n" + template_of("spur-gear"))


# No search, and the others that do not take long.
ALIKE = (
    "slider-crank-by-slider", "watt-six-bar", "shaper", "scotch-yoke", "sieve", "lift-table", "coupler-atlas",
    "inflection-circle", "shaking-force", "roller-cam", "undercut-cam", "polygons",
)  # fmt: skip


@pytest.mark.parametrize("name", by_default(ALIKE, slice(0, None, 3)))
def test_a_scaled_mechanism_moves_as_a_similar_one(name):
    """Every column of the table, by its unit: lengths and their rates are multiplied, angles and times stay."""
    data = gallery(name)
    one, big = gk.load(data), gk.load(data | {"scale": BIG})
    assert [c.id for c in one.table.columns] == [c.id for c in big.table.columns]
    for before, after in zip(one.table.columns, big.table.columns):
        if before.values.dtype.kind not in "fiu":
            assert list(before.values) == list(after.values)
            continue
        power = 1 if before.id in SIZES.get(data["kind"], ()) else POWER.get(before.unit, 0)
        if "coefficient" in before.id or "advantage" in before.id:
            continue
        values, wanted = np.asarray(after.values, float), np.asarray(before.values, float) * BIG**power
        assert before.unit == after.unit
        size = np.nanmax(np.abs(wanted), initial=0.0)
        assert values == pytest.approx(wanted, rel=1e-7, abs=1e-8 * size + 1e-12, nan_ok=True), before.id


def lengths_of(thing, path=""):
    """Numbers of a recipe, as its text has them, by dotted key."""
    if isinstance(thing, dict):
        for key, value in thing.items():
            yield from lengths_of(value, f"{path}.{key}")
    elif isinstance(thing, list):
        for k, value in enumerate(thing):
            yield from lengths_of(value, f"{path}[{k}]")
    elif isinstance(thing, (int, float)) and not isinstance(thing, bool):
        yield path, thing


# What keys say that are no lengths, by hand: nothing of this is read from the declarations.
PLAIN = (
    "deg", "rpm", "rad", "branch", "choose", "seed", "time_limit", "ratio", "rows", "columns", "chosen", "degree", "decimals",
    "count", "masses.crank", "masses.coupler", "masses.slider", "density", "coefficients", "x_start", "x_end", "points",
    "intervals", "jerk_limit", "gravity", "kg", "bars", "slots", "pins", "discs", "share", "percent",
    "effort", "efficiency", "teeth", "friction", "first", "last", "weight",
)  # fmt: skip


@pytest.mark.parametrize("name", by_default(SCALED, slice(0, None, 2)))
def test_each_number_of_a_recipe_is_multiplied_or_stays(name):
    """By the names of keys: a number whose key says no other unit is a length."""
    options = [key for key, kinds in choices_of(name).items() if list(kinds) == [""] and key not in UNSCALED]
    options = [key for key in options if not key.startswith(("stock", "base", "copies", "follower"))]
    for text in {template_of(name), template_of(name, options)}:
        held = tomllib.loads(text)
        for key in ("stock", "base", "files"):
            held.pop(key, None)
        small, big = (whole_table(gk.load(held | more)) for more in ({}, {"scale": 2}))
        before, after = dict(lengths_of(small)), dict(lengths_of(big))
        assert set(before) == set(after)
        for key, value in before.items():
            end = key.rpartition(".")[2]
            if key.startswith((".stock", ".base", ".files")):
                assert after[key] == value
            elif name in ("body-guidance", "burmester-curves") and ".poses[" in key:
                assert after[key] == (value if key.endswith("[2]") else 2 * value), key
            elif end == "inertia_kg_mm2":
                assert after[key] == pytest.approx(4 * value), key
            elif key.startswith(".wanted.points[") or not any(
                end.endswith(word) or end.startswith(f"{word}[") or word in end.split("_") or key.endswith(word)
                for word in PLAIN
            ):
                if end in ("position", "speed", "acceleration") and name == "polygons":
                    assert after[key] == value
                else:
                    assert after[key] == pytest.approx(2 * value), key
            else:
                assert after[key] == value, key


def test_points_and_lifts_of_files_are_multiplied(tmp_path):
    (tmp_path / "path.csv").write_text("x,y\n0,0\n10,5\n20,0\n15,-8\n")
    wanted = 'kind = "path-generator"\nscale = 3\n[wanted]\nfile = "path.csv"\n'
    path = parse(wanted, folder=tmp_path).wanted
    assert path.places == pytest.approx([0, 30 + 15j, 60, 45 - 24j]) and path.file is None
    # A negative 0 of a file is not one of the recipe that is written.
    (tmp_path / "path.csv").write_text("x,y\n-0.00,0\n10,5\n1e-11,-8\n")
    written = whole_table(parse(wanted.replace("scale = 3", "scale = 1e-2"), folder=tmp_path))
    assert str(written) == str(whole_table(gk.load(written)))
    svg = parse('kind = "path-generator"\nscale = 3\n[wanted]\nsvg = "M 0 0 L 10 0"\ncount = 3\n').wanted
    assert svg.places == pytest.approx([0, 15, 30])
    rows = [(120 + 5 * k, 10 - 10 * np.cos(np.pi * k / 24)) for k in range(25)]
    text = "\n".join(["cam_angle_deg,lift_mm", *(f"{x},{lift:.3f}" for x, lift in rows)])
    (tmp_path / "lift.csv").write_text(text)
    cam = (
        'kind = "disk-cam"\n[cam]\nbase_radius = 40\n[cam.follower]\nkind = "translating-roller"\nroller_radius = 8\n'
        '[[cam.program]]\nkind = "dwell"\nend_deg = 120\n[[cam.program]]\nkind = "table"\nfile = "lift.csv"\ndecimals = 3\n'
        '[[cam.program]]\nkind = "return"\nlaw = "cycloidal"\nend_deg = 360\n'
    )
    one, big = parse(cam, folder=tmp_path), parse("scale = 2\n" + cam, folder=tmp_path)
    angles = np.linspace(0, 2 * np.pi, 721)
    before, after = (recipe.cam.program.motion(angles) for recipe in (one, big))
    for name in ("lift", "velocity", "acceleration"):
        wanted = 2 * getattr(before, name)
        assert getattr(after, name) == pytest.approx(wanted, abs=1e-6 * np.abs(wanted).max())
    table = big.cam.program.segments[1]
    assert table.file is None and table.within == pytest.approx(2 * 0.75e-3)
    assert parse(gk.recipe.to_toml(big)) == big


def test_scale_multiplies_lengths_in_units_and_neither_forces_nor_masses():
    loads = {
        "torques": [{"body": "rocker", "torque_n_mm": 100}],
        "forces": [{"body": "coupler", "point": [10, 5], "force_n": [3, -4]}],
        "masses": {"crank": {"mass_kg": 0.2, "centre": [5, 0], "inertia_kg_mm2": 50}},
        "springs": [{"body": "rocker", "point": [0, 0], "to_body": "ground", "to_point": [0, 50], "stiffness": 6}],
    }
    linkage = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
    scaled = gk.load({"kind": "four-bar", "scale": 2.0, "linkage": linkage, "loads": loads}).loads
    assert scaled.torques[0].torque_n_mm == 200 and scaled.forces[0].force_n == (3, -4)
    assert scaled.forces[0].point == 20 + 10j and scaled.springs[0].stiffness == 3
    mass = scaled.masses["crank"]
    assert (mass.mass_kg, mass.centre, mass.inertia_kg_mm2) == (0.2, 10, 200)


def test_a_part_that_is_too_heavy_is_named_with_the_scale():
    text = (RECIPES / "loaded-crank-rocker.toml").read_text("utf-8")
    recipe = gk.load("scale = 1e6\n" + text)
    with pytest.raises(gk.DesignError) as caught:
        _ = recipe.checks
    assert caught.value.field == "ground" and "ground" in caught.value.problem and "scale" in caught.value.remedy

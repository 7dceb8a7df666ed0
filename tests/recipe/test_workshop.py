"""Workshop files: the parts are those of a recipe with the values written in it; each wrong file is refused."""

import json
import os
import tomllib
from pathlib import Path

import ezdxf
import pytest

import geomkin as gk
from geomkin.build import check_recipe
from geomkin.studio.edit import answer
from tests.campaign import by_default
from tests.texts import template_of

FILE = """
[birch-plywood]
kerf = 0.18
clearance = 0.08
interference = 0.12

["red oak"]
kerf = 0.25
clearance = 0.3
"""
PLYWOOD = "birch-plywood"
BAR = {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}
SPUR = {"kind": "spur-gear", "gear": {"teeth": 24, "module": 2}, "workshop": "laser.toml"}
ROLLER = {"kind": "translating-roller", "roller_radius": 10}
RISE = [
    {"kind": "rise", "law": "cycloidal", "rise": 20, "end_deg": 180},
    {"kind": "return", "law": "cycloidal", "end_deg": 360},
]
# Recipes, and the keys that the file states for them.
KINDS = {
    "four-bar": (
        {"linkage": BAR, "stock": {"material": PLYWOOD, "thickness": 4, "motor": "nema17", "fit": "press"}},
        {"stock": {"clearance": 0.08, "interference": 0.12}, "files": {"kerf": 0.18}},
    ),
    "gear-pair": (
        {
            "first": {"teeth": 24, "module": 2},
            "second": {"teeth": 36, "module": 2},
            "first_stock": {"material": PLYWOOD, "bore": 5},
            "second_stock": {"bore": 6, "fit": "press"},
            "base": {},
        },
        {
            "first_stock": {"clearance": 0.08, "interference": 0.12},
            "second_stock": {"clearance": 0.08, "interference": 0.12},
            "base": {"clearance": 0.08},
            "files": {"kerf": 0.18},
        },
    ),
    "disk-cam": (
        {"cam": {"base_radius": 40, "follower": ROLLER, "program": RISE}, "stock": {"material": PLYWOOD}, "base": {}},
        {
            "stock": {"clearance": 0.08, "interference": 0.12},
            "base": {"clearance": 0.08},
            "files": {"kerf": 0.18},
        },
    ),
    "ring-gear": (
        {"gear": {"teeth": 48, "module": 2}, "stock": {"material": {"name": "red oak", "density": 700}}},
        {"files": {"kerf": 0.25}, "stock": {"clearance": 0.3}},
    ),
}  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The working folder, with the workshop file."""
    monkeypatch.chdir(tmp_path)
    Path("laser.toml").write_text(FILE)
    return tmp_path


def problems_of(table):
    with pytest.raises(gk.RecipeError) as refused:
        gk.load(table)
    return [(problem.key, problem.id) for problem in refused.value.problems]


def joined(table, values):
    return {**table, **{key: {**table.get(key, {}), **inside} for key, inside in values.items()}}


@pytest.mark.parametrize("kind", by_default(KINDS, KINDS.keys() - {"disk-cam", "gear-pair"}))
def test_recipe_and_drawing_are_those_with_the_values_written_in_the_recipe(kind):
    table, values = KINDS[kind]
    measured = gk.load({"kind": kind, "workshop": "laser.toml", **table})
    written = gk.load({"kind": kind, **joined(table, values)})
    assert measured == written and measured != gk.load({"kind": kind, **table})
    for name, recipe in (("a.dxf", measured), ("b.dxf", written)):
        gk.write(recipe, name)
    assert Path("a.dxf").read_bytes() == Path("b.dxf").read_bytes()


def test_holes_are_drawn_with_the_fit_and_the_kerf_of_the_material():
    """Diameters read from the drawing: that of the shaft, with the fit, less the kerf on both sides."""
    for stock, diameter in (({"bore": 5}, 5 + 0.08 - 0.18), ({"bore": 5, "fit": "press"}, 5 - 0.12 - 0.18)):
        gk.write(gk.load({**SPUR, "stock": {"material": PLYWOOD, **stock}}), "gear.dxf")
        (hole,) = ezdxf.readfile("gear.dxf").modelspace().query("CIRCLE")
        assert 2 * hole.dxf.radius == pytest.approx(diameter, abs=1e-5)


def test_keys_of_the_recipe_win():
    own = {"clearance": 0.5, "interference": 0.2}
    recipe = gk.load({**SPUR, "stock": {"material": PLYWOOD, **own}, "files": {"kerf": 0}})
    assert (recipe.stock.clearance, recipe.stock.interference, recipe.files.kerf) == (0.5, 0.2, 0)


def test_each_stock_takes_the_fits_of_its_own_material():
    pair, _ = KINDS["gear-pair"]
    pair = {**pair, "kind": "gear-pair", "workshop": "laser.toml"}
    pair["second_stock"] = {"bore": 6, "material": {"name": "red oak", "density": 700}}
    assert problems_of(pair) == [("files.kerf", "conflict")]
    recipe = gk.load({**pair, "files": {"kerf": 0.2}})
    assert (recipe.first_stock.clearance, recipe.second_stock.clearance, recipe.base.clearance) == (0.08, 0.3, 0.08)
    # A base that is left out does not come from the file.
    assert gk.load({key: value for key, value in pair.items() if key != "base"} | {"files": {"kerf": 0}}).base is None
    # The oak has no interference in the file.
    assert recipe.second_stock.interference == gk.gear.GearStock().interference


def test_file_of_one_material_serves_recipes_that_name_none():
    Path("laser.toml").write_text("[MDF]\nkerf = 0.15\nclearance = 0.1\n")
    plate = gk.load('workshop = "laser.toml"\n' + template_of("slider-crank-atlas"))
    gear = gk.load({**SPUR, "stock": {"bore": 5}})
    assert plate.files.kerf == gear.files.kerf == 0.15 and gear.stock.clearance == 0.1


def test_file_of_another_material_is_refused_and_both_are_named():
    with pytest.raises(gk.RecipeError) as refused:
        gk.load({**SPUR, "stock": {"material": "brass"}})
    (problem,) = refused.value.problems
    assert (problem.key, problem.id) == ("stock.material", "conflict")
    assert all(name in str(refused.value) for name in ("brass", PLYWOOD, "red oak", "laser.toml"))
    assert problems_of(SPUR) == [("stock.material", "missing-key")]
    assert problems_of({**SPUR, "stock": {"material": ["brass"]}}) == [("stock.material", "conflict")]


@pytest.mark.parametrize(
    ("text", "id"),
    [
        ("", "missing-key"),
        ("kerf = 0.2", "wrong-type"),
        ("[birch-plywood]\nkerf = 'wide'", "wrong-type"),
        ("[birch-plywood]\nkerf = true", "wrong-type"),
        ("[birch-plywood]\nkerf = -0.1", "out-of-range"),
        ("[birch-plywood]\nkerf = 21", "out-of-range"),
        ("[birch-plywood]\nclearance = nan", "not-finite"),
        ("[birch-plywood]\nclearence = 0.1", "unknown-key"),
        ("[birch-plywood.kerf]\nkerf = 0.1", "wrong-type"),
        ("[[birch-plywood]]\nkerf = 0.1", "wrong-type"),
        ("[birch-plywood]\nkerf = ?", "invalid-toml"),
        ("[a" + ".a" * 200 + "]", "invalid-toml"),
        ("# " + "x" * 600_000, "too-much-work"),
    ],
)
def test_wrong_file_is_refused_by_its_name(text, id):
    Path("laser.toml").write_text(text)
    table = {**SPUR, "stock": {"material": PLYWOOD}}
    assert problems_of(table) == [("workshop", id)]
    with pytest.raises(gk.RecipeError, match=r"laser\.toml"):
        gk.load(table)


def test_only_files_in_the_folder_of_the_recipe_or_below_are_read(folder):
    Path("own/below").mkdir(parents=True)
    Path("own/below/laser.toml").write_text(FILE)
    os.symlink(folder / "laser.toml", "own/link.toml")
    for name, id in (
        ("below/laser.toml", ""),
        ("../laser.toml", "file-unreadable"),
        (str(folder / "laser.toml"), "file-unreadable"),
        ("link.toml", "file-unreadable"),
        ("none.toml", "file-unreadable"),
        ("below", "file-unreadable"),
        ("", "file-unreadable"),
        ("a\0b", "file-unreadable"),
        (3, "wrong-type"),
        (["laser.toml"], "wrong-type"),
        ({"file": "laser.toml"}, "wrong-type"),
    ):
        lines = [f"workshop = {json.dumps(name)}" if not isinstance(name, dict) else 'workshop = {file = "laser.toml"}']
        lines += ['kind = "spur-gear"', "gear = {teeth = 24, module = 2}", f'stock = {{material = "{PLYWOOD}"}}']
        Path("own/gear.toml").write_text("\n".join(lines))
        if id:
            with pytest.raises(gk.RecipeError) as refused:
                gk.load("own/gear.toml")
            assert [(problem.key, problem.id) for problem in refused.value.problems] == [("workshop", id)]
        else:
            assert gk.load("own/gear.toml").files.kerf == 0.18


def test_workshop_file_is_no_recipe():
    assert problems_of(tomllib.loads(FILE)) == [("kind", "missing-key")]


def test_summary_names_the_file_and_the_values_that_are_assumed():
    def summary(table):
        gk.make(table, "out", only=["bom"])
        return json.loads(Path("out/spur-gear/summary.json").read_text())

    stock = {"material": PLYWOOD, "bore": 5}
    bare = {key: value for key, value in SPUR.items() if key != "workshop"}
    alone = summary({**bare, "stock": stock})
    assert alone["assumed_mm"] == {"stock.clearance": 0, "files.kerf": 0} and "workshop" not in alone
    assert summary({**bare, "stock": {**stock, "clearance": 0}})["assumed_mm"] == {"files.kerf": 0}
    pressed = summary({**bare, "stock": {**stock, "fit": "press"}})["assumed_mm"]
    assert pressed["stock.interference"] == gk.gear.GearStock().interference
    named = summary({**SPUR, "stock": {**stock, "fit": "press"}})
    assert named["workshop"] == "laser.toml" and "assumed_mm" not in named
    # The certificate needs no workshop file, since the summary has its values.
    Path("laser.toml").unlink()
    assert [certificate.passed for certificate in gk.verify("out")] == [True]
    assert any("files.kerf" in fact for fact in check_recipe({**bare, "stock": stock}).facts)
    made = gk.gear.SpurGearRecipe(gear=gk.SpurGear(24, 2))
    assert made.assumed_fits == {}


def test_sweep_and_studio_use_the_file():
    table = {**SPUR, "stock": {"material": PLYWOOD, "bore": 5, "fit": "press"}}
    written = joined({key: value for key, value in table.items() if key != "workshop"}, KINDS["four-bar"][1])
    measured, own = (gk.sweep(t, {"gear.teeth": [20, 24]}, results=["masses.gear.mass_kg"]) for t in (table, written))
    assert [row.results for row in measured.rows] == [row.results for row in own.rows] and not measured.rows[0].refused
    text = 'kind = "spur-gear"\nworkshop = "laser.toml"\n[gear]\nteeth = 24\nmodule = 2\n[stock]\nbore = 5\n'
    text += f'material = "{PLYWOOD}"\n'
    shown = answer(text, {"laser.toml": FILE}, {"lane": "scene"})
    assert shown["problems"] == [] and shown["values"]["stock.clearance"] == 0.08
    assert answer(text, {}, {"lane": "scene"})["problems"][0]["key"] == "workshop"
    own = answer(text, {"laser.toml": FILE}, {"set": {"stock.clearance": 0.4}})
    assert own["values"]["stock.clearance"] == 0.4 and own["values"]["files.kerf"] == 0.18


@pytest.mark.parametrize(
    ("kerf", "free", "pressed", "compensated"), [(0.18, 2.9, 2.7, 0), (0.18, 2.9, 2.7, 0.1), (0, 3.3, 3.1, 0)]
)
def test_lines_of_a_fit_test_filled_in_reproduce_the_holes_that_fitted(kerf, free, pressed, compensated):
    """The same drawn hole is the same hole in coupon and gear, on a laser and on a printer with narrow holes."""
    pin = 3.0
    openings = {"pin": pin, "thickness": 3}
    table = {"kind": "fit-test", "material": PLYWOOD, "openings": openings, "files": {"kerf": compensated}}
    lines = gk.load(table).notes["workshop_file"]
    # The coupon draws its gauge wider and its holes narrower than their names by the kerf that it compensates.
    readings = {
        "width of the gauge": 10 + compensated - kerf,
        "first hole in which the pin turns freely": free + compensated,
        "largest hole that grips the pin": pressed + compensated,
    }
    filled, known = [lines[0]], {}
    for line in lines[1:]:
        head, formula = line.split("#")
        for name, value in readings.items():
            formula = formula.replace(name, repr(value))
        key = head.split()[0]
        known[key] = eval(formula, {}, dict(known))
        filled.append(head.replace("?", repr(known[key])))
    Path("laser.toml").write_text("\n".join(filled))
    assert known["kerf"] == pytest.approx(kerf)
    for stock, size in (({}, free), ({"fit": "press"}, pressed)):
        gk.write(gk.load({**SPUR, "stock": {"bore": pin, "material": PLYWOOD, **stock}}), "gear.dxf")
        (hole,) = ezdxf.readfile("gear.dxf").modelspace().query("CIRCLE")
        assert 2 * hole.dxf.radius == pytest.approx(size, abs=1e-5)

"""Recipes in inches: the same mechanism as in mm, with its files, tables, checks and messages in inches."""

import csv
import io
import json
import pickle
import re
import tomllib
import zipfile
from copy import deepcopy
from dataclasses import replace
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.core.field_visitor import key_parts, numbers_in
from geomkin.core.units import END, IN, MARK, NEXT, START, UNITS, Sentence, bare_mm, marked, mm
from geomkin.model.scene import drawn_at
from geomkin.recipe.keys import with_values
from geomkin.recipe.load import from_table, to_toml
from geomkin.recipe.shown import ShownRecipe
from geomkin.studio.edit import answer
from geomkin.studio.form import recipe_form
from tests.campaign import by_default
from tests.gallery import FIRST_OF_KIND, RECIPES

INCH = 25.4
KINDS = by_default(FIRST_OF_KIND, ["disk-cam"])
BAR = {"ground": 4, "crank": 1.25, "coupler": 3.5, "rocker": 2.75, "coupler_point": [1.5, 1]}
FOUR_BAR = {"kind": "four-bar", "units": "in", "linkage": BAR}


def power(unit):
    """Power of mm in a unit of lengths, angles and times."""
    if re.search(r"\b(N|kg)\b", unit):
        return 0
    above, _, below = unit.partition("/")
    return sum(int(mm[2:] or 1) for mm in above.split() if mm[:2] == "mm") - below.startswith("mm")


def in_inches(table, recipe):
    """The table of a recipe with every length that it states divided by 25.4, by the units of the recipe's numbers."""
    changed = {"units": "in", **deepcopy(table)}
    for number in numbers_in(recipe):
        *parents, last = key_parts(number.key)
        if not power(number.unit) or any("mm" in str(part).split("_") for part in (*parents, last)):
            continue
        place = changed
        try:
            for part in parents:
                place = place[part]
            if isinstance(place[last], int | float):
                place[last] /= INCH ** power(number.unit)
        except (LookupError, TypeError):
            continue
    return changed


def made(table, name, folder):
    """The recipe, its files' contents by ending, and the results of its command."""
    recipe = from_table(table, name, str(RECIPES)).with_name(name)
    result = gk.make(recipe, folder)
    return recipe, {path.name.removeprefix(name): path.read_bytes() for path in result.files}, result


def shapes(content):
    """The numbers of all entities of a DXF file in mm by its own unit, and this unit."""
    document = ezdxf.read(io.StringIO(content.decode()))
    unit = {1: INCH, 4: 1.0}[document.header["$INSUNITS"]]
    rows = []
    for entity in document.modelspace():
        if entity.dxftype() == "CIRCLE":
            rows.append([*(unit * entity.dxf.center), unit * entity.dxf.radius])
        else:
            points = np.array(entity.get_points("xyb"))
            rows.append((points * [unit, unit, 1]).ravel())
    return rows, unit


def corners(content):
    """Vertices of a 3MF package in mm by its own unit, and this unit."""
    with zipfile.ZipFile(io.BytesIO(content)) as package:
        root = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    unit = {"millimeter": 1.0, "inch": INCH}[root.get("unit")]
    points = [[float(v.get(axis)) for axis in "xyz"] for v in root.iter() if v.tag.endswith("}vertex")]
    shifts = [list(map(float, i.get("transform").split()[9:])) for i in root.iter() if i.tag.endswith("}item")]
    return unit * np.array(points), unit * np.array(shifts), unit


def size(content):
    """Width and height of an SVG file in mm by its own unit, the name of this unit, and the rest of the file."""
    match = re.search(rb'width="([\d.]+)(mm|in)" height="([\d.]+)(mm|in)"', content)
    unit = {b"mm": 1.0, b"in": INCH}[match[2]]
    rest = re.sub(rb"<desc>.*?</desc>", b"", content[match.end() :])
    return [unit * float(match[1]), unit * float(match[3])], match[2], rest


@pytest.mark.parametrize("kind", KINDS)
def test_a_recipe_in_inches_is_the_same_mechanism(kind, tmp_path):
    name = FIRST_OF_KIND[kind]
    table = tomllib.loads((RECIPES / f"{name}.toml").read_text("utf-8"))
    has_parts = bool(gk.load(RECIPES / f"{name}.toml").parts)
    table.setdefault("files", {})["write"] = ["dxf", "svg", "stl", "3mf", "csv", "bom"] if has_parts else ["csv"]
    mm, mm_files, mm_result = made(table, name, tmp_path / "mm")
    inch, files, result = made(in_inches(table, mm), name, tmp_path / "in")
    if kind != "machine":
        # Recipes inside a machine have its unit.
        assert replace(inch, units="mm") == mm
    assert tomllib.loads(to_toml(inch))["units"] == "in"
    assert from_table(tomllib.loads(to_toml(inch)), name, str(RECIPES)) == inch
    for ours, theirs in zip(result.checks, mm_result.checks, strict=True):
        assert (ours.id, ours.passed) == (theirs.id, theirs.passed)
        assert ours.unit == (theirs.unit.replace("mm", "in") if power(theirs.unit) else theirs.unit)
        factor = INCH ** power(theirs.unit)
        for value, other in ((ours.value, theirs.value), (ours.limit, theirs.limit)):
            assert factor * value == pytest.approx(other, rel=1e-9, abs=1e-9, nan_ok=True)
    assert_same_numbers(files[".csv"], mm_files[".csv"])
    assert gk.verify(tmp_path / "in")[0].passed
    if not has_parts:
        return
    # A fit test has its sizes engraved in inches, which need other room.
    is_other = kind == "fit-test"
    assert is_other or assert_same_numbers(files["-bom.csv"], mm_files["-bom.csv"]) is None
    (rows, unit), (mm_rows, mm_unit) = shapes(files[".dxf"]), shapes(mm_files[".dxf"])
    assert (unit, mm_unit) == (INCH, 1.0)
    assert all(np.allclose(a, b, rtol=0, atol=1e-7) for a, b in zip(rows, mm_rows, strict=not is_other)) or is_other
    (points, shifts, unit), (mm_points, mm_shifts, _) = corners(files[".3mf"]), corners(mm_files[".3mf"])
    assert unit == INCH
    assert is_other or np.allclose(shifts, mm_shifts, atol=1e-4)
    assert is_other or np.allclose(points, mm_points, rtol=1e-6, atol=1e-5)
    (across, unit, rest), (mm_across, _, mm_rest) = size(files[".svg"]), size(mm_files[".svg"])
    assert unit == b"in"
    if not is_other:
        assert across == pytest.approx(mm_across, rel=1e-8)
        assert rest == mm_rest
        # Programs for printers and millers take an STL, which states no unit, as mm.
        solids = [ending for ending in files if ending.endswith(".stl")]
        assert solids
        assert all(files[ending][84:] == mm_files[ending][84:] for ending in solids)


def assert_same_numbers(content, mm_content):
    """The cells of two CSV files are the same lengths, by the units in their headers."""
    (heads, *rows), (mm_heads, *mm_rows) = (list(csv.reader(io.StringIO(c.decode()))) for c in (content, mm_content))
    assert len(rows) == len(mm_rows)
    for k, (head, mm_head) in enumerate(zip(heads, mm_heads, strict=True)):
        unit = re.search(r"(?<!_[nN])(?<!kg)(?<!_per)_(?:1_per_)?(mm\d?(?:_per_\w+)?)$", mm_head)
        assert head == (re.sub("mm(?=[^m]*$)", "in", mm_head) if unit else mm_head)
        digits = re.match(r"mm(\d?)", unit[1])[1] or 1 if unit else 0
        factor = INCH ** (-1 if "_1_per_mm" in mm_head else int(digits))
        for row, mm_row in zip(rows, mm_rows, strict=True):
            try:
                found, expected = float(row[k]), float(mm_row[k])
            except ValueError:
                continue
            assert factor * found == pytest.approx(expected, rel=2e-9, abs=1e-7)


@pytest.mark.parametrize("digits", [1, 4, 9, 14])
def test_lengths_that_a_user_wrote_are_written_back(digits):
    random = np.random.default_rng(digits)
    for crank in (0.5, 0.1, 0.3, *(float(f"{x:.{digits}g}") for x in random.uniform(0.1, 0.9, 100))):
        recipe = gk.load({**FOUR_BAR, "linkage": {**BAR, "crank": crank}})
        assert tomllib.loads(to_toml(recipe))["linkage"]["crank"] == crank


def test_values_are_in_mm_inside():
    recipe = gk.load({**FOUR_BAR, "files": {"sheet": [12, 24]}, "stock": {"thickness": 0.125, "pin_diameter": "#6-32"}})
    assert (recipe.linkage.crank, recipe.stock.thickness, recipe.stock.pin_diameter) == (31.75, 3.175, 3.5052)
    assert recipe.linkage.coupler_point == 38.1 + 25.4j
    assert recipe.files.sheet == (304.8, 609.6)
    assert ShownRecipe(recipe).table.column("coupler_point_x").unit == "in"


def test_forces_torques_and_named_units_stay():
    spring = {
        "body": "rocker",
        "point": [1, 0],
        "to_body": "ground",
        "to_point": [2, 0],
        "free_length": 1,
        "stiffness": 2,
    }
    loads = {"masses": {"rocker": {"mass_kg": 0.2, "centre": [1, 0], "inertia_kg_mm2": 30}}, "springs": [spring]}
    recipe = gk.load({**FOUR_BAR, "loads": loads})
    body, held = recipe.loads.masses["rocker"], recipe.loads.springs[0]
    assert (body.mass_kg, body.centre, body.inertia_kg_mm2) == (0.2, 25.4, 30)
    assert (held.free_length, held.stiffness, held.point) == (25.4, 2, 25.4)
    units = {column.unit for column in ShownRecipe(recipe).table.columns}
    assert {"N", "N mm"} <= units
    assert not any(power(unit) for unit in units)


@pytest.mark.parametrize(
    ("change", "key", "said"),
    [
        ({"linkage": {**BAR, "ground": 20}}, "linkage.ground", ("20 in", "7.5 in")),
        ({"stock": {"thickness": 100}}, "stock.thickness", ("found 100;", "39.37", "inches")),
        ({"stock": {"thickness": "0.5"}}, "stock.thickness", ("found '0.5'", "write 0.5 ", "39.37", "inches")),
        ({"stock": {"thickness": "1,25in"}}, "stock.thickness", ("found '1,25in'", "write 1.25 ", "39.37")),
        ({"stock": {"bar_width": 0.1}}, "stock.bar_width", ("0.1 in", "0.165354 in")),
        ({"files": {"sheet": [4, 2]}}, "files.sheet", ("found 4 x 2 in", "0.19685 in")),
        ({"files": {"kerf": 0.3}}, "files.kerf", ("0.3 in",)),
        ({"linkage": {**BAR, "origin": [1e12, 0]}}, "linkage.origin[0]", ("found 1e+12;", "3.937e+07", "inches")),
    ],
)
def test_messages_are_in_inches(change, key, said, tmp_path):
    with pytest.raises(gk.RecipeError) as refused:
        gk.make({**FOUR_BAR, **change}, tmp_path)
    (problem,) = refused.value.problems
    assert problem.key == key
    text = f"{problem.problem}; {problem.remedy}"
    assert all(words in text for words in said), text
    assert "mm" not in text


@pytest.mark.parametrize(
    ("text", "in_mm", "in_inches"),
    [
        (f"found {mm(12.7):g} in a part", "found 12.7 mm in a part", "found 0.5 in in a part"),
        (f"{bare_mm(10):up5} to {mm(25.4):down}", "10 to 25.4 mm", "0.39371 to 1 in"),
        (f"found {mm(254, 50.8, between=' x '):g}", "found 254 x 50.8 mm", "found 10 x 2 in"),
        (f"{mm(6.4516, unit='mm2'):g} at {mm(25.4, unit='mm/s'):g}", "6.4516 mm2 at 25.4 mm/s", "0.01 in2 at 1 in/s"),
        (f"{mm(5, unit='N mm'):g}, {mm(3, unit='N/mm'):g}", "5 N mm, 3 N/mm", "5 N mm, 3 N/mm"),
        (f"{mm(0.0871):,.0f} and {mm(2540):,.1f}", "0 mm and 2,540.0 mm", "0 in and 100 in"),
        (drawn_at(1 / 3, "mm/s"), "1 mm is 3 mm/s", "1 in is 3 in/s"),
        (drawn_at(1 / 3, "N"), "1 mm is 3 N", "1 in is 76.2 N"),
        (f"found '12.7 mm', not {mm(25.4):g}", "found '12.7 mm', not 25.4 mm", "found '12.7 mm', not 1 in"),
    ],
)
def test_lengths_in_sentences(text, in_mm, in_inches):
    sentence = Sentence(text)
    for same in (sentence, pickle.loads(pickle.dumps(sentence)), deepcopy(sentence)):
        assert (same, json.loads(json.dumps(same)), IN.text(same)) == (in_mm, in_mm, in_inches)
    assert IN.text(f"a: {marked(sentence)}") == f"a: {in_inches}"


@pytest.mark.parametrize("unit", UNITS.values())
def test_limits_in_sentences_stay_allowed(unit):
    for limit in np.random.default_rng(1).lognormal(2, 3, 200):
        up, down = (float(unit.text(f"{bare_mm(limit):{side}4}")) for side in ("up", "down"))
        assert down * unit.mm <= limit * (1 + 1e-11) and up * unit.mm >= limit * (1 - 1e-11)
        assert up - down <= 2e-3 * up


def test_a_text_that_is_no_length_stays_as_it_is():
    pieces = [
        "bar 20 mm",
        "at least 3",
        " x ",
        "12.5 mm/s",
        "'7 mm'",
        "1 mm is 2 ",
        "M3",
        START,
        NEXT,
        END,
        "9" * 5,
        "\n",
    ]
    choice = np.random.default_rng(2)
    for _ in range(2000):
        text = "".join(choice.choice(pieces, 12))
        if not MARK.search(text):
            assert IN.text(text) == Sentence(text) == text


def test_a_body_keeps_its_name_in_inches():
    bodies = {"ground": {"O": [0, 0], "D": [4, 0]}, "bar 20 mm": {"O": [0, 0], "A": [1, 0]}}
    bodies |= {"link": {"A": [0, 0], "B": [3.5, 0]}, "rocker": {"D": [0, 0], "B": [2.75, 0]}}
    linkage = {"bodies": bodies, "driver": "bar 20 mm"}
    with pytest.raises(gk.RecipeError) as refused:
        from_table({"kind": "linkage", "units": "in", "linkage": linkage | {"driver": "bar 21 mm"}})
    assert "bar 21 mm" in str(refused.value) and "bar 20 mm" in str(refused.value)
    recipe = from_table({"kind": "linkage", "units": "in", "linkage": linkage})
    shown = ShownRecipe(recipe)
    assert any("bar 20 mm" in step for step in shown.steps)
    assert "bar 20 mm" in shown.quantities


WRONG = {
    "linkage.coupler_point": [-1e12, 7.5, {"a": 1}, {"a": 1, "b": 2}, [[1.5, 2.5]], [1, 2, 3], ["a", 2]],
    "linkage.origin": [3, [1], [{"a": 1.5}]],
    "linkage.crank": [[2.5], {"a": 1.25}, [[1, 2], [3, 4]]],
    "stock": [[{"thickness": 2.5}], 3],
    "branches.rocker_pin": [7, [1, 2, 3]],
    "loads.forces[0].point": [2.5],
    "loads.forces": [{"body": 1}, 2.5],
}


@pytest.mark.parametrize(("key", "value"), [(key, value) for key, values in WRONG.items() for value in values])
def test_a_wrong_value_is_shown_as_it_was_written(key, value):
    loads = {"forces": [{"body": "coupler", "force_n": [1, 2], "point": [1, 2]}]}
    recipe = with_values({**FOUR_BAR, "loads": loads}, {key: value})
    with pytest.raises(gk.RecipeError) as refused:
        from_table(recipe)
    found = [problem.problem for problem in refused.value.problems if problem.key.startswith(key)]
    assert found
    shown = [float(number) for text in found for number in re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", text)]
    # A point that has a wrong coordinate is shown by this coordinate.
    assert {number for number in shown if number} <= set(numbers_of(value))


def numbers_of(value):
    """All numbers in a value, whatever their place."""
    if isinstance(value, dict | list):
        return [n for item in (value.values() if isinstance(value, dict) else value) for n in numbers_of(item)]
    return [value] if isinstance(value, int | float) else []


@pytest.mark.parametrize("kind", [[], {"a": 1}, 3, True])
def test_a_kind_that_is_no_text_is_refused_under_its_key(kind):
    cam = {"base_radius": 1, "follower": {"kind": kind, "roller_radius": 0.3}, "program": [{"kind": kind, "rise": 1}]}
    for units in ("mm", "in"):
        with pytest.raises(gk.RecipeError) as refused:
            from_table({"kind": "disk-cam", "units": units, "cam": cam})
        assert {problem.key for problem in refused.value.problems} == {"cam.follower.kind", "cam.program[0].kind"}


def test_workshop_file_has_its_own_unit():
    inches = 'units = "in"\n[acrylic]\nkerf = 0.01\nclearance = 0.004\n'
    for units in ("mm", "in"):
        unit = {"mm": 1, "in": INCH}[units]
        table = {"kind": "four-bar", "units": units, "workshop": "laser.toml"}
        table["linkage"] = {key: np.multiply(value, INCH / unit).tolist() for key, value in BAR.items()}
        recipe = from_table(table, "recipe", {"laser.toml": inches})
        assert (recipe.files.kerf, recipe.stock.clearance) == (0.254, 0.1016)
        with pytest.raises(gk.RecipeError, match="0.7874"):
            from_table(table, "recipe", {"laser.toml": inches.replace("0.01", "1")})


@pytest.mark.campaign
def test_files_of_points_and_lifts_state_inches():
    lifts = "cam_angle_deg,lift_{}\n" + "\n".join(f"{a},{{:.9f}}" for a in range(0, 361, 10))
    values = 0.25 * (1 - np.cos(np.radians(np.arange(0, 361, 10))))
    cam = {"base_radius": 1, "follower": {"kind": "translating-roller", "roller_radius": 0.3}}
    cam["program"] = [{"kind": "table", "file": "lift.csv", "decimals": 5}]
    table = {"kind": "disk-cam", "units": "in", "cam": cam}
    own = from_table(table, "recipe", {"lift.csv": lifts.format("in", *values)})
    mm = from_table(table, "recipe", {"lift.csv": lifts.format("mm", *(INCH * values))})
    lift = [np.asarray(recipe.table["lift"]) for recipe in (own, mm)]
    assert lift[0] == pytest.approx(lift[1], abs=1e-6)
    assert lift[0].max() == pytest.approx(12.7, abs=1e-3)


@pytest.mark.campaign
def test_goal_writes_its_mechanism_in_inches(tmp_path):
    goal = {
        "kind": "crank-rocker-synthesis",
        "units": "in",
        "wanted": {"swing_deg": 60, "time_ratio": 1.1, "crank": 1.25},
    }
    result = gk.make(goal, tmp_path)
    (found,) = (path for path in result.files if path.name.endswith(".found.toml"))
    table = tomllib.loads(found.read_text())
    assert (table["units"], table["linkage"]["crank"]) == ("in", pytest.approx(1.25, abs=1e-4))
    assert gk.load(found).linkage.crank == pytest.approx(31.75, abs=3e-3)


def test_optimum_and_its_formulas_are_in_inches():
    pytest.importorskip("nlopt")
    best = gk.optimise(
        FOUR_BAR,
        vary={"linkage.coupler": (3, 4)},
        minimise="-max(coupler_point_x)",
        subject_to="max(crank_pin_x) <= 1.26",
        starts=1,
    )
    assert 3 <= best.values["linkage.coupler"] <= 4
    assert -best.objective == pytest.approx(ShownRecipe(best.recipe).table["coupler_point_x"].max())
    assert 1 < -best.objective < 4
    assert tomllib.loads(to_toml(best.recipe))["linkage"]["coupler"] == pytest.approx(best.values["linkage.coupler"])


def test_studio_shows_and_drags_inches():
    text = to_toml(gk.load(FOUR_BAR))
    reply = answer(text, {}, {"lane": "scene"})
    assert reply["values"]["linkage.crank"] == 1.25
    assert {"id": "", "label": "crank", "text": "1.25 in"} in reply["quantities"]
    (pin,) = (handle for handle in reply["handles"] if handle["keys"] == ["linkage.crank"])
    # The drawing itself is in mm.
    x, y = (row[0] for row in pin["at"])
    dragged = answer(text, {}, {"drag": {"handle": pin["id"], "to": [1.5 * INCH, y], "frame": 0, "step": 0.1}})
    assert x == pytest.approx(1.25 * INCH)
    assert tomllib.loads(dragged["text"])["linkage"]["crank"] == pytest.approx(1.5, abs=0.01)
    fields = {
        field["key"]: field for group in recipe_form("four-bar", reply["values"])["groups"] for field in group["fields"]
    }
    thickness = fields["stock.thickness"]
    assert (thickness["unit"], thickness["most"]) == ("in", pytest.approx(1000 / INCH))
    assert "mm" not in thickness["help"]


def test_drag_of_a_plot_is_in_inches():
    program = [{"kind": "rise", "end_deg": 120, "rise": 0.5, "law": "cycloidal"}]
    program += [{"kind": "return", "end_deg": 360, "law": "cycloidal"}]
    cam = {"base_radius": 1, "follower": {"kind": "translating-roller", "roller_radius": 0.4}, "program": program}
    text = to_toml(gk.load({"kind": "disk-cam", "units": "in", "cam": cam}))
    (end,) = (h for h in answer(text, {}, {})["handles"] if h["shape"] == "plot" and "cam.program[0].rise" in h["keys"])
    assert end["at"] == [120, 0.5]
    dragged = answer(text, {}, {"drag": {"handle": end["id"], "to": [120, 0.75], "frame": 0, "step": [1, 0.001]}})
    assert tomllib.loads(dragged["text"])["cam"]["program"][0]["rise"] == pytest.approx(0.75, abs=0.002)


def test_recipe_inside_a_machine_has_its_unit():
    table = tomllib.loads((RECIPES / "geared-legs.toml").read_text("utf-8"))
    name, inner = next((n, m["recipe"]) for n, m in table["mechanisms"].items() if isinstance(m["recipe"], dict))
    inner["units"] = "in"
    with pytest.raises(gk.RecipeError) as refused:
        from_table(table, "recipe", str(RECIPES))
    assert refused.value.problems[0].key.startswith(f"mechanisms.{name}.recipe")


@pytest.mark.campaign
def test_rates_of_lengths_in_summaries_are_in_inches():
    tolerances = {"of": "coupler_point_velocity", "linkages": 0}
    entries = {}
    for unit, factor in (("in", 1.0), ("mm", INCH)):
        bar = {
            key: [factor * x for x in value] if isinstance(value, list) else factor * value
            for key, value in BAR.items()
        }
        recipe = gk.load(
            {
                "kind": "four-bar",
                "units": unit,
                "linkage": bar,
                "tolerances": {**tolerances, "tolerance": 0.01 * factor},
            }
        )
        entries[unit] = ShownRecipe(recipe).notes["tolerances"]
    assert entries["in"]["worst_case_in_per_s"] == pytest.approx(entries["mm"]["worst_case_mm_per_s"] / INCH, rel=1e-4)


@pytest.mark.parametrize("of", ["coupler_point", "coupler_point_x", "rocker_angle"])
def test_limit_of_a_deviation_is_in_the_unit_of_its_column(of):
    """The same linkage in mm and in inches, with a limit in the unit of each, deg for an angle."""
    checks = []
    for unit, factor in (("in", 1.0), ("mm", INCH)):
        bar = {
            key: [factor * x for x in value] if isinstance(value, list) else factor * value
            for key, value in BAR.items()
        }
        limit = 0.03 if of == "rocker_angle" else 0.03 * factor
        tolerances = {"of": of, "tolerance": 0.004 * factor, "limit": limit, "linkages": 0}
        recipe = gk.load({"kind": "four-bar", "units": unit, "linkage": bar, "tolerances": tolerances})
        checks.append(next(check for check in ShownRecipe(recipe).checks if check.id == "deviation"))
    inch, mm = checks
    factor = 1.0 if of == "rocker_angle" else INCH
    assert (inch.limit, inch.limit * factor, inch.value * factor) == pytest.approx((0.03, mm.limit, mm.value), rel=1e-3)

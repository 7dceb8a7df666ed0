"""Every kind with every aspect, in every way of placing it, against the same thing computed apart.

A new kind is found in the table of kinds; a new aspect is one row of `ASPECTS`, a new way of placing one function of
`WAYS`. By default each pair of kind and aspect is placed in one of the ways in turn; the others are campaigns.
"""

import dataclasses
import re
import tomllib
from functools import cache
from itertools import combinations, product
from zlib import crc32

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import RecipeError
from geomkin.core.field_visitor import numbers_in
from geomkin.core.units import PURE, SOLUTIONS, Sentence
from geomkin.linkage.kinds.linkages import AbstractLinkageRecipe
from geomkin.model.explanations import check_entry
from geomkin.recipe.kinds import kind_names, recipe_class
from geomkin.recipe.load import from_table
from geomkin.recipe.recipe import AbstractGoal
from geomkin.recipe.shown import ShownRecipe
from geomkin.studio.edit import answer
from tests.campaign import by_default
from tests.recipe.test_inches import INCH, in_inches
from tests.texts import choices_of, template_of

# A value of each aspect by its key; None is that of the kind's template.
ASPECTS = {
    "loads": None,
    "tolerances": None,
    "dwell": None,
    "straight_line": None,
    "both_modes": True,
    "copies": None,
    "coefficients": True,
    "base": None,
    "stroke": None,
    "foot": "B",
    "effective_components": True,
}
# Aspects that need others.
WITH = {"foot": {"copies": [{"phase_deg": 120}, {"phase_deg": 240}]}}
# The entry of summary.json of an aspect is that of its key but for these.
ENTRIES = {"both_modes": "other_mode"}
# Counts of plates, of what is bought and of steps of copies and bases.
COUNTED = {"copies": {"stack"}, "foot": {"stack"}, "base": {"bought", "steps"}}
# Kinds that search for their mechanism take long.
SLOW = {"path-generator", "function-generator", "slider-function-generator"}
# These are scaled by default.
SLOW_PAIRS = {("pantograph", "tolerances"), ("stephenson-six-bar", "tolerances"), ("shaper", "tolerances")}
SLOW_PAIRS |= {("watt-six-bar", "tolerances"), ("watt-six-bar", "effective_components"), ("shaper", "dwell")}
SLOW_PAIRS |= {("oldham-coupling", "loads"), ("elliptic-trammel", "loads"), ("elliptic-trammel", "dwell")}
SLOW_PAIRS |= {("slider-crank-stroke", None), ("body-guidance", None), ("cognates", None), ("groove-cam", None)}
SLOW_PAIRS |= {("machine", None), ("parametric-tooth-gears", None), ("groove-cam", "base"), ("pantograph", "loads")}
PAIR = {"kind": "gear-pair", "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
        "second": {"teeth": 36, "module": 2}}  # fmt: skip
# The machine turns each mechanism at minus a third of this speed, and places it at this angle.
SPEED_RPM, ANGLE_DEG = 540, 37.0


def takes(kind, aspect):
    return aspect in (field.name for field in dataclasses.fields(recipe_class(kind)))


def offers(kind, aspect):
    recipe = recipe_class(kind)
    # Polygons have the components as their subject.
    is_own = aspect == "effective_components" and not hasattr(recipe, "aspect_kinds")
    return takes(kind, aspect) and not is_own and aspect not in recipe.additions.refused


@cache
def text_of(kind, aspect):
    is_table = aspect and ASPECTS[aspect] is None and aspect in choices_of(kind)
    return template_of(kind, [aspect] if is_table else [])


def table_of(kind, aspect):
    table = tomllib.loads(text_of(kind, aspect))
    if aspect and aspect not in table:
        table |= {aspect: {} if ASPECTS[aspect] is None else ASPECTS[aspect], **WITH.get(aspect, {})}
    return table


def read(table):
    try:
        return from_table(table)
    except RecipeError as error:
        if error.problems[0].id == "conflict":
            pytest.skip(f"refused by name: {error.problems[0].key}")
        raise


def values(checks):
    return {check.id: (check.value, check.limit) for check in checks}


def assert_same_checks(ours, theirs, rel=1e-7):
    assert ours.keys() == theirs.keys()
    for id, pair in ours.items():
        assert pair == pytest.approx(theirs[id], rel=rel, abs=1e-7, nan_ok=True), id


def assert_same_places(ours, theirs, factor=1.0, digits=1e-7):
    assert [body.name for body in ours.bodies] == [body.name for body in theirs.bodies]
    size = max([1e-9, *(np.nanmax(np.abs(body.origin)) for body in theirs.bodies)])
    for one, other in zip(ours.bodies, theirs.bodies):
        assert np.allclose(one.origin, factor * np.asarray(other.origin), rtol=0, atol=digits * size, equal_nan=True)
        assert np.allclose(one.direction, other.direction, rtol=0, atol=digits, equal_nan=True)


def power_of(name):
    """Power of the length in an entry by the unit that ends its name; None if the name states nothing."""
    words = re.sub(r"_per_s2?$", "", name.lower()).split("_")
    is_length = re.fullmatch("mm[23]?", words[-1]) and not {"n", "kg", "per"} & {*words[-2:-1]}
    return int(words[-1][2:] or 1) if is_length else 0 if words[-1] == "deg" or name in PURE else None


def entries_of(data, unit="mm", path=(), power=0):
    """(path, value, power of the length) of each number and text of entries; unit: in names of lengths instead of mm."""
    if isinstance(data, dict):
        for name, value in data.items():
            own = power_of(name)
            # Among lengths without their own unit there are also counts.
            is_count = own is None and isinstance(value, int)
            name = re.sub(r"_mm(?=[^m]*$)", f"_{unit}", name) if own else name
            yield from entries_of(value, unit, (*path, name), 0 if is_count else power if own is None else own)
    elif isinstance(data, list | tuple):
        for k, value in enumerate(data):
            yield from entries_of(value, unit, (*path, k), power)
    else:
        yield path, data, power


def assert_same_entries(ours, theirs, factor=1.0, unit="mm"):
    """Numbers in units of lengths are those of the other entries times a power of the factor; the rest is the same."""
    ours, theirs = list(entries_of(ours)), list(entries_of(theirs, unit))
    assert [path for path, _, _ in ours] == [path for path, _, _ in theirs]
    for (path, value, _), (_, other, power) in zip(ours, theirs):
        is_number = isinstance(other, int | float)
        expected = pytest.approx(other * factor**power, rel=1e-6, abs=1e-6, nan_ok=True) if is_number else other
        # A text has its lengths in both units. Sizes of found linkages have the names of their fields, without a unit.
        assert value == expected or "mm" in str(other) or {*SOLUTIONS} & {*path}, path


def results_of(recipe, *without):
    """Entries, quantities and remarks of the aspects of a recipe but of some."""
    aspects = [aspect for aspect in getattr(recipe, "aspects", ()) if aspect.key not in without]
    return (
        {name: value for aspect in aspects for name, value in aspect.entries.items()},
        {label: text for aspect in aspects for label, text in aspect.quantities.items()},
        [remark for aspect in aspects for remark in aspect.remarks],
    )


def alone(table, tmp_path):
    """An aspect adds to the results of the mechanism and changes none of them, but the counts of copies and bases."""
    recipe = read(table)
    key = next((key for key in ASPECTS if key in table and takes(table["kind"], key)), None)
    if key == "stroke":
        pytest.skip("another driver is another mechanism")
    plain = read({name: value for name, value in table.items() if name not in {key, *WITH.get(key, ())}})
    for ours, theirs in zip(recipe.table.columns, plain.table.columns):
        assert ours.id == theirs.id
        np.testing.assert_array_equal(ours.values, theirs.values, err_msg=ours.id)
    assert set(values(plain.checks)) <= set(values(recipe.checks))
    added = recipe.notes.keys() - plain.notes.keys()
    assert added <= {ENTRIES.get(key, key)}
    kept = plain.notes.keys() - COUNTED.get(key, set())
    assert_same_entries({name: recipe.notes[name] for name in kept}, {name: plain.notes[name] for name in kept})
    assert plain.quantities.items() <= recipe.quantities.items() and set(plain.remarks) <= set(recipe.remarks)
    unexplained = [check.id for check in recipe.checks if check_entry(check.id) is None]
    assert not unexplained, "give them entries in geomkin/model/explanations.toml"


def in_machine(table, tmp_path):
    """Bodies lie where those of the recipe are turned to; results are those at that speed and direction."""
    recipe = read(table)
    if not recipe.rotating_bodies:
        pytest.skip("it has no driver on a shaft")
    body = {"recipe": table, "turned_by": "pair.second", "angle_deg": ANGLE_DEG}
    machine = read({"kind": "machine", "mechanisms": {"pair": {"recipe": PAIR}, "own": body},
                    "drive": {"speed_rpm": SPEED_RPM}})  # fmt: skip
    pose = machine.poses["own"]
    (placed,) = (mechanism for mechanism in machine.placed if mechanism.name == "own")
    scene = recipe.scene_at(placed.turn)
    for one, other in zip(placed.scene.bodies, scene.bodies, strict=True):
        assert np.allclose(one.origin, pose.place(other.origin), atol=1e-9)
    if hasattr(recipe, "drive"):
        apart = read({**table, "drive": {**table.get("drive", {}), "speed_rpm": SPEED_RPM / 3}})
        # The machine adds up loads, and knows what stands.
        entries, quantities, remarks = results_of(apart, "loads", "foot")
        assert_same_entries(machine.notes.get("results_of_mechanisms", {}).get("own", {}), entries)
        assert {f"own: {label}": text for label, text in quantities.items()}.items() <= machine.quantities.items()
        assert {Sentence(f"own: {remark}") for remark in remarks} <= {*machine.remarks}
    # Loads of gears have no gravity.
    if not hasattr(getattr(recipe, "loads", None), "gravity_m_per_s2"):
        return
    turned = {**table, "drive": {**table.get("drive", {}), "speed_rpm": SPEED_RPM / 3, "end_deg": 360}}
    x, y = table["loads"].get("gravity_m_per_s2", (0, -9.81))
    gravity = complex(x, y) * np.exp(-1j * np.radians(ANGLE_DEG))
    loads = {**table["loads"], "gravity_m_per_s2": [gravity.real, gravity.imag]}
    if table["kind"] in ("disk-cam", "groove-cam", "conjugate-cams"):
        turned["drive"].pop("end_deg")
    apart = read({**turned, "loads": loads})
    frames = np.linspace(0, 2 * np.pi, len(apart.table.columns[0].values))
    # A steady mechanism that runs backwards has the same torque, unless it has friction.
    driver = next(id for id in ("shaft_torque", "driver_torque", "camshaft_torque") if id in apart.table.ids)
    expected = np.nan_to_num(apart.table[driver])
    torque = np.nan_to_num(machine.recipes["own"].torque_at(frames))
    known = np.isfinite(apart.table[driver])
    assert torque[known] == pytest.approx(expected[known], abs=1e-8 * (1 + np.abs(expected).max()))


def scaled(table, tmp_path):
    """Twice the size: positions and lengths among the entries are doubled."""
    recipe = read(table)
    if not recipe.can_be_scaled or recipe.scene is None:
        pytest.skip("it takes no scale")
    larger = read({"scale": 2, **table})
    # A goal rounds the lengths that it finds to six digits.
    assert_same_places(larger.scene, recipe.scene, 2.0, 1e-7 if not isinstance(recipe, AbstractGoal) else 3e-5)
    # Errors of lengths and forces keep their size.
    assert_same_entries(*(results_of(each, "loads", "tolerances")[0] for each in (larger, recipe)), 2.0)


def inches(table, tmp_path):
    """The same mechanism, whose entries and quantities have their lengths in inches."""
    recipe = read(table)
    inch = read(in_inches(table, recipe))
    assert_same_checks(values(inch.checks), values(recipe.checks))
    if recipe.scene is not None:
        assert_same_places(inch.scene, recipe.scene)
    shown = ShownRecipe(inch)
    # A fit test has its sizes engraved in inches, which need other room.
    if recipe.kind != "fit-test":
        assert_same_entries(shown.notes, recipe.notes, 1 / INCH, "in")
    assert shown.quantities.keys() == recipe.quantities.keys()
    texts = (*shown.quantities.values(), *shown.texts(recipe.remarks))
    assert not [text for text in texts if re.search(r"(?<!N )\bmm", text)]


def sheet(recipe):
    """The key of a number that every kind with plates has, and another value for it."""
    for number in numbers_in(recipe):
        if number.key.endswith("thickness"):
            return number.key, 1.5 * number.value
    return None, None


def with_value(table, key, value):
    *parents, last = key.split(".")
    table = dict(table)
    place = table
    for parent in parents:
        place[parent] = dict(place.get(parent, {}))
        place = place[parent]
    place[last] = value
    return table


def swept(table, tmp_path):
    """A sweep of one value has the checks of the recipe with that value."""
    recipe = read(table)
    key, value = sheet(recipe)
    if key is None:
        pytest.skip("it has no sheet")
    (row,) = gk.sweep(recipe, {key: [value]}).rows
    apart = read(with_value(table, key, value))
    assert not row.refused
    assert_same_checks(values(row.checks), values(apart.checks))


def optimised(table, tmp_path):
    """The best design has the results that its own recipe has."""
    recipe = read(table)
    key, value = sheet(recipe)
    # The id of a check may also be that of a column, which needs another formula.
    ids = set(recipe.table.ids)
    checks = [check.id for check in recipe.checks if np.isfinite(check.value) and check.id not in ids]
    if key is None or not checks:
        pytest.skip("it has no sheet")
    best = gk.optimise(recipe, {key: (0.9 * value, value)}, checks[-1], starts=1, time_limit=600)
    apart = values(read(with_value(table, key, best.values[key])).checks)
    assert apart[checks[-1]][0] == pytest.approx(best.objective, rel=1e-9, abs=1e-9)


def in_studio(table, tmp_path):
    """The studio shows the checks and quantities of the recipe."""
    recipe = read(table)
    reply, scene = (answer(gk.recipe.to_toml(recipe), {}, {"lane": lane}) for lane in ("checks", "scene"))
    assert not reply["problems"] and not scene["problems"]
    shown = {row["label"]: row["text"] for row in scene["quantities"] if not row["id"]}
    assert shown == dict(recipe.quantities)
    assert [check["id"] for check in reply["checks"]] == [check.id for check in recipe.checks]


def words_in(value):
    """Every text and key of a table."""
    if isinstance(value, dict):
        return [word for name, held in value.items() for word in (name, *words_in(held))]
    if isinstance(value, list):
        return [word for held in value for word in words_in(held)]
    return [value] if isinstance(value, str) else []


def numbers_of(text):
    """Numbers of the aspects and checks of a recipe."""
    recipe = read(tomllib.loads(text))
    found = [value for _, value, _ in entries_of(results_of(recipe)[0]) if isinstance(value, float)]
    return [*found, *(number for pair in values(recipe.checks).values() for number in pair)]


def renamed(table, tmp_path):
    """Another name of a body or point changes no number, and each mention of it in the table of an aspect."""
    recipe = read(table)
    key = next((key for key in ASPECTS if key in table and takes(table["kind"], key)), None)
    if key in (None, "stroke") or not isinstance(recipe, AbstractLinkageRecipe):
        pytest.skip("it is no aspect of a linkage")
    # A table that the studio adds has the names that it may have.
    is_added = ASPECTS[key] is None
    text = gk.recipe.to_toml(read({name: table[name] for name in table if name != key}) if is_added else recipe)
    bodies = recipe.linkage.linkage.bodies
    requests = [{"add": key}] if is_added else []
    # The first one makes it a linkage of bodies.
    for request in [*requests, {"build": {"do": "rename", "old": list(bodies)[-1], "new": "new_one"}}]:
        reply = answer(text, {}, request)
        assert not reply["limit"] and not reply["problems"]
        text = reply["text"]
    known = {"new_one", *bodies, *(point for points in bodies.values() for point in points)}
    # The last name that is valid, where one may be left out.
    fields = getattr(getattr(recipe, key), "__dataclass_fields__", {}).values() if is_added else ()
    optional = [field.name for field in fields if field.default == ""]
    for field, name in product(optional, sorted(known)):
        reply = answer(text, {}, {"set": {f"{key}.{field}": name}})
        text = text if reply["problems"] else reply["text"]
    words, before = words_in(tomllib.loads(text)[key]), numbers_of(text)
    named = known & {*words} - {*optional}
    assert not optional or named
    for name in named:
        reply = answer(text, {}, {"build": {"do": "rename", "old": name, "new": "new_two"}})
        assert not reply["limit"] and not reply["problems"]
        assert sorted(words_in(tomllib.loads(reply["text"])[key])) == sorted(
            "new_two" if word == name else word for word in words
        )
        assert numbers_of(reply["text"]) == pytest.approx(before, rel=1e-6, abs=1e-7, nan_ok=True)


def certified(table, tmp_path):
    """The certificate passes for the files that were made."""
    recipe = read({**table, "files": {**table.get("files", {}), "write": ["dxf", "svg", "csv", "bom"]}})
    gk.make(recipe, tmp_path)
    assert all(certificate.passed for certificate in gk.verify(tmp_path))


WAYS = (alone, in_machine, scaled, inches, swept, optimised, in_studio, renamed, certified)
PAIRS = [(kind, aspect) for kind in kind_names() for aspect in (None, *ASPECTS) if not aspect or offers(kind, aspect)]


def cases():
    for kind, aspect in PAIRS:
        start = crc32(f"{kind} {aspect}".encode())
        for k, way in enumerate(WAYS):
            is_chosen = way is scaled if (kind, aspect) in SLOW_PAIRS else k == start % len(WAYS)
            is_default = is_chosen and kind not in SLOW and way is not optimised
            marks = () if is_default else pytest.mark.campaign
            yield pytest.param(kind, aspect, way, marks=marks, id=f"{kind}-{aspect or 'plain'}-{way.__name__}")


@pytest.mark.parametrize(("kind", "aspect", "way"), list(cases()))
def test_kind_with_aspect_in_a_place_is_what_it_is_apart(kind, aspect, way, tmp_path):
    way(table_of(kind, aspect), tmp_path)


def test_every_aspect_has_a_row():
    keys = {aspect.key for kind in kind_names() for aspect in getattr(recipe_class(kind), "aspect_kinds", ())}
    assert keys and not keys - ASPECTS.keys()


@pytest.mark.parametrize("aspect", by_default(ASPECTS, slice(0, None, 3)))
def test_aspect_of_another_kind_is_refused_by_its_name(aspect):
    others = [kind for kind in kind_names() if not takes(kind, aspect) and kind not in SLOW]
    assert others
    for kind in others:
        value = {} if ASPECTS[aspect] is None else ASPECTS[aspect]
        with pytest.raises(RecipeError) as caught:
            from_table({**tomllib.loads(template_of(kind)), aspect: value})
        assert [problem.key for problem in caught.value.problems] == [aspect], kind


BOTH = [
    pytest.param(kind, pair, id=f"{kind}-{'-'.join(pair)}")
    for kind in ("slider-crank", "four-bar", "linkage", "stephenson-six-bar", "scotch-yoke")
    for pair in combinations([aspect for aspect in ASPECTS if takes(kind, aspect)], 2)
]


@pytest.mark.parametrize(("kind", "pair"), by_default(BOTH, slice(0, 36, 3)))
def test_two_aspects_add_their_results_or_are_refused_by_name(kind, pair):
    """Columns, checks and entries of one aspect are among those of both, unless another driver is another mechanism."""
    tables = [aspect for aspect in pair if ASPECTS[aspect] is None and aspect in choices_of(kind)]
    given = {aspect: ASPECTS[aspect] for aspect in pair if ASPECTS[aspect] is not None}
    extra = {key: value for aspect in pair for key, value in WITH.get(aspect, {}).items()}
    table = {**extra, **tomllib.loads(template_of(kind, tables)), **given}
    both = read(table)
    assert both.scene is not None and both.notes and both.checks
    if "stroke" in pair:
        assert both.motion.linkage.driven_slider
        return
    for other in set(pair) - {"copies"}:
        one = read({key: value for key, value in table.items() if key != other})
        assert set(one.table.ids) <= set(both.table.ids) and set(values(one.checks)) <= set(values(both.checks))

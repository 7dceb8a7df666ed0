"""Good recipes spoilt at random: values, names, keys and texts as mistake, malice or chance would have them."""

import json
import random
import re
import tomllib
from copy import deepcopy
from pathlib import Path

from geomkin.recipe.kinds import KINDS
from tests.texts import choices_of, schema_of_all, template_of

GALLERY = Path(__file__).parent.parent.parent / "recipes"
# Texts that would be a path, a formula, an order to a terminal, markup, a device or too much.
TEXTS = [
    "../../evil",
    "/tmp/geomkin-evil/x",
    "..\\evil",
    "C:evil",
    "",
    ".",
    "..",
    "-rf",
    "CON",
    "com1:x",
    "summary.json",
    "=HYPERLINK(1)",
    "@SUM(1)",
    "+1",
    "\x1b[31mred\x1b]0;title\x07",
    "a\nb",
    "a\rb",
    "\u202egnp",
    "\u200b",
    "</script><script>alert(1)</script>",
    "<svg onload=alert(1)>",
    "${HOME}",
    "%s%n",
    "x" * 300,
    "\U0001f600",
    "é" * 100,
    "ground",
    "crank",
    "A",
    "time",
    "nan",
]
# Names that a person may well give a part, and that files or terminals may not like.
PLAUSIBLE = ["Crank", "lever 2", "pin.1", "Ω", "e\u0301", "a/b", "$x", "summary", "rod-3", "r", "1"]
NUMBERS = [
    0, -1, 1, 2, 1e-300, 5e-324, 1e-12, 1e-7, 1e-3, 0.5, 3.7, 89.9999999, 90, 179.999, 180, 359.9999, 360, 1e3, 1e5,
    1e7, 1e9, 1e12, 1e160, 1e308, -1e9, -1e-9, 2**31, 2**63, 10**30, float("nan"), float("inf"), -float("inf"),
]  # fmt: skip
STRANGE = [True, False, [], {}, [1, 2], [1, 2, 3], [[0, 0]] * 3, {"kind": "dwell"}, "3mm", "1,5", [float("nan")] * 2]


def good_recipes():
    """(name, recipe as a dict) of the gallery and of every kind's templates, all that may be left out written out."""
    texts = {f"gallery {file.stem}": file.read_text("utf-8") for file in sorted(GALLERY.glob("*.toml"))}
    for name in KINDS:
        for wish in options(name):
            texts[f"template {' '.join([name, *wish])}"] = written_out(template_of(name, wish))
    return [(name, tomllib.loads(text)) for name, text in texts.items()]


def varied(recipe, rng, changes=3):
    """A copy of which some numbers are up to a tenth larger or smaller."""
    recipe = deepcopy(recipe)
    numbers = [(held, key) for held, key in _places(recipe) if type(held[key]) in (int, float) and key != "frames"]
    for held, key in rng.sample(numbers, min(changes, len(numbers))):
        value = held[key] * rng.uniform(0.9, 1.1)
        held[key] = round(value) if isinstance(held[key], int) else round(value, 3)
    return recipe


def options(name):
    """Every --with of a kind's template, one at a time, and none."""
    offered = choices_of(name)
    return [[], *([f"{key}={which}" if which else key] for key in offered for which in offered[key])]


def written_out(text):
    """A template with the values in use that it shows commented out."""
    return re.sub(r"^# (\w+ +=\s*[^#\s])", r"\1", text, flags=re.MULTILINE)


def declared():
    """Key -> the limits, choices and defaults that the schema declares for it in any table."""
    found = {}

    def walk(held):
        if isinstance(held, list):
            for inner in held:
                walk(inner)
        elif isinstance(held, dict):
            for key, about in held.get("properties", {}).items():
                ends = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "default", "const")
                values = [about[end] for end in ends if end in about] if isinstance(about, dict) else []
                values += about.get("enum", []) if isinstance(about, dict) else []
                found.setdefault(key, []).extend(v for v in values if v is not None and v not in found[key])
            for inner in held.values():
                walk(inner)

    walk(schema_of_all())
    return {key: values for key, values in found.items() if values and key != "kind"}


def spoilt(recipe, rng, known):
    """A TOML text of the recipe after one to four random blows, in half of the cases such as may well be legal.

    known: what `declared` found.
    """
    recipe = json.loads(json.dumps(recipe))
    if rng.random() < 0.5:
        for _ in range(rng.choice([1, 1, 2, 3])):
            rng.choice([_gentle, _gentle, _known])(recipe, rng, known)
        return toml(recipe)
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        rng.choice([_value, _value, _value, _nudge, _nudge, _name, _name, _drop, _copy, _key])(recipe, rng)
    text = toml(recipe)
    return text if rng.random() > 0.03 else _torn(text, rng)


def _gentle(recipe, rng, known):
    """A number somewhat smaller or larger, a whole one by a few."""
    held, key = _pick(recipe, rng, lambda v: isinstance(v, int | float) and not isinstance(v, bool))
    if key != "kind":
        value = held[key]
        held[key] = value + rng.choice([-2, -1, 1, 2]) if isinstance(value, int) else value * rng.uniform(0.5, 1.6)


def _known(recipe, rng, known):
    """A declared limit, choice or default in place of what stands there."""
    places = [(held, key) for held, key in _places(recipe) if key in known]
    held, key = rng.choice(places) if places else (recipe, "kind")
    if key != "kind":
        held[key] = deepcopy(rng.choice(known[key]))


def _places(held):
    """(container, key) of everything in a recipe."""
    inner = held.items() if isinstance(held, dict) else enumerate(held) if isinstance(held, list) else ()
    for key, value in inner:
        yield held, key
        yield from _places(value)


def _pick(recipe, rng, fits=lambda value: True):
    places = [(held, key) for held, key in _places(recipe) if key != "kind" and fits(held[key])]
    recipe.setdefault("kind", "")  # may be all that earlier blows have left, or not even that
    return rng.choice(places) if places else (recipe, "kind")


def _value(recipe, rng):
    held, key = _pick(recipe, rng)
    chosen = rng.choice([rng.choice(TEXTS), rng.choice(NUMBERS), rng.choice(NUMBERS), rng.choice(STRANGE)])
    # What is put in twice may be put into itself.
    held[key] = deepcopy(chosen)


def _nudge(recipe, rng):
    held, key = _pick(recipe, rng, lambda v: isinstance(v, int | float) and not isinstance(v, bool))
    if key != "kind":
        held[key] = held[key] * rng.choice([0.5, 0.999, 1.001, 2, 3, 10, -1, 1e-6, 1e6])


def _name(recipe, rng):
    """Another name for a body, point or whatever is named, everywhere it stands."""
    names = {v for held, key in _places(recipe) if isinstance(v := held[key], str)}
    names |= {key for held, key in _places(recipe) if isinstance(key, str)}
    old, new = rng.choice(sorted(names) or [""]), rng.choice(TEXTS)
    renamed = _renamed(recipe, old, new)
    recipe.clear()
    recipe.update(renamed)


def _renamed(held, old, new):
    if isinstance(held, dict):
        return {new if key == old else key: _renamed(value, old, new) for key, value in held.items()}
    if isinstance(held, list):
        return [_renamed(value, old, new) for value in held]
    return new if held == old else held


def _drop(recipe, rng):
    held, key = _pick(recipe, rng)
    del held[key]


def _copy(recipe, rng):
    """A list with its rows many times over, or a table with many more keys."""
    held, key = _pick(recipe, rng, lambda v: isinstance(v, list | dict))
    value, times = held[key], rng.choice([2, 50, 3000])
    if isinstance(value, list):
        held[key] = (value * times)[:20_000]
    elif isinstance(value, dict):
        held[key] = value | {f"k{i}": i for i in range(min(times, 500))}


def _key(recipe, rng):
    held, key = _pick(recipe, rng, lambda v: True)
    if isinstance(held, dict):
        held[rng.choice(TEXTS)] = held.pop(key)


def _torn(text, rng):
    """Some of its characters lost, doubled or replaced, as a broken disk or editor leaves it."""
    at, length = rng.randrange(len(text)), rng.randrange(1, 40)
    return (
        text[:at]
        + rng.choice(["", text[at : at + length] * 2, "\0", "\ud7ff", "[[", "'''", "9" * 5000])
        + text[at + length :]
    )


def toml(recipe):
    """A recipe as TOML, its tables inline."""
    return "".join(f"{_text(key)} = {_toml(value)}\n" for key, value in recipe.items())


def _toml(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_text(key)} = {_toml(held)}" for key, held in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return _text(value) if isinstance(value, str) else repr(value)


def _text(text):
    return json.dumps(text, ensure_ascii=True).replace("\\ud83d\\ude00", "\U0001f600").replace("\x7f", "\\u007f")


def campaign(count, seed):
    """(name, kind before, TOML text) of so many spoilt recipes; of every four, one has bodies and points renamed."""
    rng, recipes, known = random.Random(seed), good_recipes(), declared()
    named = [(name, recipe) for name, recipe in recipes if recipe["kind"] == "linkage"]
    rng.shuffle(recipes)
    for number in range(count):
        if number % 4:
            # All in turn, whatever their number: none may be left to the renamed ones' places.
            name, recipe = recipes[(number - 1 - number // 4) % len(recipes)]
            yield name, recipe["kind"], spoilt(recipe, rng, known)
        else:
            name, recipe = rng.choice(named)
            recipe = json.loads(json.dumps(recipe))
            for _ in range(rng.choice([1, 1, 2])):
                _rename_part(recipe, rng)
            yield f"renamed {name}", "linkage", toml(recipe)


def _rename_part(recipe, rng):
    """Another name for a body or a point of a linkage, everywhere it stands."""
    bodies = recipe["linkage"]["bodies"]
    names = sorted({*bodies, *(point for points in bodies.values() for point in points)})
    recipe["linkage"] = _renamed(recipe["linkage"], rng.choice(names), rng.choice([*TEXTS, *PLAUSIBLE]))

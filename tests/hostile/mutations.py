"""Good recipes spoilt at random: values, names, keys and texts as mistake, malice or chance would have them."""

import json
import random
import tomllib
from pathlib import Path

from geomkin.recipe.kinds import KINDS
from geomkin.recipe.template import template

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
NUMBERS = [
    0, -1, 1, 2, 1e-300, 5e-324, 1e-12, 1e-7, 1e-3, 0.5, 3.7, 89.9999999, 90, 179.999, 180, 359.9999, 360, 1e3, 1e5,
    1e7, 1e9, 1e12, 1e160, 1e308, -1e9, -1e-9, 2**31, 2**63, 10**30, float("nan"), float("inf"), -float("inf"),
]  # fmt: skip
STRANGE = [True, False, [], {}, [1, 2], [1, 2, 3], [[0, 0]] * 3, {"kind": "dwell"}, "3mm", "1,5", [float("nan")] * 2]


def good_recipes():
    """(name, recipe as a dict) of the gallery and of every kind's template."""
    texts = {f"gallery {file.stem}": file.read_text("utf-8") for file in sorted(GALLERY.glob("*.toml"))}
    texts |= {f"template {kind}": template(kind) for kind in KINDS}
    return [(name, tomllib.loads(text)) for name, text in texts.items()]


def spoilt(recipe, rng):
    """A TOML text of the recipe after one to four random blows."""
    recipe = json.loads(json.dumps(recipe))
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        rng.choice([_value, _value, _value, _nudge, _nudge, _name, _name, _drop, _copy, _key])(recipe, rng)
    text = toml(recipe)
    return text if rng.random() > 0.03 else _torn(text, rng)


def _places(held):
    """(container, key) of everything in a recipe."""
    inner = held.items() if isinstance(held, dict) else enumerate(held) if isinstance(held, list) else ()
    for key, value in inner:
        yield held, key
        yield from _places(value)


def _pick(recipe, rng, fits=lambda value: True):
    places = [(held, key) for held, key in _places(recipe) if key != "kind" and fits(held[key])]
    return rng.choice(places) if places else (recipe, "kind")


def _value(recipe, rng):
    held, key = _pick(recipe, rng)
    held[key] = rng.choice([rng.choice(TEXTS), rng.choice(NUMBERS), rng.choice(NUMBERS), rng.choice(STRANGE)])


def _nudge(recipe, rng):
    held, key = _pick(recipe, rng, lambda v: isinstance(v, int | float) and not isinstance(v, bool))
    if key != "kind":
        held[key] = held[key] * rng.choice([0.5, 0.999, 1.001, 2, 3, 10, -1, 1e-6, 1e6])


def _name(recipe, rng):
    """Another name for a body, point or whatever is named, everywhere it stands."""
    names = {v for held, key in _places(recipe) if isinstance(v := held[key], str)}
    names |= {key for held, key in _places(recipe) if isinstance(key, str)}
    old, new = rng.choice(sorted(names)), rng.choice(TEXTS)
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
    """(name, TOML text) of so many spoilt recipes; of every four, one has bodies and points renamed."""
    rng, recipes = random.Random(seed), good_recipes()
    named = [(name, recipe) for name, recipe in recipes if recipe["kind"] == "linkage"]
    for number in range(count):
        if number % 4:
            name, recipe = recipes[number % len(recipes)]
            yield name, spoilt(recipe, rng)
        else:
            name, recipe = rng.choice(named)
            recipe = json.loads(json.dumps(recipe))
            for _ in range(rng.choice([1, 1, 2])):
                _rename_part(recipe, rng)
            yield f"renamed {name}", toml(recipe)


def _rename_part(recipe, rng):
    """Another name for a body or a point of a linkage, everywhere it stands."""
    bodies = recipe["linkage"]["bodies"]
    names = sorted({*bodies, *(point for points in bodies.values() for point in points)})
    recipe["linkage"] = _renamed(recipe["linkage"], rng.choice(names), rng.choice(TEXTS))

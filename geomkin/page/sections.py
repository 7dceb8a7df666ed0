"""Text and tables of a page, as HTML that reads without a script: checks, parts, stack, recipe."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from html import escape

import numpy as np

from ..core.errors import harmless
from ..export.job import Job
from ..export.still import kept_frames
from ..export.svg_path import bounding_box, thumbnail
from ..export.text import DIGITS, capital, number, text, unit_sign, with_unit
from ..model.check import Check
from ..model.part import Part
from ..model.scene import Scene
from ..plane.curve import extent
from ..plane.measure import area, length

# Distance between a part and the chords that its size is read off, as a share of that size: four digits are shown.
FOUR_DIGITS = 5e-5
# Significant digits of the measured sizes of gears: the last ones show how a tooth was cut.
MEASURED_DIGITS = 6
# Most names in a row of a table: a list of a thousand parts is no help to a reader.
MOST_ROWS = 200


def verdict(checks: tuple[Check, ...]) -> str:
    """One sentence: whether it is good, and if not, what failed first."""
    failed = [check for check in checks if not check.passed]
    if not checks:
        return ""
    if not failed:
        verdict = "Its one check holds." if len(checks) == 1 else f"All {len(checks)} checks hold."
        return f'<p class="verdict holds">{verdict}</p>'
    failed.sort(key=lambda check: bool(check.expected))
    count = f"{len(failed)} of {len(checks)} checks {'fails' if len(failed) == 1 else 'fail'}"
    return f'<p class="verdict fails">{count}: {text(str(failed[0]).replace(" deg", "°"))}.</p>'


def checks(job: Job) -> str:
    """The checks as a table, those that failed first, each with the frame where it is worst where that is known."""
    held = sorted(job.source.checks, key=lambda check: (check.passed, bool(check.expected)))
    if not held:
        return ""
    rows = "".join(_check(check, job.scene) for check in held[:MOST_ROWS])
    heads = "".join(f'<th scope="col">{head}</th>' for head in ("Verdict", "Check", "Value", "Limit", "Meaning"))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
    return section("checks", "Checks", wide("Checks", table))


def _check(check: Check, scene: Scene) -> str:
    word, sign = ("holds", "\N{CHECK MARK}") if check.passed else ("fails", "\N{BALLOT X}")
    frame = worst_frame(check, scene)
    there = ""
    if frame is not None:
        drive = scene.drive
        place = with_unit(float(drive.values[kept_frames(len(scene.time))[frame]]), drive.unit)
        there = f' <button type="button" data-frame="{frame}">show at {text(place)}</button>'
    digits = check.digits(4)
    value, limit = (text(with_unit(one, check.unit, digits)) for one in (check.value, check.limit))
    means = "fine" if check.passed else check.expected or check.advice or "see the limit"
    expected = " as expected" * bool(check.expected and not check.passed)
    return (
        f'<tr class="{word}"><td><span aria-hidden="true">{sign}</span> {word}{expected}</td>'
        f'<th scope="row">{text(capital(check.name))}</th>'
        f"<td>{value}{there}</td><td>{check.side} {limit}</td><td>{text(means)}</td></tr>"
    )


def worst_frame(check: Check, scene: Scene) -> int | None:
    """The page's frame at which the driver is nearest to where a check comes out worst; None if that is unknown."""
    if check.at is None:
        return None
    drive = np.asarray(scene.drive.values, dtype=float)[kept_frames(len(scene.time))]
    return int(np.argmin(np.abs(drive - check.at)))


def choice(scene: Scene) -> str:
    """Where the player plots what the mechanism was chosen from."""
    if scene.choice is None:
        return ""
    lead = f"<p>All that do what is wanted, by the {text(scene.choice.table.columns[0].meaning)}: "
    return section("choice", "What it was chosen from", f"{lead}the spot and the line are the one that is made.</p>")


def parts(job: Job) -> str:
    """What is cut, each with its form in small, sizes, and the files that it comes in."""
    held = job.source.parts
    if not held:
        return ""
    tints = tints_of(job.scene)
    walls = job.source.walls
    heads: tuple[str, ...] = ("Form", "Name", "Count", "Size, mm", "Thickness, mm", "Area, mm&sup2;", "Cut length, mm")
    heads += ("Thinnest wall, mm",) if walls else ()
    heads += ("Mass, g",) if any(part.mass for part in held) else ()
    head = "".join(f'<th scope="col">{one}</th>' for one in heads)
    rows = "".join(_part(part, tints.get(part.name, "t0"), walls) for part in held[:MOST_ROWS])
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
    more = f"<p>And {len(held) - MOST_ROWS} more.</p>" if len(held) > MOST_ROWS else ""
    return section("parts", "What is cut", wide("Parts", table) + more + _sheets(job))


def _sheets(job: Job) -> str:
    """How large the sheets of a recipe's parts are, and how much of them becomes parts."""
    if not job.about:
        return ""
    sheets = [
        f"{number(sheet.width)} \N{MULTIPLICATION SIGN} {number(sheet.height)} mm, {100 * sheet.filled:.0f} % filled"
        for sheet in job.sheets[:MOST_ROWS]
    ]
    return f"<p>{'Sheet' if len(sheets) == 1 else f'{len(job.sheets)} sheets'}: {'; '.join(sheets)}.</p>"


def _part(part: Part, tint: str, walls: Mapping[str, float]) -> str:
    curves = (part.outline, *part.holes)
    low, high = bounding_box(part.outline, FOUR_DIGITS * extent(part.outline))
    small = thumbnail([(curves, f'class="plate {tint}"')], 60, 40, 'class="small" aria-hidden="true"')
    cells = (
        f"{part.count}",
        " \N{MULTIPLICATION SIGN} ".join(number(size) for size in ((high - low).real, (high - low).imag)),
        number(part.thickness),
        number(area(part.outline) - sum(area(hole) for hole in part.holes)),
        number(sum(length(curve) for curve in curves)),
        *(number(walls[name]) if np.isfinite(walls[name]) else "none" for name in [part.name] if name in walls),
        *([] if part.mass is None else [number(1000 * float(part.mass.mass))]),
    )
    numbers = "".join(f"<td>{cell}</td>" for cell in cells)
    return f'<tr><td>{small}</td><th scope="row">{text(part.name)}</th>{numbers}</tr>'


def tints_of(scene: Scene) -> dict[str, str]:
    """The class of colour of each part, as its body has it in the drawing: that of the ground is its own."""
    moving = [body for body in scene.bodies if not body.fixed]
    tints = {part.name: "ground" for body in scene.bodies if body.fixed for part in body.parts}
    return tints | {part.name: f"t{k % 8}" for k, body in enumerate(moving) for part in body.parts}


def stack(scene: Scene) -> str:
    """How the plates lie on each other: a row for each layer, the lowest at the bottom."""
    layers: dict[int, list[Part]] = {}
    for body in scene.bodies:
        for part in body.parts:
            layers.setdefault(body.layer, []).append(part)
    if len(layers) < 2:
        return ""
    tints, rows, high = tints_of(scene), [], 34
    widest = max(map(len, layers.values()))
    for row, layer in enumerate(sorted(layers, reverse=True)):
        y = row * high
        rows.append(f'<text x="0" y="{y + 21}" class="layer">{layer}</text>')
        wide = 560 / widest
        for k, part in enumerate(layers[layer]):
            x = 30 + k * wide
            rows.append(
                f'<rect class="plate {tints[part.name]}" x="{x:.4g}" y="{y + 4}" width="{wide - 6:.4g}" height="26" />'
                f'<text x="{x + wide / 2 - 3:.4g}" y="{y + 21}" text-anchor="middle">'
                f"{text(_short(part.name, wide))}</text>"
            )
    order = "; ".join(f"layer {layer}: {', '.join(part.name for part in layers[layer])}" for layer in sorted(layers))
    drawing = (
        f'<svg class="stack" viewBox="0 0 600 {len(layers) * high}" role="img" '
        f'aria-label="{text(f"From the lowest up, {order}")}">{"".join(rows)}</svg>'
    )
    return section("stack", "How the plates lie on each other", f"{drawing}")


def _short(name: str, wide: float) -> str:
    """So much of a name as a plate of the drawing has room for."""
    room = max(3, int(wide / 7.5) - 1)
    return name.replace("_", " ") if len(name) <= room else f"{name.replace('_', ' ')[: room - 1]}…"


def joined(job: Job) -> str:
    """What is bought to join the parts, and how they are put together."""
    bought, steps = job.source.bought, job.source.steps
    if not bought:
        return ""
    rows = "".join(
        f"<li>{one.count} \N{MULTIPLICATION SIGN} {text(one.name)}: {text(' '.join(one.joints))}</li>" for one in bought
    )
    order = "".join(f"<li>{text(step)}</li>" for step in steps)
    lettered = any(any(part.hole_names) for part in job.source.parts)
    steps_text = f"<p>{'Letters are at the holes. ' * lettered}Bottom up:</p><ul>{order}</ul>" if steps else ""
    return section("joined", "How it goes together" if steps else "What is bought", f"<ul>{rows}</ul>{steps_text}")


def notes(held: Mapping[str, object]) -> str:
    """What is known of the design besides: what is said in a word or some numbers, then what takes more."""
    inside = _list_of({name: said for name, value in held.items() if (said := _said(value))})
    # How the plates lie on each other, and what is bought, have sections of their own.
    held = {name: value for name, value in held.items() if name not in ("stack", "bought", "steps")}
    inside += "".join(_more(name, value, held.get("found", {})) for name, value in held.items())
    return section("notes", "About it", inside) if inside else ""


def _list_of(entries: Mapping[str, str]) -> str:
    rows = "".join(f"<dt>{_head(name)}</dt><dd>{text(said)}</dd>" for name, said in entries.items())
    return f"<dl>{rows}</dl>" if rows else ""


def _more(name: str, value: object, found: object) -> str:
    """What has sizes of its own, or alike things as a table, without the sizes that all share with the one `found`."""
    digits = MEASURED_DIGITS if name == "measures_mm" else DIGITS
    if isinstance(value, Mapping) and all(isinstance(one, Mapping) for one in value.values()):
        things = [{"name": key.replace("_", " "), **_flat(one, digits)} for key, one in value.items()]
    elif isinstance(value, Mapping):
        entries = _list_of(_flat(value, digits))
        return f"<h3>{_head(name)}</h3>{entries}" if entries else ""
    else:
        alike = isinstance(value, list) and all(isinstance(one, Mapping) for one in value)
        things = [_flat(one) for one in value[:MOST_ROWS]] if alike else []  # type: ignore[index]
    names = list(dict.fromkeys(key for thing in things for key in thing))
    if isinstance(found, Mapping) and len(things) > 1:
        names = [n for n in names if n not in found or len({thing.get(n, "") for thing in things}) > 1]
    if not names:
        return ""
    heads = "".join(f'<th scope="col">{_head(key)}</th>' for key in names)
    cells = ("".join(f"<td>{text(thing[key]) if key in thing else ''}</td>" for key in names) for thing in things)
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"
    return f"<h3>{_head(name)}</h3>{wide(_head(name), table)}"


def _flat(thing: Mapping[str, object], digits: int = DIGITS) -> dict[str, str]:
    """Everything of a thing that is said in a word or some numbers, what it holds in turn under both names."""
    said = {key: _said(value, digits) for key, value in thing.items()}
    inner = {key: _flat(value, digits) for key, value in thing.items() if isinstance(value, Mapping)}
    said |= {f"{key}, {name}": one for key, flat in inner.items() for name, one in flat.items()}
    return {key: one for key, one in said.items() if one}


def _head(name: str) -> str:
    return text(capital(_named(name)))


def _named(name: str) -> str:
    """A name of the summary, whose last word may be a unit."""
    for unit in ("deg", "mm", "mm2", "N", "kg"):
        if name.endswith(f"_{unit}"):
            return f"{name.removesuffix(f'_{unit}')}, {unit_sign(unit)}"
    return name


def _said(value: object, digits: int = DIGITS) -> str:
    """A value in words; "" for one of many parts."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return number(float(value), digits)
    if isinstance(value, list) and len(value) <= 6 and all(isinstance(one, int | float) for one in value):
        return ", ".join(number(float(one)) for one in value)
    if (
        isinstance(value, list)
        and 0 < len(value) <= 4
        and all(isinstance(one, list) and len(one) == 2 for one in value)
    ):
        spans = [[_said(end) for end in one] for one in value]
        return "; ".join(" to ".join(span) for span in spans) if all(map(all, spans)) else ""
    return ""


def recipe(job: Job) -> str:
    """The text that all of it is made from, and how to make it again."""
    lines = [harmless(line) for line in job.recipe().splitlines()]
    if not lines:
        return ""
    file = f"{job.name}.toml"
    again = f"geomkin run {file if file.replace('-', '').replace('.', '').isalnum() else _quoted(file)}"
    body = (
        f"<p>Saved as <code>{text(file)}</code>, it makes all this again:</p><pre><code>{text(again)}</code></pre>"
        f'<p><button type="button" id="save-recipe">Save the recipe</button></p>'
        f'<pre tabindex="0" aria-label="The recipe"><code id="recipe-text">{_lines(lines)}</code></pre>'
    )
    return section("recipe", "Recipe", body)


def _quoted(name: str) -> str:
    """A file's name as a shell takes it for one word."""
    inside = name.replace("'", "'\\''")
    return f"'{inside}'"


def _lines(lines: Iterable[str]) -> str:
    return "\n".join(escape(line, quote=False) for line in lines)


def section(name: str, title: str, inside: str) -> str:
    """HTML under a heading of its own. name: its id."""
    return f'<section id="{name}"><h2>{title}</h2>{inside}</section>'


def wide(name: str, table: str) -> str:
    """A table that scrolls by itself where the screen is narrow, by keys too."""
    return f'<div class="wide" tabindex="0" role="region" aria-label="{name}">{table}</div>'


def all_of(job: Job) -> Iterator[str]:
    """Every section below the drawing, in the order in which they are asked for."""
    scene = job.scene
    yield choice(scene)
    yield checks(job)
    yield parts(job)
    yield stack(scene)
    yield joined(job)
    yield notes(job.source.notes)
    yield recipe(job)

"""Sections of a page as HTML that needs no script: checks, parts, layers, assembly, further results, recipe."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from html import escape
from urllib.parse import quote

import numpy as np

from ..core.errors import harmless
from ..export.job import Job
from ..export.plots import hodograph_file
from ..export.still import kept_frames
from ..export.svg_path import bounding_box, thumbnail
from ..export.text import DIGITS, capital, number, text, unit_sign, with_unit
from ..model.check import Check
from ..model.part import Part
from ..model.scene import Scene
from ..plane.curve import extent
from ..plane.measure import area, length
from .layers import layers_section

# Tolerance of the chords from which the size of a part is computed, as a share of that size; four digits are shown.
FOUR_DIGITS = 5e-5
# Significant digits of the measured sizes of gears, enough to show how deep a tooth was cut.
MEASURED_DIGITS = 6
# Largest number of rows of a table.
MOST_ROWS = 200
# Characters of a picture that need no escaping in an attribute in single quotes.
PLAIN = ' !"$()*+,-./:;<=>?@[]^_`{|}~'


def verdict(checks: tuple[Check, ...]) -> str:
    """One sentence: whether all checks pass, otherwise the first one that fails."""
    failed = [check for check in checks if not check.passed]
    if not checks:
        return ""
    if not failed:
        verdict = "The only check passed." if len(checks) == 1 else f"All {len(checks)} checks passed."
        return f'<p class="verdict holds">{verdict}</p>'
    failed.sort(key=lambda check: bool(check.expected))
    count = f"{len(failed)} of {len(checks)} checks {'fails' if len(failed) == 1 else 'fail'}"
    return f'<p class="verdict fails">{count}: {text(str(failed[0]).replace(" deg", "°"))}.</p>'


def checks(job: Job) -> str:
    """The checks as a table, failed ones first, each with its worst frame if that is known."""
    ordered = sorted(job.source.checks, key=lambda check: (check.passed, bool(check.expected)))
    if not ordered:
        return ""
    rows = "".join(_check(check, job.scene) for check in ordered[:MOST_ROWS])
    heads = "".join(f'<th scope="col">{head}</th>' for head in ("Verdict", "Check", "Value", "Limit", "Advice"))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
    return html_section("checks", "Checks", wide("Checks", table))


def _check(check: Check, scene: Scene) -> str:
    style, sign = ("holds", "\N{CHECK MARK}") if check.passed else ("fails", "\N{BALLOT X}")
    word = "passed" if check.passed else "failed"
    frame = worst_frame(check, scene)
    button = ""
    if frame is not None:
        drive = scene.drive
        position = with_unit(float(drive.values[kept_frames(len(scene.time))[frame]]), drive.unit)
        button = f' <button type="button" data-frame="{frame}">show at {text(position)}</button>'
    digits = check.digits(4)
    value, limit = (text(with_unit(size, check.unit, digits)) for size in (check.value, check.limit))
    advice = "" if check.passed else check.expected or check.advice or "see the limit"
    expected = " as expected" * bool(check.expected and not check.passed)
    return (
        f'<tr class="{style}"><td><span aria-hidden="true">{sign}</span> {word}{expected}</td>'
        f'<th scope="row">{text(capital(check.name))}</th>'
        f"<td>{value}{button}</td><td>{check.side} {limit}</td><td>{text(advice)}</td></tr>"
    )


def worst_frame(check: Check, scene: Scene) -> int | None:
    """The frame of the page nearest to the driver position at which a check is worst; None if unknown."""
    if check.at is None:
        return None
    drive = np.asarray(scene.drive.values, dtype=float)[kept_frames(len(scene.time))]
    return int(np.argmin(np.abs(drive - check.at)))


def choice(scene: Scene) -> str:
    """The section in which the player plots the solutions from which the mechanism was chosen."""
    if scene.choice is None:
        return ""
    first = text(scene.choice.table.columns[0].meaning)
    lead = f"<p>All solutions, by the {first}. A dot and a line mark the one that is made.</p>"
    return html_section("choice", "Solutions", lead)


def hodograph(scene: Scene) -> str:
    """The first polar diagram as a picture; the files of plots have all."""
    if not scene.hodographs:
        return ""
    first = scene.hodographs[0]
    title, picture = text(capital(first.title)), picture_address(hodograph_file(scene.table, first))
    return html_section("hodograph", title, f"<img src='{picture}' alt=\"{title}\">")


def picture_address(svg: bytes) -> str:
    """A picture as a data address, for an attribute in single quotes."""
    return f"data:image/svg+xml,{quote(svg, safe=PLAIN)}"


def parts(job: Job) -> str:
    """The parts as a table, each with its outline and sizes."""
    all_parts = job.source.parts
    if not all_parts:
        return ""
    tints = tints_of(job.scene)
    walls = job.source.walls
    heads: tuple[str, ...] = (
        "Outline",
        "Name",
        "Count",
        "Size, mm",
        "Thickness, mm",
        "Area, mm&sup2;",
        "Cut length, mm",
    )
    heads += ("Thinnest wall, mm",) if walls else ()
    heads += ("Mass, g",) if any(part.mass for part in all_parts) else ()
    head = "".join(f'<th scope="col">{name}</th>' for name in heads)
    rows = "".join(_part(part, tints.get(part.name, "t0"), walls) for part in all_parts[:MOST_ROWS])
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
    more = f"<p>And {len(all_parts) - MOST_ROWS} more.</p>" if len(all_parts) > MOST_ROWS else ""
    return html_section("parts", "Parts", wide("Parts", table) + more + _sheets(job))


def _sheets(job: Job) -> str:
    """Size of the sheets, and the share of each that its parts fill."""
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
    """The CSS class of each part's colour, which is that of its body in the drawing."""
    moving = [body for body in scene.bodies if not body.fixed]
    tints = {part.name: "ground" for body in scene.bodies if body.fixed for part in body.parts}
    return tints | {part.name: f"t{k % 8}" for k, body in enumerate(moving) for part in body.parts}


def assembly_section(job: Job) -> str:
    """Items to buy and assembly steps."""
    bought, steps = job.source.bought, job.source.steps
    if not bought:
        return ""
    rows = "".join(
        f"<li>{item.count} \N{MULTIPLICATION SIGN} {text(item.name)}: {text(' '.join(item.joints))}</li>"
        for item in bought
    )
    order = "".join(f"<li>{text(step)}</li>" for step in steps)
    lettered = any(any(part.hole_names) for part in job.source.parts)
    letters = "Letters mark the holes. " if lettered else ""
    steps_text = f"<p>{letters}From the bottom up:</p><ul>{order}</ul>" if steps else ""
    return html_section("assembly", "Assembly" if steps else "Items to buy", f"<ul>{rows}</ul>{steps_text}")


def notes(entries: Mapping[str, object]) -> str:
    """Further results: a list of short values, then tables of longer ones."""
    inside = _list_of({name: words for name, value in entries.items() if (words := _in_words(value))})
    # The sections of layers and of assembly show these.
    others = {name: value for name, value in entries.items() if name not in ("stack", "bought", "steps")}
    inside += "".join(_subsection(name, value, others.get("found", {})) for name, value in others.items())
    return html_section("notes", "Further results", inside) if inside else ""


def _list_of(entries: Mapping[str, str]) -> str:
    rows = "".join(f"<dt>{_head(name)}</dt><dd>{text(words)}</dd>" for name, words in entries.items())
    return f"<dl>{rows}</dl>" if rows else ""


def _subsection(name: str, value: object, found: object) -> str:
    """Texts as lines, a mapping as a list, several as a table without columns that all equal the solution `found`."""
    if isinstance(value, list) and value and all(isinstance(line, str) for line in value):
        return f'<h3>{_head(name)}</h3><pre tabindex="0">{_lines(map(harmless, value))}</pre>'
    digits = MEASURED_DIGITS if name == "measures_mm" else DIGITS
    if isinstance(value, Mapping) and all(isinstance(item, Mapping) for item in value.values()):
        rows = [{"name": key.replace("_", " "), **_flat(item, digits)} for key, item in value.items()]
    elif isinstance(value, Mapping):
        entries = _list_of(_flat(value, digits))
        return f"<h3>{_head(name)}</h3>{entries}" if entries else ""
    else:
        is_table = isinstance(value, list) and all(isinstance(item, Mapping) for item in value)
        rows = [_flat(item) for item in value[:MOST_ROWS]] if is_table else []  # type: ignore[index]
    names = list(dict.fromkeys(key for row in rows for key in row))
    if isinstance(found, Mapping) and len(rows) > 1:
        names = [n for n in names if n not in found or len({row.get(n, "") for row in rows}) > 1]
    if not names:
        return ""
    heads = "".join(f'<th scope="col">{_head(key)}</th>' for key in names)
    cells = ("".join(f"<td>{text(row[key]) if key in row else ''}</td>" for key in names) for row in rows)
    body = "".join(f"<tr>{line}</tr>" for line in cells)
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"
    return f"<h3>{_head(name)}</h3>{wide(_head(name), table)}"


def _flat(entries: Mapping[str, object], digits: int = DIGITS) -> dict[str, str]:
    """Short values in words, by name; the name of a value in an inner mapping begins with that of the mapping."""
    words = {key: _in_words(value, digits) for key, value in entries.items()}
    inner = {key: _flat(value, digits) for key, value in entries.items() if isinstance(value, Mapping)}
    words |= {f"{key}, {name}": value for key, flat in inner.items() for name, value in flat.items()}
    return {key: value for key, value in words.items() if value}


def _head(name: str) -> str:
    return text(capital(_named(name)))


def _named(name: str) -> str:
    """A name of the summary, whose last words may be a unit."""
    for unit in ("kg_mm2", "N_mm", "deg", "mm", "mm2", "mm3", "N", "kg", "rpm"):
        if name.endswith(f"_{unit}"):
            return f"{name.removesuffix(f'_{unit}')}, {unit_sign(unit.replace('_', ' '))}"
    return name


def _in_words(value: object, digits: int = DIGITS) -> str:
    """A value in words; "" if it is too long."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return number(float(value), digits)
    if not isinstance(value, list):
        return ""
    if len(value) <= 6 and all(isinstance(item, int | float) for item in value):
        return ", ".join(number(float(item)) for item in value)
    if 0 < len(value) <= 4 and all(isinstance(item, list) and len(item) == 2 for item in value):
        ranges = [[_in_words(end) for end in item] for item in value]
        return "; ".join(" to ".join(ends) for ends in ranges) if all(map(all, ranges)) else ""
    return ""


def recipe(job: Job) -> str:
    """The text of the recipe, and the command that makes the files again."""
    lines = [harmless(line) for line in job.recipe().splitlines()]
    if not lines:
        return ""
    file = f"{job.name}.toml"
    again = f"geomkin run {file if file.replace('-', '').replace('.', '').isalnum() else _quoted(file)}"
    body = (
        f"<p>Save it as <code>{text(file)}</code>; this command makes the files again:</p>"
        f"<pre><code>{text(again)}</code></pre>"
        f'<p><button type="button" id="save-recipe">Save the recipe</button></p>'
        f'<pre tabindex="0" aria-label="The recipe"><code id="recipe-text">{_lines(lines)}</code></pre>'
    )
    return html_section("recipe", "Recipe", body)


def _quoted(name: str) -> str:
    """A file name quoted for a shell."""
    inside = name.replace("'", "'\\''")
    return f"'{inside}'"


def _lines(lines: Iterable[str]) -> str:
    return "\n".join(escape(line, quote=False) for line in lines)


def html_section(name: str, title: str, inside: str) -> str:
    """A section of HTML with a heading. name: its id."""
    return f'<section id="{name}"><h2>{title}</h2>{inside}</section>'


def wide(name: str, table: str) -> str:
    """A table that scrolls on a narrow screen, by pointer or keys."""
    return f'<div class="wide" tabindex="0" role="region" aria-label="{name}">{table}</div>'


def all_of(job: Job) -> Iterator[str]:
    """All sections below the drawing, in order."""
    scene = job.scene
    yield choice(scene)
    yield checks(job)
    yield hodograph(scene)
    yield parts(job)
    yield layers_section(job, tints_of(scene))
    yield assembly_section(job)
    yield notes(job.source.notes)
    yield recipe(job)

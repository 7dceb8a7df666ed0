"""Sections of a page as HTML that needs no script: checks, parts, layers, assembly, further results, recipe."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from html import escape
from urllib.parse import quote

import numpy as np

from ..core.errors import harmless
from ..core.units import LengthUnit
from ..export.job import Job
from ..export.picture import MARGIN, TURN_DIGITS
from ..export.scene_svg import LayerPicture, layer_pictures
from ..export.still import kept_frames
from ..export.svg_path import FINE, bounding_box, decimal, path, thumbnail
from ..export.tables import hodograph_file
from ..export.text import DIGITS, capital, number, text, unit_sign, with_unit
from ..model.check import Check
from ..model.explanations import check_entry, explained_check
from ..model.part import Part
from ..model.scene import Scene
from ..plane.curve import extent
from ..plane.measure import area, length
from ..plane.vec import rounded

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
    explained = set[str]()
    rows = "".join(_check(check, job.scene, explained) for check in ordered[:MOST_ROWS])
    heads = "".join(f'<th scope="col">{head}</th>' for head in ("Verdict", "Check", "Value", "Limit", "Advice"))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
    return html_section("checks", "Checks", wide("Checks", table))


def _check(check: Check, scene: Scene, explained: set[str]) -> str:
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
        f'<th scope="row">{_explained(check, explained)}</th>'
        f"<td>{value}{button}</td><td>{check.side} {limit}</td><td>{text(advice)}</td></tr>"
    )


def _explained(check: Check, explained: set[str]) -> str:
    """The name of a check, which opens its explanation, or leads to that of a row above. explained: their entries."""
    name, entry = text(capital(check.name)), check_entry(check.id)
    if entry is None:
        return name
    if entry in explained:
        return f'<a href="#explained-{entry}">{name}</a>'
    explained.add(entry)
    known = explained_check(check.id)
    items = "".join(f"<dt>{capital(word)}</dt><dd>{text(about)}</dd>" for word, about in known.items())
    # A browser opens the details round the target of a link.
    return f'<details><summary>{name}</summary><dl id="explained-{entry}">{items}</dl></details>'


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
        f"Size, {job.unit.name}",
        f"Thickness, {job.unit.name}",
        f"Area, {job.unit.name}&sup2;",
        f"Cut length, {job.unit.name}",
    )
    heads += (f"Thinnest wall, {job.unit.name}",) if walls else ()
    heads += ("Mass, g",) if any(part.mass for part in all_parts) else ()
    head = "".join(f'<th scope="col">{name}</th>' for name in heads)
    rows = "".join(_part(part, tints.get(part.name, "t0"), walls, job.unit) for part in all_parts[:MOST_ROWS])
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
    more = f"<p>And {len(all_parts) - MOST_ROWS} more.</p>" if len(all_parts) > MOST_ROWS else ""
    return html_section("parts", "Parts", wide("Parts", table) + more + _sheets(job))


def _sheets(job: Job) -> str:
    """Size of the sheets, and the share of each that its parts fill."""
    if not job.about:
        return ""
    unit = job.unit
    sheets = [
        f"{number(unit.of(sheet.width))} \N{MULTIPLICATION SIGN} {number(unit.of(sheet.height))} {unit.name}, "
        f"{100 * sheet.filled:.0f} % filled"
        for sheet in job.sheets[:MOST_ROWS]
    ]
    return f"<p>{'Sheet' if len(sheets) == 1 else f'{len(job.sheets)} sheets'}: {'; '.join(sheets)}.</p>"


def _part(part: Part, tint: str, walls: Mapping[str, float], unit: LengthUnit) -> str:
    curves = (part.outline, *part.holes)
    low, high = bounding_box(part.outline, FOUR_DIGITS * extent(part.outline))
    size = unit.of(high - low)
    small = thumbnail([(curves, f'class="plate {tint}"')], 60, 40, 'class="small" aria-hidden="true"')
    cells = (
        f"{part.count}",
        " \N{MULTIPLICATION SIGN} ".join(number(size) for size in (size.real, size.imag)),
        number(unit.of(part.thickness)),
        number(unit.of(area(part.outline) - sum(area(hole) for hole in part.holes), "mm2")),
        number(unit.of(sum(length(curve) for curve in curves))),
        *(
            number(unit.of(walls[name])) if np.isfinite(walls[name]) else "none"
            for name in [part.name]
            if name in walls
        ),
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
    digits = MEASURED_DIGITS if name.startswith("measures_") else DIGITS
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
    return text(capital(with_unit_of_name(name)))


def with_unit_of_name(name: str) -> str:
    """A name of the summary, whose last words may be a unit, with the unit after a comma."""
    for unit in ("kg_mm2", "N_mm", "deg", "mm", "mm2", "mm3", "in", "in2", "in3", "N", "kg", "rpm"):
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
        '<p><button type="button" id="save-recipe">Save the recipe</button> '
        '<button type="button" id="open-recipe" title="In the studio that runs on this machine: geomkin studio">'
        "Open in the studio</button></p>"
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


# Width and height, in pixels, into which the largest picture is fitted, without its margin.
ROOM = 280.0


def layers_section(job: Job, tints: dict[str, str]) -> str:
    """A picture of each layer, its parts over those below, which are faint; "" for one layer, or if never assembled.

    tints: the CSS class of each part's colour.
    """
    pictures = layer_pictures(job) if job.scene.assembled.any() else []
    if len(pictures) < 2:
        return ""
    outlines = dict[str, str]()
    pixel = max(max((high - low).real, (high - low).imag) for low, high in (p.still.bounds for p in pictures)) / ROOM
    figures = "".join(_figure(picture, pixel, tints, outlines) for picture in pictures)
    effect = 'vector-effect="non-scaling-stroke"'
    defined = "".join(f'<path id="{name}" {effect} d="{d}"/>' for d, name in outlines.items())
    defs = f'<svg width="0" height="0" aria-hidden="true"><defs>{defined}</defs></svg>'
    lead = "<p>From the lowest up. The parts to add are coloured, and letters mark their holes.</p>"
    return f'<section id="layers"><h2>Layers</h2>{lead}{defs}<div class="layers">{figures}</div></section>'


def _figure(picture: LayerPicture, pixel: float, tints: dict[str, str], outlines: dict[str, str]) -> str:
    """A picture at `pixel` mm a pixel. outlines: names of the outlines written so far, to which new ones are added."""
    still, k, digits = picture.still, picture.still.frame, -int(np.floor(np.log10(FINE * pixel)))
    low, high = still.bounds
    drawn, texts = [], []
    for body in (body for body in still.bodies if body.layer <= picture.layer):
        place = rounded(complex(body.origin[k]), digits).item()
        angle = rounded(float(np.degrees(np.angle(body.direction[k]))), TURN_DIGITS).item()
        moved = f"translate({decimal(place.real, digits)} {decimal(place.imag, digits)})" if place else ""
        moved += f"rotate({decimal(angle, TURN_DIGITS)})" if angle else ""
        where = f' transform="{moved}"' if moved else ""
        for part in body.parts:
            outline = path((part.outline, *part.holes), FINE * pixel, digits)
            name = outlines.setdefault(outline, f"outline{len(outlines)}")
            look = f"plate {tints.get(part.name, 't0')}{' below' * (body.layer < picture.layer)}"
            drawn.append(f'<use href="#{name}" class="{look}"{where}/>')
    for words, place in (label for label in picture.texts if label[0]):
        x, y = (place.real - low.real) / pixel, (high.imag - place.imag) / pixel
        texts.append(f'<text x="{x:.0f}" y="{y + 4:.0f}">{text(words)}</text>')
    width, height = ((high - low).real / pixel, (high - low).imag / pixel)
    box = f"-{MARGIN:.0f} -{MARGIN:.0f} {width + 2 * MARGIN:.0f} {height + 2 * MARGIN:.0f}"
    corner = f"{-low.real / pixel:.1f} {high.imag / pixel:.1f}"
    scale = f"{1 / pixel:.4g}"
    return (
        f'<figure><svg viewBox="{box}" width="{width + 2 * MARGIN:.0f}" aria-hidden="true">'
        f'<g transform="translate({corner})scale({scale} -{scale})">{"".join(drawn)}</g>{"".join(texts)}</svg>'
        f"<figcaption>{text(picture.heading.replace('_', ' '))}</figcaption></figure>"
    )

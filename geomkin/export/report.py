"""The report of a recipe as Markdown and as PDF, with its drawing, and the drawing alone as PDF. Typst sets PDF."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import numpy as np

from ..core.errors import DesignError, harmless
from ..core.records import record
from .job import Job
from .scene_svg import assembly_picture
from .svg import sheet
from .tables import bill, write_plots
from .text import capital, number

# Name of the package that sets PDF, an extra of this one.
TYPST = "typst"
# Significant digits of results.
DIGITS = 6


@record(eq=False)
class Heading:
    """A heading of the report."""

    words: str


@record(eq=False)
class Paragraph:
    """A line or a text of the report; one that is kept is on the page of what follows."""

    words: str
    is_kept: bool = False


@record(eq=False)
class Bullets:
    """A list of sentences."""

    items: tuple[str, ...]


@record(eq=False)
class Listing:
    """Text whose lines are kept as they are."""

    words: str


@record(eq=False)
class ReportTable:
    """A table of the report, its heads first."""

    rows: tuple[tuple[str, ...], ...]


@record(eq=False)
class Figure:
    """A picture of the report, SVG, with the name of its file; one that is a page has its own size."""

    name: str
    caption: str
    content: bytes
    is_page: bool = False


Block = Heading | Paragraph | Bullets | Listing | ReportTable | Figure


def write_markdown(job: Job) -> dict[str, bytes]:
    """The report as Markdown, with its pictures in files of their own."""
    blocks = list(_blocks(job))
    lines = [_in_markdown(block) for block in blocks]
    text = f"# {harmless(job.title.name or job.name)}: report\n\n" + "\n\n".join(lines) + "\n"
    pictures = {block.name: block.content for block in blocks if isinstance(block, Figure)}
    return {f"{job.name}-report.md": text.encode("utf-8", "replace")} | pictures


def write_report(job: Job) -> dict[str, bytes]:
    """The report as PDF and as Markdown."""
    typst, blocks = _typst(), list(_blocks(job))
    title = f"{job.title.name or job.name}: report"
    source = "\n\n".join(
        [
            f"#set document(title: {_quoted(title)}, date: none)",
            '#set page(paper: "a4", margin: 20mm, numbering: "1 / 1")',
            '#set text(font: "Libertinus Serif", size: 10pt)',
            '#set heading(numbering: "1")',
            f'#align(center, text(size: 18pt, weight: "bold", {_quoted(title)}))',
            *map(_in_typst, blocks),
        ]
    )
    pictures = {block.name: block.content for block in blocks if isinstance(block, Figure)}
    return {f"{job.name}-report.pdf": _pdf(typst, source, pictures)} | write_markdown(job)


def sheet_pdf(job: Job) -> bytes:
    """The dimensioned drawing as PDF on paper of its size."""
    drawing = Figure("sheet.svg", "", sheet(job), is_page=True)
    source = f"#set document(title: {_quoted(job.name)}, date: none)\n#set page(margin: 0mm)\n{_in_typst(drawing)}"
    return _pdf(_typst(), source, {drawing.name: drawing.content})


def _typst() -> Any:
    try:
        return import_module(TYPST)
    except ImportError:
        problem = f"names a format of PDF, which the package {TYPST} sets, and it is not installed"
        remedy = f"install it by `pip install {TYPST}`, or name report-md for Markdown and sheet-svg for the drawing"
        raise DesignError("write", problem, remedy, "conflict") from None


def _pdf(typst: Any, source: str, pictures: dict[str, bytes]) -> bytes:
    """A document of the package's own fonts only, so that it is the same on every machine."""
    files = {"main": source.encode()} | pictures
    content: bytes = typst.compile(files, format="pdf", ignore_system_fonts=True, timestamp=0)
    return content


def _blocks(job: Job) -> Iterator[Block]:
    """The report in its order: inputs, formulas, results, checks, plots, assembly, bill, certificate, drawing."""
    source, unit = job.source, job.unit
    if job.about:
        yield Paragraph(harmless(job.about))
    yield Heading("Inputs")
    yield Paragraph("The recipe. Keys that it omits have their default values; the results below follow from both.")
    yield Listing(job.recipe())
    if source.formulas:
        yield Heading("Formulas with the numbers put in")
        given = [formula for formula in source.formulas if not formula.expression]
        rows = ((f.symbol, f.name, f"{f.value:.{DIGITS + 1}g}", f.unit) for f in given)
        yield ReportTable((("symbol", "given", "value", "unit"), *rows))
        yield Paragraph("Powers are written ^; atan2(y, x) is the direction of the point (x, y). Angles are in deg.")
        for k, formula in enumerate((f for f in source.formulas if f.expression), 1):
            yield Paragraph(f"({k}) {formula.name[:1].upper()}{formula.name[1:]}, by {formula.source}:", is_kept=True)
            value = f"{formula.value:.{DIGITS}g} {formula.unit}".strip()
            yield Listing(f"{formula.symbol} = {formula.expression}\n  = {formula.substituted}\n  = {value}")
    if source.table is not None:
        yield Heading("Results")
        yield Paragraph(
            "The least and the largest value of each quantity over the motion; the table of files has all.",
            is_kept=True,
        )
        yield ReportTable((("quantity", "unit", "least", "largest"), *_extremes(job)))
    if source.checks:
        yield Heading("Checks")
        yield ReportTable((("check", "value", "limit", "unit", "verdict"), *_checks(job)))
    if source.scene is not None:
        yield Heading("Plots")
        for k, (name, content) in enumerate(write_plots(job).items(), 1):
            caption = name.removeprefix(f"{job.name}-").removesuffix("-plot.svg").replace("-", " ")
            yield Figure(f"{job.name}-report-plot-{k}.svg", capital(caption), content)
        yield Heading("Assembly")
        yield Figure(f"{job.name}-report-assembly.svg", "The parts in place", assembly_picture(job))
        if source.steps:
            yield Bullets(tuple(map(harmless, source.steps)))
    if source.parts:
        yield Heading("Bill of materials")
        columns = [column for column in bill(job).columns if column.id in ("item", "count", "joints")]
        yield ReportTable((tuple(c.id for c in columns), *zip(*(map(str, c.values.tolist()) for c in columns))))
    yield Heading("Certificate")
    yield Paragraph(harmless(job.stamp))
    if job.certificate:
        yield Paragraph(
            "The files of the recipe, made again and compared, or measured against its exact curves:", is_kept=True
        )
        yield ReportTable((("file", "proved by", f"largest deviation, {unit.name}", "verdict"), *job.certificate))
    else:
        yield Paragraph("The files are not verified yet: geomkin run --verify measures them and puts the result here.")
    yield Paragraph("Checked by: ______________________    Date: ______________")
    if source.parts:
        yield Heading("Drawing")
        yield Paragraph("All parts with their dimensions; the title block has the scale.")
        yield Figure(f"{job.name}-report-drawing.svg", f"Dimensions in {unit.plural}", sheet(job), is_page=True)


def _extremes(job: Job) -> Iterator[tuple[str, ...]]:
    """The least and the largest finite value of each column."""
    for column in job.table.columns:
        values = np.asarray(column.values)
        if values.dtype.kind in "iuf" and np.isfinite(values.astype(float)).any():
            finite = values[np.isfinite(values.astype(float))]
            ends = (f"{float(end) + 0.0:.{DIGITS}g}" for end in (finite.min(), finite.max()))
            yield (column.id.replace("_", " "), column.unit, *ends)


def _checks(job: Job) -> Iterator[tuple[str, ...]]:
    for check in job.source.checks:
        verdict = "passed" if check.passed else f"failed as expected: {check.expected}" if check.expected else "failed"
        value, limit = (number(size, check.digits(4)) for size in (check.value, check.limit))
        yield capital(check.name), value, f"{check.side} {limit}", check.unit, verdict


def _in_markdown(block: Block) -> str:
    match block:
        case Heading():
            return f"## {block.words}"
        case Bullets():
            return "\n".join(f"- {item}" for item in block.items)
        case Listing():
            return f"```\n{block.words.strip()}\n```"
        case Figure():
            return f"![{block.caption}]({block.name})"
        case ReportTable():
            rows = [" | ".join(cell.replace("|", "\\|") for cell in row) for row in block.rows]
            return "\n".join(f"| {row} |" for row in (rows[0], " | ".join(["---"] * len(block.rows[0])), *rows[1:]))
    return block.words


def _in_typst(block: Block) -> str:
    match block:
        case Heading():
            return f"#heading({_quoted(block.words)})"
        case Bullets():
            return f"#list({', '.join(map(_quoted, block.items))})"
        case Listing():
            return f"#block(breakable: true, raw(block: true, {_quoted(block.words.strip())}))"
        case Figure(is_page=True):
            width, height = re.findall(r'(?:width|height)="([\d.]+(?:mm|in))"', block.content.decode())[:2]
            picture = f"image({_quoted(block.name)}, width: {width}, height: {height})"
            return f"#page(width: {width}, height: {height}, margin: 0mm, numbering: none, {picture})"
        case Figure():
            # Three plots fill a page.
            return f"#figure(image({_quoted(block.name)}, width: 64%), caption: {_quoted(block.caption)})"
        case ReportTable():
            heads, cells = (", ".join(map(_quoted, row)) for row in (block.rows[0], sum(block.rows[1:], ())))
            return f"#table(columns: {len(block.rows[0])}, stroke: 0.4pt, table.header({heads}), {cells})"
    kept = "true" if block.is_kept else "false"
    return f"#block(sticky: {kept}, {_quoted(block.words)})"


def _quoted(words: str) -> str:
    """A text as a string of Typst, which has the escapes of JSON for these characters."""
    return re.sub(r"\\u([0-9a-f]{4})", r"\\u{\1}", json.dumps(harmless(words) if "\n" not in words else words))

"""The page of a certificate: a table of files, and a picture of each largest deviation."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path

import numpy as np

from ..core.units import MM, LengthUnit
from ..export.summary import CERTIFICATE, write_whole
from ..export.text import as_json, text
from ..plane.region import thinned
from ..plane.vec import Complex
from .certificate import Certificate, FileReport, verify
from .outline import Outline

# Size of a picture, px, and half the side of the close-up's view, as a multiple of the deviation.
WIDE, CLOSE = 320, 12
STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 60rem; padding: 0 1rem; color: #222;
  background: #fff }
table { border-collapse: collapse; width: 100% } td, th { text-align: left; padding: .3rem .6rem; vertical-align: top;
  border-bottom: 1px solid #ddd } .bad { color: #a33a00; font-weight: 600 }
figure { display: inline-block; margin: 1rem 1rem 0 0 } figcaption { max-width: 660px }
code { overflow-wrap: anywhere } .files { overflow-x: auto }
svg { border: 1px solid #ddd; background: #fff; box-sizing: border-box; max-width: 100%; height: auto }
.exact { stroke: #0072b2; fill: none } .file { stroke: #d55e00; fill: none; stroke-dasharray: 6 3 }
.place { stroke: #000; fill: none }
path, circle { vector-effect: non-scaling-stroke; stroke-width: 1.5 }
@media (prefers-color-scheme: dark) { body { background: #1b1b1b; color: #ddd } td, th { border-color: #444 }
  .bad { color: #ff9a5c } }
"""


def certify(folder: Path) -> Certificate:
    """Verify the folder of a recipe, write verify.json and verify.html into it, and the results into its report."""
    (certificate,) = verify(folder)
    data = json.dumps(as_json(certificate.to_dict()), indent=1, ensure_ascii=False) + "\n"
    contents = (data.encode("utf-8", "replace"), certificate_page(certificate))
    write_whole(folder, dict(zip(CERTIFICATE, contents, strict=True)) | dict(certificate.reports))
    return certificate


def certificate_page(certificate: Certificate) -> bytes:
    """The page, one HTML file that needs no other."""
    verdict = "Every file is as designed." if certificate.passed else "Some files are not as designed."
    unit = certificate.unit
    rows = "".join(f"<tr>{_row(file, unit)}</tr>" for file in certificate.files)
    figures = "".join(_figure(file, unit) for file in _pictured(certificate.files))
    problems = "".join(f'<p class="bad">{text(unit.text(problem))}</p>' for problem in certificate.problems)
    name = text(certificate.name)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{name}: certificate</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">"
        f"<style>{STYLE}</style></head>\n<body><main><h1>{name}: certificate</h1>\n<p>{verdict}</p>{problems}"
        "<p>The recipe was made again and each file compared with the result. Lines and solids of files that differ "
        "were measured against the exact curves of the recipe, both ways. The tolerance is "
        f"{unit.of(certificate.tolerance):.6g} {unit.name}, the kerf {unit.of(certificate.kerf):.6g} {unit.name}. "
        f"Recipe: SHA-256 "
        f"<code>{text(certificate.recipe_hash)}</code>.</p>\n"
        '<div class="files" role="region" aria-label="files" tabindex="0">'
        f"<table><thead><tr><th>file</th><th>largest deviation, {unit.name}</th><th>at</th><th>parts</th><th>holes</th>"
        f"<th>proved by</th></tr></thead><tbody>{rows}</tbody></table></div>\n{figures}</main></body></html>\n"
    ).encode("utf-8", "replace")


def _row(file: FileReport, unit: LengthUnit) -> str:
    measured = isfinite(file.deviation)
    at, decimals = unit.of(file.place), 3 if unit is MM else 4
    place = f"{text(file.part)} ({at.real:.{decimals}f}, {at.imag:.{decimals}f})" if measured else ""
    result = text(" ".join(filter(None, (file.proof, file.note and f"({file.note})")))) if file.passed else ""
    wrong = "".join(f'<div class="bad">{text(unit.text(problem))}</div>' for problem in file.problems)
    numbers = f"<td>{file.parts or ''}</td><td>{file.holes if file.parts else ''}</td>"
    deviation = f"{unit.of(file.deviation):.{decimals + 1}f}" if measured else ""
    return f"<td>{text(file.file)}</td><td>{deviation}</td><td>{place}</td>{numbers}<td>{result}{wrong}</td>"


def _pictured(files: Sequence[FileReport]) -> Iterator[FileReport]:
    """The files to draw: those with problems or, if there are none, the one with the largest deviation."""
    drawn = [file for file in files if file.worst is not None]
    wrong = [file for file in drawn if not file.passed]
    yield from wrong or sorted(drawn, key=lambda file: -file.deviation)[:1]


def _figure(file: FileReport, unit: LengthUnit) -> str:
    assert file.worst and file.worst.plate and file.worst.exact
    exact, plate, place = file.worst.exact, file.worst.plate, file.place
    low, high = _box(exact.outline.points)
    middle, half = (low + high) / 2, max((high - low).real, (high - low).imag) * 0.55
    near = max(CLOSE * file.deviation, 1e-6 * half)
    whole = _svg("the part", middle, half, [("exact", exact.loops)], place, 0.03 * half)
    both = [("exact", exact.loops), ("file", plate.loops)]
    close = _svg("the place of the largest deviation", place, near, both, place, file.deviation)
    deviation = f"{unit.of(file.deviation):.{4 if unit is MM else 5}f} {unit.name}"
    caption = (
        f"{text(file.file)}, {text(file.part)}: the largest deviation, {deviation}. Left: the part, with "
        f"its place ringed. Right: {unit.of(2 * near):.3g} {unit.name} across, the exact curve solid, the file "
        "dashed; the ring has the deviation as its radius."
    )
    return f"<figure>{whole} {close}<figcaption>{caption}</figcaption></figure>"


def _box(points: Complex) -> tuple[complex, complex]:
    return complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())


def _svg(
    label: str, middle: complex, half: float, drawn: Sequence[tuple[str, Sequence[Outline]]], place: complex, r: float
) -> str:
    """A square picture about a point. Coordinates are relative to the point, so that close-ups keep their digits."""
    scale = WIDE / (2 * half)

    def at(z: complex) -> str:
        local = (z - middle) * scale
        return f"{WIDE / 2 + local.real:.2f} {WIDE / 2 - local.imag:.2f}"

    lines = []
    for name, loops in drawn:
        for loop in loops:
            for run in _runs(loop, middle, 2 * half):
                lines.append(f'<path class="{name}" d="M{"L".join(at(complex(z)) for z in run)}"/>')
    x, y = at(place).split()
    lines.append(f'<circle class="place" cx="{x}" cy="{y}" r="{r * scale:.2f}"/>')
    size = f'width="{WIDE}" height="{WIDE}" viewBox="0 0 {WIDE} {WIDE}"'
    return f'<svg {size} role="img" aria-label="{label}">{"".join(lines)}</svg>'


def _runs(loop: Outline, middle: complex, reach: float) -> Iterator[Complex]:
    """The runs of a loop within a distance of a point, without points too close together for a screen."""
    points = np.append(loop.points, loop.points[:1])
    starts, ends = points[:-1], points[1:]
    edge = ends - starts
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.nan_to_num(np.clip(((middle - starts) * edge.conj()).real / np.abs(edge) ** 2, 0, 1))
    seen = np.abs(starts + share * edge - middle) < 1.5 * reach
    if seen.all():
        yield np.append(thinned(loop.points, reach / 1000), loop.points[:1])
        return
    changes = np.flatnonzero(np.diff(np.concatenate([[False], seen, [False]]).astype(int)))
    for first, last in changes.reshape(-1, 2):
        yield points[first : last + 1]

"""SVG drawings as programs, slips and malice write them: the right points, or one line that names the fault, soon."""

import time

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.kinds.path_generator import FileName

PATH = '<path d="M 0 0 H 10 V 20"/>'
CORNERS = (0, 10, 10 + 20j)
NAMESPACES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
PIXEL = 25.4 / 96


def drawing(inside=PATH, about="", before=""):
    return f"{before}<svg {NAMESPACES} {about}>{inside}</svg>"


def group(about, inside=PATH):
    return drawing(f"<g {about}>{inside}</g>")


def moved(change):
    """Corners of PATH after a change of the plane, y down."""
    return tuple(change(z) for z in CORNERS)


# name: (drawing, corners of the line it shows, y down, mm); nothing of them where it is refused.
SHOWN = {
    "plain": (drawing(), CORNERS),
    "no namespace": (f"<svg>{PATH}</svg>", CORNERS),
    "prefix": ('<s:svg xmlns:s="http://www.w3.org/2000/svg"><s:path d="M0 0H10V20"/></s:svg>', CORNERS),
    "declaration and doctype": (
        drawing(before='<?xml version="1.0"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://x/svg11.dtd">'),
        CORNERS,
    ),
    "byte order mark": ("\ufeff" + drawing(), CORNERS),
    "single quotes": (drawing("<path d='M 0 0 H 10 V 20'/>"), CORNERS),
    "greater than in an attribute": (drawing('<path aria-label="a > b" d="M 0 0 H 10 V 20"/>'), CORNERS),
    "references to characters": (drawing('<path d="M 0 0&#x20;H 10&#10;V 20"/>'), CORNERS),
    "path in a comment": (drawing(f'<!-- <path d="M 5 5 H 7"/> -->{PATH}'), CORNERS),
    "path in a text": (drawing(f'<desc><![CDATA[<path d="M 5 5 H 7"/>]]></desc>{PATH}'), CORNERS),
    "path in a clip path": (drawing(f'<clipPath id="c"><path d="M 5 5 H 7"/></clipPath>{PATH}'), CORNERS),
    "path in a mask": (drawing(f'<mask id="c"><path d="M 5 5 H 7"/></mask>{PATH}'), CORNERS),
    "path in a marker": (drawing(f'<marker id="c"><path d="M 5 5 H 7"/></marker>{PATH}'), CORNERS),
    "path in a pattern": (drawing(f'<pattern id="c"><path d="M 5 5 H 7"/></pattern>{PATH}'), CORNERS),
    "path in definitions": (drawing(f'<defs><path d="M 5 5 H 7"/></defs>{PATH}'), CORNERS),
    "path of another namespace": (drawing(f'<x:path xmlns:x="urn:x" d="M 5 5 H 7"/>{PATH}'), CORNERS),
    "element that begins like path": (drawing(f'<pathology d="M 5 5 H 7"/>{PATH}'), CORNERS),
    "attribute that ends like d": (drawing('<path id="M 5 5" data-d="M 5 5 H 7" d="M 0 0 H 10 V 20"/>'), CORNERS),
    "empty path first": (drawing(f'<path/><path d=""/><path d="none"/>{PATH}'), CORNERS),
    "shape first": (drawing(f'<rect width="50" height="50"/>{PATH}'), CORNERS),
    "hidden first": (drawing(f'<path display="none" d="M 5 5 H 7"/>{PATH}'), CORNERS),
    "hidden by style first": (drawing(f'<g style="fill:red; display : none"><path d="M 5 5 H 7"/></g>{PATH}'), CORNERS),
    "harmless style sheet": (drawing(f"<style>.a {{fill: none; stroke-width: 1}}</style>{PATH}"), CORNERS),
    "translate": (group('transform="translate(3,-4)"'), moved(lambda z: z + 3 - 4j)),
    "translate along x": (group('transform="translate(3)"'), moved(lambda z: z + 3)),
    "scale": (group('transform="scale(10)"'), moved(lambda z: 10 * z)),
    "unequal scale": (group('transform="scale(2 -3)"'), moved(lambda z: complex(2 * z.real, -3 * z.imag))),
    "rotate": (group('transform="rotate(90)"'), moved(lambda z: 1j * z)),
    "rotate about a point": (group('transform="rotate(90 1 2)"'), moved(lambda z: 1j * (z - 1 - 2j) + 1 + 2j)),
    "skew x": (group('transform="skewX(45)"'), moved(lambda z: z + z.imag)),
    "skew y": (group('transform="skewY(45)"'), moved(lambda z: z + 1j * z.real)),
    "matrix": (
        group('transform="matrix(1 2 3 4 5 6)"'),
        moved(lambda z: complex(z.real + 3 * z.imag + 5, 2 * z.real + 4 * z.imag + 6)),
    ),
    "list of transforms": (
        group('transform=" translate(1-2) , scale(2)rotate( 90 ) "'),
        moved(lambda z: 2j * z + 1 - 2j),
    ),
    "groups in groups": (
        drawing(f'<g transform="scale(2)"><a transform="translate(1 0)"><g transform="rotate(180)">{PATH}</g></a></g>'),
        moved(lambda z: 2 * (1 - z)),
    ),
    "transform of the path": (drawing('<path transform="scale(2)" d="M 0 0 H 10 V 20"/>'), moved(lambda z: 2 * z)),
    "arc in a skewed group": (group('transform="scale(1 2)"', '<path d="M 0 0 A 5 5 0 0 1 10 0"/>'), "arc"),
    "use": (
        drawing('<defs><path id="p" d="M 0 0 H 10 V 20"/></defs><use href="#p" x="3" y="4" transform="scale(2)"/>'),
        moved(lambda z: 2 * (z + 3 + 4j)),
    ),
    "use of a later group": (
        drawing(f'<use xlink:href="#g"/><defs><g id="g" transform="scale(3)">{PATH}</g></defs>'),
        moved(lambda z: 3 * z),
    ),
    "use of a symbol": (
        drawing(f'<symbol id="s">{PATH}</symbol><use href="#s" x="1mm"/>'),
        moved(lambda z: z + 1 / PIXEL),
    ),
    "inner drawing": (drawing(f'<svg x="3" y="4">{PATH}</svg>'), moved(lambda z: z + 3 + 4j)),
    "millimetres": (drawing(about='width="100mm" height="50mm" viewBox="0 0 1000 500"'), moved(lambda z: z / 10)),
    "inches": (drawing(about='width="2in" viewBox="0 0 100 10"'), moved(lambda z: 0.508 * z)),
    "pixels": (drawing(about='width="100px" height="100px"'), moved(lambda z: PIXEL * z)),
    "no unit": (drawing(about='width="100" height="100"'), CORNERS),
    "no unit with a view box": (drawing(about='width="100" height="100" viewBox="0 0 50 50"'), moved(lambda z: 2 * z)),
    "percent": (drawing(about='width="100%" height="100%" viewBox="0 0 50 50"'), CORNERS),
    "view box aside": (drawing(about='viewBox="-5 -7 50 50"'), moved(lambda z: z + 5 + 7j)),
    "view box in the middle": (
        drawing(about='width="200mm" height="100mm" viewBox="0 0 100 100"'),
        moved(lambda z: z + 50),
    ),
    "view box at the end": (
        drawing(about='width="20cm" height="100mm" viewBox="0 0 100 100" preserveAspectRatio="xMaxYMin slice"'),
        moved(lambda z: 2 * z),
    ),
    "view box stretched": (
        drawing(about='width="200mm" height="100mm" viewBox="0,0,100,100" preserveAspectRatio="none"'),
        moved(lambda z: complex(2 * z.real, z.imag)),
    ),
    "huge arc": (drawing('<path d="M 0 0 A 1e9 1e9 0 0 1 10 0 V 20"/>'), CORNERS),
    "arc of no radius": (drawing('<path d="M 0 0 A 0 5 0 1 1 10 0 V 20"/>'), CORNERS),
    "tiny arc is enlarged": (group("", '<path d="M 0 0 A 1e-300 2e-300 0 0 1 10 0"/>'), "arc"),
}
BOMB = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 12))
USES = "".join(f'<g id="u{k}">{f"""<use href="#u{k - 1}"/>""" * 10}</g>' for k in range(1, 12))
# name: (drawing, what the line names).
REFUSED = {
    "nothing": ("", "XML"),
    "words": ("no drawing at all", "XML"),
    "html": ("<html><body/></html>", "html"),
    "cut off": (drawing()[:-9], "XML"),
    "wrong end tag": ("<svg><g></svg>", "XML"),
    "unknown entity": (drawing('<path d="&nope;"/>'), "XML"),
    "zero byte": (drawing("\0"), "XML"),
    "twice an attribute": (drawing('<path d="M 0 0" d="M 1 1"/>'), "XML"),
    "starts of tags": ("<path " * 33_000, "elements|XML"),
    "starts of paths": ("<svg>" + '<path d="' * 20_000, "XML"),
    "open comment": ("<svg>" + "<!-- " * 40_000, "XML"),
    "entity bomb": (f'<!DOCTYPE svg [<!ENTITY l0 "M 0 0">{BOMB}]>' + drawing('<path d="&l11;"/>'), "ENTITY"),
    "external entity": ('<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>' + drawing("&x;"), "ENTITY"),
    "default attributes": ('<!DOCTYPE svg [<!ATTLIST path d CDATA "M 0 0 H 5">]>' + drawing("<path/>"), "ATTLIST"),
    "many elements": (drawing("<g/>" * 200_000), "elements"),
    "many attributes": ("<svg " + " ".join(f'a{k}=""' for k in range(600_000)) + "/>", "elements"),
    "many empty paths": (drawing("<path/>" * 40_000), "elements"),
    "deep groups": (drawing("<g>" * 40_000 + "</g>" * 40_000), "deep"),
    "use of itself": (drawing('<use id="u" href="#u"/>'), "'u'"),
    "use of its group": (drawing('<g id="u"><g><use href="#u"/></g></g>'), "'u'"),
    "uses of each other": (drawing('<use id="a" href="#b"/><use id="b" href="#a"/>'), "within itself"),
    "uses of uses": (drawing(f'<defs><g id="u0"/>{USES}</defs><use href="#u11"/>'), "elements"),
    "use of another file": (drawing('<use href="other.svg#a"/>'), "other.svg#a"),
    "use of nothing": (drawing('<use href="#a"/>'), "#a"),
    "symbol with a view box": (
        drawing(f'<symbol id="s" viewBox="0 0 1 1">{PATH}</symbol><use href="#s" width="9" height="9"/>'),
        "viewBox",
    ),
    "inner view box": (drawing(f'<svg viewBox="0 0 1 1">{PATH}</svg>'), "viewBox"),
    "switch": (drawing(f"<switch>{PATH}</switch>"), "switch"),
    "only a circle": (drawing('<circle r="5"/>'), "circle"),
    "only a symbol": (drawing(f'<symbol id="s">{PATH}</symbol>'), "path"),
    "unknown transform": (group('transform="perspective(3)"'), "perspective"),
    "transform cut off": (group('transform="rotate(10"'), "rotate"),
    "transform with a unit": (group('transform="rotate(10deg)"'), "10deg"),
    "transform with too few numbers": (group('transform="matrix(1 0 0 1 5)"'), "matrix"),
    "transform out of reach": (group('transform="scale(1e308)"'), "scale"),
    "transforms out of reach": (group('transform="' + "scale(1e9)" * 99 + '"'), "far"),
    "transform to a point": (group('transform="scale(0)"'), "0 mm"),
    "endless transforms": (group('transform="' + "translate(1)" * 50_000 + '"'), "transform"),
    "transform by style": (group('style="transform: scale(10)"'), "transform"),
    "transform by style sheet": (drawing(f"<style>path {{ transform : scale(10) }}</style>{PATH}"), "transform"),
    "transform about a place": (group('transform="scale(2)" transform-origin="center"'), "transform-origin"),
    "hidden by style sheet": (drawing(f"<style>path {{display:none}}</style>{PATH}"), "display"),
    "invisible": (group('visibility="hidden"'), "visibility"),
    "width in letters": (drawing(about='width="10em"'), "10em"),
    "width of nothing": (drawing(about='width="0mm" viewBox="0 0 1 1"'), "width"),
    "view box of words": (drawing(about='viewBox="a b c d"'), "viewBox"),
    "view box of nothing": (drawing(about='viewBox="0 0 0 0"'), "viewBox"),
    "odd aspect ratio": (drawing(about='viewBox="0 0 9 9" preserveAspectRatio="middle"'), "middle"),
    "unfinished path": (drawing('<path d="M 0 0 L 1"/>'), "character"),
    "path of words": (drawing('<path d="hello"/>'), "hello"),
    "path of a place": (drawing('<path d="M 5 5"/>'), "0 mm"),
    "path too far": (drawing('<path d="M 0 0 H 1e99"/>'), "1e99"),
    "path of many commands": (drawing(f'<path d="M 0 0{"h1" * 400_000}"/>'), "commands"),
    "numbers of many digits": (drawing(f'<path d="M 0 0 H {"9" * 100_000}"/>'), "path"),
    "controls": (drawing(group('transform="\u202e&#x9b;31m"')), "transform"),
}


def points_of(text, count, folder):
    (folder / "a.svg").write_text(text, encoding="utf-8")
    begun = time.process_time()
    try:
        return FileName("a.svg", folder).points(count)
    finally:
        assert time.process_time() - begun < 1


@pytest.mark.parametrize("name", SHOWN)
def test_a_drawing_shows_its_first_path(name, tmp_path):
    text, corners = SHOWN[name]
    points = points_of(text, 201, tmp_path)
    if corners == "arc":
        # Half an ellipse above the x axis of SVG; twice as high as wide where it is scaled, or by its radii.
        on = ((points.real - 5) / 5) ** 2 + (points.imag / 10) ** 2
        assert on == pytest.approx(np.ones(201), abs=1e-3) and points.imag.max() == pytest.approx(10, abs=1e-2)
        return
    corners = np.conj(np.array(corners, dtype=complex))
    # The same line, measured out anew.
    length = np.concatenate([[0], np.cumsum(np.abs(np.diff(corners)))])
    assert points == pytest.approx(np.interp(np.linspace(0, length[-1], 201), length, corners), abs=1e-6)


def test_unsupported_drawings_are_refused_by_name(tmp_path):
    for name in REFUSED:
        text, named = REFUSED[name]
        with pytest.raises(gk.DesignError, match=rf"^file: a\.svg: .*({named})") as refused:
            points_of(text, 60, tmp_path)
        assert str(refused.value).isprintable() and len(str(refused.value)) < 300

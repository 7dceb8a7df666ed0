"""Each part of the gallery rebuilt from the numbers of its drawing alone, and compared with the exact part.

Drawn lines are only used to see which number belongs to what, as a reader does: their lengths are never taken.
"""

import io
import re
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
import shapely.affinity

import geomkin as gk
from geomkin.export.dxf import sheet
from geomkin.export.job import Job, StaticSource
from geomkin.plane import xy
from tests.campaign import by_default

RECIPES = sorted((Path(__file__).parent.parent.parent / "recipes").glob("*.toml"))
# Largest distance on paper, mm, of what is drawn at the same place; numbers are rounded to 0.0005 mm.
SAME, ROUNDING = 3e-3, 6e-4
NUMBER = r"[-+]?[\d.]+(?:e-?\d+)?"


def number(text):
    return float(re.search(NUMBER, text)[0])


def planar(place):
    return complex(place.x, place.y)


class Drawn:
    """The drawing of one part, read from the file."""

    def __init__(self, part, recipe):
        named = recipe.notes.get("measures_mm", recipe.notes.get("wheels", ()))
        is_described = part is recipe.parts[0] or part.name in named or "mechanisms" in recipe.notes
        source = StaticSource((part,), table=recipe.table, notes=recipe.notes if is_described else {})
        job = Job("a", source, recipe.files.tolerance)
        document = ezdxf.read(io.StringIO(sheet(job).decode("cp1252")))
        assert not document.audit().errors
        space, header = document.modelspace(), document.header
        ends = [complex(*header[name][:2]) for name in ("$EXTMIN", "$EXTMAX", "$LIMMAX")]
        assert all(0 < z.real < w.real and 0 < z.imag < w.imag for z, w in zip(ends, ends[1:]))
        self.texts = [(t.dxf.text, planar(t.get_placement()[1])) for t in space.query("TEXT")]
        self.loops = [entity for entity in space if entity.dxf.layer == "PART"]
        # Sizes for which there was no room at their holes, by the places of these.
        noted = re.findall(rf"((?:\d+ x )?[DØ][^:]*): centre at ((?:{NUMBER}, {NUMBER}(?:; )?)+)", words_of(self))
        self.noted = {
            complex(*map(float, place.split(", "))): text for text, places in noted for place in places.split("; ")
        }
        self.axes = {"x": [], "y": []}
        self.diameters, self.radii, self.datum = [], [], None
        for entity in space.query("DIMENSION"):
            (text,) = entity.get_geometry_block().query("TEXT")
            places = [
                planar(entity.dxf.get(tag))
                for tag in ("defpoint", "defpoint2", "defpoint3", "defpoint4")
                if entity.dxf.hasattr(tag)
            ]
            kind = entity.dimtype
            if kind == 6:
                axis = "x" if entity.dxf.dimtype & 64 else "y"
                self.axes[axis].append((places[1], float(text.dxf.text)))
                self.datum = places[0]
                # A program that measures the entity again finds the same.
                step = places[1] - places[0]
                factor = document.dimstyles.get(entity.dxf.dimstyle).dxf.dimlfac
                measured = (step.real if axis == "x" else step.imag) * factor
                assert measured == pytest.approx(float(text.dxf.text), abs=ROUNDING)
            elif kind == 3:
                self.diameters.append((abs(places[1] - places[0]), text.dxf.text))
            elif kind == 4:
                self.radii.append((abs(places[1] - places[0]), text.dxf.text))

    def place(self, at):
        """The place that the ordinates give to a point on paper, mm from the datum."""
        if self.datum is None:
            return 0j
        values = []
        for axis, part in (("x", "real"), ("y", "imag")):
            found = [v for z, v in self.axes[axis] if abs(getattr(z, part) - getattr(at, part)) < SAME]
            assert found, f"no {axis} of {at - self.datum}"
            values.append(found[0])
        return complex(*values)

    def callout(self, drawn, callouts, is_slot=False):
        """The text at a circle or arc of a size; of several for this size, which then state the same number, one."""
        texts = [text for size, text in callouts if abs(size - drawn) < SAME and ("slot" in text) == is_slot]
        assert len({re.search(NUMBER, text.split("x ")[-1])[0] for text in texts}) == 1, texts
        return texts[0]


def diameter(text):
    """The diameter as drawn: of an ISO fit the middle of its limits."""
    value = number(text[text.index("Ø") :])
    if limits := re.search(r"[A-Za-z]\d+ \(([-+\d.]+)/([-+\d.]+)\)", text):
        value += (float(limits[1]) + float(limits[2])) / 2
    return value


def edges(entity):
    """Lines and arcs of a drawn contour: start, end, bulge, centre and radius, whole arcs in one."""
    rows = np.array(entity.get_points("xyb"))
    z, bulge = rows[:, 0] + 1j * rows[:, 1], rows[:, 2]
    found = []
    for start, end, b in zip(z, np.roll(z, -1), bulge):
        centre = (start + end) / 2 + 1j * (end - start) * (1 - b * b) / (4 * b) if b else None
        if found and b and found[-1][3] is not None and abs(found[-1][3] - centre) < SAME and found[-1][2] * b > 0:
            found[-1][1] = end
            continue
        found.append([start, end, b, centre])
    (_, _, b_1, c_1), (_, _, b_2, c_2) = found[0], found[-1]
    if len(found) > 1 and None not in (c_1, c_2) and abs(c_1 - c_2) < SAME and b_1 * b_2 > 0:
        found[0][0] = found.pop()[0]
    return found


def tangent(edge, at_end):
    start, end, b, centre = edge
    place = end if at_end else start
    direction = end - start if centre is None else 1j * np.sign(b) * (place - centre)
    return direction / abs(direction)


def rebuilt_contour(drawn, pieces):
    """Points of a contour from its radii, the centres of its arcs, and its corners."""
    count = len(pieces)
    corners = [
        abs(np.angle(tangent(pieces[(k + 1) % count], False) / tangent(pieces[k], True))) > 0.02 for k in range(count)
    ]
    knots = []
    for k, (_, end, _, _) in enumerate(pieces):
        following = pieces[(k + 1) % count]
        if corners[k]:
            knots.append(drawn.place(end))
            continue
        # A smooth joint: the direction follows from what it touches.
        touched = [
            touching(drawn, pieces[k], corners[k - 1]),
            touching(drawn, following, corners[(k + 1) % count], True),
        ]
        if pieces[k][3] is None:
            touched[0] = (drawn.place(pieces[k][0]), 0.0) if corners[k - 1] else touching(drawn, pieces[k - 1], False)
        if following[3] is None:
            after = pieces[(k + 2) % count]
            touched[1] = (drawn.place(following[1]), 0.0) if corners[(k + 1) % count] else touching(drawn, after, False)
        (c_1, r_1), (c_2, r_2) = touched
        step = c_2 - c_1
        if pieces[k][3] is not None and following[3] is not None:
            direction = step / (1j * (r_2 - r_1))
            direction /= abs(direction)
        else:
            direction = step / (np.sqrt(abs(step) ** 2 - (r_2 - r_1) ** 2) + 1j * (r_2 - r_1))
        c, r = (c_1, r_1) if pieces[k][3] is not None else (c_2, r_2)
        knots.append(c - 1j * direction * r)
    points = []
    for k, (_, _, b, centre) in enumerate(pieces):
        start, end = knots[k - 1], knots[k]
        if centre is None:
            points.append([start, end])
            continue
        radius = number(drawn.callout(abs(pieces[k][0] - centre), drawn.radii).split("R")[1])
        if corners[k] and corners[k - 1]:
            half = (end - start) / 2
            spokes = [end - centre for end in (pieces[k - 1][1], pieces[k][1])]
            side = 1 if np.angle(spokes[1] / spokes[0]) * np.sign(b) % (2 * np.pi) < np.pi else -1
            c = (start + end) / 2 + 1j * half / abs(half) * np.sign(b) * side * np.sqrt(radius**2 - abs(half) ** 2)
        else:
            c = drawn.place(centre)
        sweep = np.angle((end - c) / (start - c)) % (2 * np.pi) - (0 if b > 0 else 2 * np.pi)
        points.append(c + (start - c) * np.exp(1j * np.linspace(0, sweep, 200)))
    return np.concatenate(points)


def touching(drawn, edge, *_):
    """Centre and signed radius of an arc."""
    start, _, b, centre = edge
    if centre is None:
        return None
    return drawn.place(centre), np.sign(b) * number(drawn.callout(abs(start - centre), drawn.radii).split("R")[1])


def slot_or_bore(drawn, entity, is_slot):
    """Points of a slot, or of a bore with flats or a keyway, from its callout."""
    pieces = edges(entity)
    arcs = [piece for piece in pieces if piece[3] is not None]
    widest = max(arcs, key=lambda piece: abs(piece[0] - piece[3]))
    text = drawn.callout(2 * abs(widest[0] - widest[3]), drawn.diameters, is_slot)
    if "slot" in text:
        ends = [drawn.place(piece[3]) for piece in arcs]
        line = shapely.LineString(xy(np.array(ends)))
        return line.buffer(number(text[text.index("slot") :]) / 2, quad_segs=200)
    centre, across = drawn.place(widest[3]), diameter(text)
    disc = shapely.Point(centre.real, centre.imag).buffer(across / 2, quad_segs=400)
    straight = [piece for piece in pieces if piece[3] is None]
    normals = [1j * (end - start) / abs(end - start) for start, end, _, _ in straight]
    if keyway := re.search(rf"keyway ({NUMBER}) wide ({NUMBER}) deep", text):
        wide, deep = map(float, keyway.groups())
        # The bottom is the straight edge farthest from the centre; the slot points to it.
        bottom = max(straight, key=lambda piece: abs((piece[0] + piece[1]) / 2 - widest[3]))
        out = (bottom[0] + bottom[1]) / 2 - widest[3]
        out /= abs(out)
        corners = [
            centre + out * (along + 1j * side * wide / 2)
            for along, side in ((0, -1), (across / 2 + deep, -1), (across / 2 + deep, 1), (0, 1))
        ]
        return disc.union(shapely.Polygon(xy(np.array(corners))))
    flat = float(re.search(rf"(?:across|between) flats? ({NUMBER})", text)[1])
    one = "across flat " in text
    for normal in normals:
        distance = flat - across / 2 if one else flat / 2
        outward = normal if (np.conj(normal) * ((straight[normals.index(normal)][0]) - widest[3])).real > 0 else -normal
        box = [outward * (z + distance) + centre for z in (-100j, 100 - 100j, 100 + 100j, 100j)]
        disc = disc.difference(shapely.Polygon(xy(np.array(box))))
    return disc


def apart(one, other):
    """Largest distance from either of two closed contours to the other, mm."""
    rings = []
    for shape in (one, other):
        if not isinstance(shape, shapely.Polygon):
            shape = shapely.Polygon(xy(np.asarray(shape)))
        rings.append(shape.exterior)
    points = [shapely.points(shapely.get_coordinates(shapely.segmentize(ring, ring.length / 600))) for ring in rings]
    return max(shapely.distance(points[0], rings[1]).max(), shapely.distance(points[1], rings[0]).max())


def words_of(drawn):
    return " ".join(text for text, _ in drawn.texts)


def table_of(drawn, heading):
    """The numbers of the table with a heading, row by row."""
    columns = [[at.real for text, at in drawn.texts if text == name] for name in heading]
    tops = {round(at.imag, 3) for text, at in drawn.texts if text == heading[0]}
    rows = []
    for lefts in zip(*columns):
        cells = [
            {
                round(at.imag, 3): float(text.rstrip("°"))
                for text, at in drawn.texts
                if abs(at.real - left) < SAME and re.fullmatch(NUMBER + "°?", text)
            }
            for left in lefts
        ]
        assert tops and all(cell.keys() == cells[0].keys() for cell in cells)
        rows += [[cell[y] for cell in cells] for y in sorted(cells[0], reverse=True)]
    return np.array(rows)


def check_profile(drawn, exact, tolerance):
    """A cam's or another curve's table against the exact curve."""
    words = words_of(drawn)
    # In inches with two digits.
    assert float(re.search(rf"within ({NUMBER})", words)[1]) <= 1.05 * tolerance
    if "a cubic curve" in words:
        rows = table_of(drawn, ["angle", "radius"])
        assert rows[:, 0] == pytest.approx(np.arange(len(rows)) * 360 / len(rows))
        # A periodic cubic spline, which is another curve than that of the writer.
        count, radius = len(rows), rows[:, 1]
        matrix = 4 * np.eye(count) + np.roll(np.eye(count), 1, 0) + np.roll(np.eye(count), -1, 0)
        slopes = np.linalg.solve(matrix, 3 * (np.roll(radius, -1) - np.roll(radius, 1)))
        t = np.arange(20)[:, None] / 20
        after, slope_after = np.roll(radius, -1), np.roll(slopes, -1)
        r = (
            (1 + 2 * t) * (1 - t) ** 2 * radius
            + t * (1 - t) ** 2 * slopes
            + t * t * (3 - 2 * t) * after
            + t * t * (t - 1) * slope_after
        )
        made = r.T.ravel() * np.exp(2j * np.pi * np.arange(20 * count) / (20 * count))
    else:
        # Straight lines between the points, of a curve with pitches those of one, repeated.
        made = table_of(drawn, ["x", "y"]) @ [1, 1j]
        if pitches := re.search(r"one of (\d+) equal pitches", words):
            count = int(pitches[1])
            step = 2 * np.pi / count * np.sign(np.angle(made[-1] / made[0]))
            assert made[-1] / made[0] == pytest.approx(np.exp(1j * step), abs=1e-3)
            made = (np.exp(1j * step * np.arange(count))[:, None] * made[:-1]).ravel()
    assert apart(made, exact) < tolerance + 2 * ROUNDING


def cut_tooth(teeth, alpha, pitch, tip, root, thickness, fillet):
    """One tooth and the spaces beside it, cut from a blank by rolling a rack whose corners are round."""
    depth, half = pitch - root, (2 * np.pi * pitch / teeth - thickness) / 2
    height = 1.5 * (tip - root)
    lean = np.tan(alpha)
    rack = shapely.Polygon(
        xy(np.array([-half + depth * lean - 1j * depth, half - depth * lean - 1j * depth,
                     half + height * lean + 1j * height, -half - height * lean + 1j * height]))
    )  # fmt: skip
    rack = rack.buffer(-fillet, quad_segs=90).buffer(fillet, quad_segs=90)
    outline = 1j * pitch + shapely.get_coordinates(rack.exterior) @ [1, 1j]
    most = np.arccos(root / tip) + 2 * height / pitch
    space = shapely.union_all(
        [shapely.Polygon(xy((outline + pitch * t) * np.exp(1j * t))) for t in np.linspace(-most, most, 800)]
    )
    blank = shapely.Point(0, 0).buffer(tip, quad_segs=3000)
    spaces = [shapely.affinity.rotate(space, side * 180 / teeth, origin=(0, 0)) for side in (1, -1)]
    return blank.difference(shapely.union_all(spaces))


def shaped_space(teeth, tool_teeth, alpha, pitch, root, tip, thickness, fillet, shift):
    """The space of a ring between two teeth, shaped by a pinion cutter with round corners that rolls in the ring.

    The distance of the axes follows from the shift of the profile, and the width of the cutter's teeth from the space.
    """
    own, involute = tool_teeth * pitch / teeth, np.tan(alpha) - alpha
    wider = 2 * np.tan(alpha) * shift / (teeth - tool_teeth)
    half = (2 * np.pi * pitch / teeth - thickness - 2 * (pitch - own) * wider) / (2 * own)
    low, high = alpha / 2, 1.2
    while high - low > 1e-13:
        middle = (low + high) / 2
        low, high = (middle, high) if np.tan(middle) - middle < involute + wider else (low, middle)
    distance = (pitch - own) * np.cos(alpha) / np.cos(low)
    base, end = own * np.cos(alpha), root - distance
    t = np.linspace(0, np.sqrt((end / base) ** 2 - 1), 200)
    flank = base * (1 - 1j * t) * np.exp(1j * t) * np.exp(1j * (-half - involute))
    land = flank[-1] * np.exp(1j * np.linspace(0, -np.angle(flank[-1]), 30))
    side = np.concatenate([[0.7 * base * np.exp(1j * (-half - involute))], flank, land])
    cutter = np.concatenate([side, np.conj(side[::-1])])
    cutter = shapely.Polygon(xy(cutter)).buffer(-fillet, quad_segs=90).buffer(fillet, quad_segs=90)
    z = shapely.get_coordinates(cutter.exterior) @ [1, 1j]
    turns = np.linspace(-1.2, 1.2, 900)
    places = [
        shapely.Polygon(xy((distance + z * np.exp(1j * turn)) * np.exp(-1j * turn * tool_teeth / teeth)))
        for turn in turns
    ]
    hole = shapely.union_all(places).union(shapely.Point(0, 0).buffer(tip, quad_segs=3000))
    return hole


def check_gear(drawn, exact, tolerance):
    """Teeth from the table: cut by a rolling tool of its sizes, and compared with the outline of one tooth."""
    words = words_of(drawn)

    def value(name):
        return float(found[1]) if (found := re.search(rf"{name} ({NUMBER})", words)) else 0.0

    teeth = int(value("teeth"))
    root, base, pitch = (value(f"{circle} dia") / 2 for circle in ("root", "base", "pitch"))
    thickness, inner = value("tooth thickness, pitch circle"), "tip dia" in words
    assert base == pytest.approx(pitch * np.cos(np.radians(value("pressure angle"))), abs=0.001)
    assert "tip rounding" not in words and "tip chamfer" not in words
    z = exact * np.exp(1j * (np.pi / 2 - np.radians(value("middle of a tooth, from x"))))
    alpha, fillet = np.radians(value("pressure angle")), value("(?:tip radius|fillet at the root) of the [a-z]+ cutter")
    if inner:
        sizes = teeth, int(value("teeth of the pinion cutter")), alpha, pitch, root, value("tip dia") / 2
        shift = value("profile shift coefficient") - value(rf"teeth of the pinion cutter {NUMBER}, profile shift")
        shaped = shaped_space(*sizes, thickness, fillet, shift)
        # In x direction there is a space, half a pitch from a tooth.
        z = z * np.exp(1j * np.pi * (1 / teeth - 0.5))
        made, own = shaped, z[np.abs(np.angle(z)) < np.pi / teeth]
    else:
        tip = max(diameter(text) for _, text in drawn.diameters) / 2
        made = cut_tooth(teeth, alpha, pitch, tip, root, thickness, fillet)
        own = z[np.abs(np.angle(z / 1j)) < np.pi / teeth]
    assert len(own) > 5 and shapely.distance(shapely.points(xy(own)), made.exterior).max() < tolerance + 2 * ROUNDING


def check_helix(drawn, part):
    """The turn of the teeth over the face, from lead and hand."""
    words = words_of(drawn)
    if part.twist is None:
        assert " lead " not in words
        return
    share = 0.5 if ", herringbone" in words else 1.0
    hand = re.search(r"hand (right|left)", words)[1]
    turn = (
        2
        * np.pi
        * share
        * float(re.search(r", t = ([\d.]+)", words)[1])
        / float(re.search(rf" lead ({NUMBER})", words)[1])
    )
    assert part.twist.turn == pytest.approx(turn if hand == "right" else -turn, rel=1e-4), (share, part.twist)


def check_rack(drawn, entity, exact, tolerance):
    """A rack from the sentence on its teeth, and from the coordinates of its corners below them."""
    words = words_of(drawn)
    sizes = ("teeth", "pitch", "angle", "tip", "depth", r"fillet R", "first tip at x", ", y")
    count, pitch, angle, width, depth, fillet, x, y = (float(re.search(rf"{s} ?({NUMBER})", words)[1]) for s in sizes)
    half = np.array([width / 2, width / 2 + depth * np.tan(np.radians(angle))])
    tooth = np.array([half[0], -half[0], -half[1] - 1j * depth, half[1] - 1j * depth]) + x + 1j * y
    # Below the teeth the contour has coordinates of its own; their roots are on one line.
    (root,) = {z.imag for z, v in drawn.axes["y"] if abs(v - (y - depth)) < SAME}
    below = [edge for edge in edges(entity) if min(edge[0].imag, edge[1].imag) < root - SAME]
    first = next(k for k, edge in enumerate(below) if abs(edge[0] - below[k - 1][1]) > SAME)
    below = [*below[first:], *below[:first]]
    body = rebuilt_contour(drawn, [*below, [below[-1][1], below[0][0], 0.0, None]])
    pieces = [shapely.Polygon(xy(z)) for z in (body, *(tooth + k * pitch for k in range(int(count))))]
    # The fillet rounds the inner corners with the root line.
    made = shapely.union_all(pieces).buffer(fillet, quad_segs=60).buffer(-fillet, quad_segs=60)
    assert apart(made, exact) < tolerance + 2 * ROUNDING


def check(part, recipe):
    drawn, tolerance = Drawn(part, recipe), recipe.files.tolerance
    count, thickness = re.search(rf"{re.escape(part.name)}: (\d+) pieces?, t = ({NUMBER})", words_of(drawn)).groups()
    assert (int(count), float(thickness)) == (part.count, pytest.approx(part.thickness, abs=ROUNDING))
    check_helix(drawn, part)
    exact = [gk.flatten(curve, tolerance / 20) for curve in (part.outline, *part.holes)]
    words = words_of(drawn)
    is_gear = "teeth " in words
    loops, rebuilt = drawn.loops[: len(exact)], []
    for k, (entity, curve) in enumerate(zip(loops, exact)):
        fit = part.fits[k - 1] if 0 < k <= len(part.fits) else None
        if entity.dxftype() == "CIRCLE":
            at = drawn.place(planar(entity.dxf.center))
            near = [text for place, text in drawn.noted.items() if abs(place - at) < SAME]
            size = diameter(near[0] if near else drawn.callout(2 * entity.dxf.radius, drawn.diameters))
            rebuilt.append(at + size / 2 * np.exp(2j * np.pi * np.arange(1000) / 1000))
        elif fit:
            rebuilt.append(slot_or_bore(drawn, entity, fit.travel > 0))
        elif ("profile" in words and k == 0) or len(entity) > 80:
            rebuilt.append(None)
        else:
            turned = k > 0 and re.search(r"opening also turned about the datum by ([\d., ]+) deg", words)
            try:
                rebuilt.append(rebuilt_contour(drawn, edges(entity)))
            except AssertionError:
                # A repeated opening has no numbers of its own.
                assert turned and rebuilt[-1] is not None
                angles = [float(angle) for angle in turned[1].split(",")]
                first = next(
                    z
                    for j, z in enumerate(rebuilt)
                    if j and isinstance(z, np.ndarray) and loops[j].dxftype() != "CIRCLE"
                )
                turns = [first * np.exp(1j * np.radians(angle)) for angle in angles]
                centre = datum_of(part, exact)
                rebuilt.append(min(turns, key=lambda z: apart(z, curve - centre)))
    centre = 0j if is_gear and not part.holes else datum_of(part, exact)
    for k, (made, curve) in enumerate(zip(rebuilt, exact)):
        if made is not None:
            assert apart(made, curve - centre) < tolerance + 2 * ROUNDING, f"loop {k}"
        elif "first tip" in words:
            check_rack(drawn, loops[k], curve - centre, tolerance)
        elif is_gear and "base dia" in words:
            check_gear(drawn, curve - centre, tolerance)
        else:
            check_profile(drawn, curve - centre, tolerance)


def datum_of(part, exact):
    """The datum as the drawing states it: a bore, the centre, or the lower left corner."""
    if isinstance(part.outline, gk.plane.Circle):
        return complex(part.outline.centre)
    if isinstance(part.outline, gk.plane.Moved):
        return complex(part.outline.pose.origin)
    holes = [complex(hole.centre) for hole in part.holes if isinstance(hole, gk.plane.Circle)]
    for hole, fit in zip(part.holes, part.fits):
        if fit and not fit.travel and not isinstance(hole, gk.plane.Circle):
            holes.append(0j)
    low = complex(exact[0].real.min(), exact[0].imag.min())
    return min(holes, key=lambda z: round(abs(z), 6), default=low)


BY_DEFAULT = ["motor-gear", "pressed-gear", "elliptic-trammel"]


@pytest.mark.parametrize("name", by_default([path.stem for path in RECIPES], BY_DEFAULT))
def test_parts_follow_from_the_numbers_of_their_drawing(name):
    recipe = gk.load(RECIPES[0].parent / f"{name}.toml")
    parts = recipe.parts if not hasattr(recipe, "notes") or recipe.parts else ()
    for part in parts:
        check(part, recipe)


@pytest.mark.campaign
def test_a_gear_beside_the_origin_of_its_body_follows_from_its_drawing():
    text = (RECIPES[0].parent / "cartwright.toml").read_text()
    moved = text.replace("{ C = [0, 0], D = [15, 0] }", "{ C = [10, -4], D = [10, 11] }")
    assert moved != text
    for part in (recipe := gk.load(moved)).parts:
        check(part, recipe)

"""STEP files read back entity by entity: closed shells, edges on their surfaces, the volume twice over, few faces."""

import re
from collections import Counter

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.job import Job
from geomkin.export.mesh import solid_cut
from geomkin.export.step import step
from geomkin.export.still import in_place
from geomkin.plane.flatten import flatten
from geomkin.plane.measure import area, length

PARTS = [
    gk.Part("disc", gk.plane.Circle(5 - 3j, 20), (gk.plane.Circle(5, 4),), 2.0),
    gk.Part(
        "bar", gk.plane.rounded_hull([0, 90, 40 + 25j], 8), (gk.plane.slot(0, 20, 2), gk.plane.Circle(90, 2.1)), 3.0
    ),
    gk.Part("gear", gk.SpurGear(8, 2, 0.3).outline, (gk.plane.slot(-2, 2, 1),), 6.0),
    gk.Part("moved", gk.plane.Moved(gk.SpurGear(6, 3).outline, gk.plane.Pose(4 + 3j, 1j)), (), 4.0),
    gk.Part("turned", gk.plane.Reversed(gk.plane.slot(-10, 30j, 6)), (gk.plane.Circle(-10, 2),), 2.0),
    # A hole none of whose edges and arcs are alike.
    gk.Part(
        "uneven",
        gk.plane.Circle(0j, 40.0),
        (gk.plane.Polyline(np.array([-10 - 8j, 14 - 8j, 18 + 9j, -4 + 15j]), np.array([0.4, -0.2, 0.0, 0.3])),),
        3.0,
    ),
]


def turn(a, b, forward):
    """From one direction to another, counterclockwise or clockwise, rad."""
    angle = np.angle(b / a)
    return angle % (2 * np.pi) if forward else -(-angle % (2 * np.pi))


def basis(knots, at):
    """Cubic B-splines at parameters, (parameters, control points), by their recurrence."""
    last = np.searchsorted(knots, knots[-1]) - 1
    spans = np.clip(np.searchsorted(knots, at, side="right") - 1, 3, last)
    values = (spans[:, None] == np.arange(len(knots) - 1)).astype(float)
    for degree in (1, 2, 3):
        n = len(knots) - 1 - degree
        left, right = knots[degree : degree + n] - knots[:n], knots[degree + 1 :][:n] - knots[1 : n + 1]
        rising = np.divide(at[:, None] - knots[:n], left, out=np.zeros((len(at), n)), where=left > 0)
        falling = np.divide(knots[degree + 1 :][:n] - at[:, None], right, out=np.zeros((len(at), n)), where=right > 0)
        values = rising * values[:, :n] + falling * values[:, 1 : n + 1]
    return values


class Solid:
    """What a reader finds: entities by number, each its word and its arguments, and what they lead to."""

    def __init__(self, content: bytes) -> None:
        text = content.decode("ascii")
        data = text[text.index("DATA;") : text.index("ENDSEC;", text.index("DATA;"))]
        rows = re.findall(r"^#(\d+)=([A-Z_0-9]+)\((.*)\);$", data, re.MULTILINE)
        self.entities = {int(number): (word, arguments) for number, word, arguments in rows}

    def all(self, word):
        return [number for number, (found, _) in self.entities.items() if found == word]

    def refers(self, number):
        return [int(n) for n in re.findall(r"#(\d+)", self.entities[number][1])]

    def numbers(self, number):
        return np.array([float(n) for n in re.findall(r"-?\d+\.\d*(?:E-?\d+)?", self.entities[number][1])])

    def yes(self, number):
        return self.entities[number][1].endswith(".T.")

    def frame(self, placement):
        """Origin, axis and first direction."""
        return [self.numbers(n) for n in self.refers(placement)]

    def corner(self, vertex):
        return self.numbers(self.refers(vertex)[0])

    def way(self, oriented):
        """First and last corner of an edge as a face runs along it, and how far it bulges left, seen from above."""
        forward = self.yes(oriented)
        (edge,) = self.refers(oriented)
        first, last, curve = self.refers(edge)
        ends = [self.corner(first), self.corner(last)]
        bow = 0.0
        if self.entities[curve][0].startswith("B_SPLINE"):
            z = self.spline(curve)
            # Rounded to the digits of the file.
            assert abs(z[0] - complex(*ends[0][:2])) < 1e-8 and abs(z[-1] - complex(*ends[1][:2])) < 1e-8
            bow = (np.conj(z[:-1] - z[0]) * (z[1:] - z[0])).imag.sum() / 2
        elif self.entities[curve][0] == "CIRCLE":
            origin, axis, _ = self.frame(self.refers(curve)[0])
            radius = self.numbers(curve)[-1]
            for end in ends:
                assert abs(np.linalg.norm(end - origin) - radius) < 1e-8
            a, b = (complex(*(end - origin)[:2]) for end in ends)
            # Of the segment between chord and arc; a circle runs counterclockwise about its axis.
            sweep = turn(a, b, axis[2] > 0)
            bow = radius**2 * (sweep - np.sin(sweep)) / 2
        else:
            point, vector = self.refers(curve)
            along = self.numbers(self.refers(vector)[0])
            assert abs(np.cross(ends[1] - ends[0], along)).max() < 1e-8 * np.linalg.norm(ends[1] - ends[0]) + 1e-12
            assert (ends[1] - ends[0]) @ along > 0
            assert abs(np.cross(ends[0] - self.numbers(point), along)).max() < 1e-9
        return (*ends, bow) if forward else (*ends[::-1], -bow)

    def spline(self, number):
        """Points of a cubic B-spline, by de Boor's corner cutting."""
        counts, values = re.findall(r"\(([^()]*)\)", self.entities[number][1])[1:]
        knots = np.repeat([float(v) for v in values.split(",")], [int(n) for n in counts.split(",")])
        controls = np.array([complex(*self.numbers(n)[:2]) for n in self.refers(number)])
        points, ends = [], np.unique(knots)
        spans = [np.linspace(a, b, 6, endpoint=b == knots[-1]) for a, b in zip(ends, ends[1:])]
        for t in np.concatenate(spans):
            k = min(int(np.searchsorted(knots, t, side="right")) - 1, len(controls) - 1)
            d = list(controls[k - 3 : k + 1])
            for r in (1, 2, 3):
                share = [(t - knots[j + k - 3]) / (knots[j + 1 + k - r] - knots[j + k - 3]) for j in range(r, 4)]
                d = [d[0]] * r + [(1 - s) * d[j - 1] + s * d[j] for j, s in zip(range(r, 4), share)]
            points.append(d[3])
        return np.array(points)

    def walls(self):
        """Points of all bicubic B-spline surfaces, on their grids of 5 x 5 parameters."""
        found = []
        for number in self.all("B_SPLINE_SURFACE_WITH_KNOTS"):
            rows, counts, other_counts, knots, other_knots = re.match(
                r"'',3,3,\((\(.*?\))\),.*?,\(([^()]*)\),\(([^()]*)\),\(([^()]*)\),\(([^()]*)\)",
                self.entities[number][1],
            ).groups()
            net = np.array([[self.numbers(int(n)) for n in re.findall(r"#(\d+)", row)] for row in rows.split("),(")])
            for grid, (count, values) in enumerate(((counts, knots), (other_counts, other_knots))):
                row = np.repeat([float(v) for v in values.split(",")], [int(n) for n in count.split(",")])
                at = np.linspace(row[0], row[-1], 5)
                net = np.moveaxis(
                    basis(row, at) @ np.moveaxis(net, grid, 0).reshape(net.shape[grid], -1), 0, 0
                ).reshape((5, *np.moveaxis(net, grid, 0).shape[1:]))
                net = np.moveaxis(net, 0, grid)
            found.append(net.reshape(-1, 3))
        return np.concatenate(found)

    def rings(self, face):
        bounds = [n for n in self.refers(face) if self.entities[n][0].endswith("BOUND")]
        loops = [self.refers(bound)[0] for bound in bounds]
        return [[self.way(oriented) for oriented in self.refers(loop)] for loop in loops]

    def surface(self, face):
        """Kind, frame and radius; whether its own normal leads out."""
        number = self.refers(face)[-1]
        if self.entities[number][0] == "SURFACE_OF_LINEAR_EXTRUSION":
            return self.entities[number][0], (self.refers(number)[0], np.zeros(3), None), None, self.yes(face)
        placed = self.frame(self.refers(number)[0])
        return self.entities[number][0], placed, self.numbers(number)[-1:], self.yes(face)


def part_area(part):
    return area(part.outline) - sum(area(hole) for hole in part.holes)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
def test_a_closed_shell_of_the_exact_volume(part):
    exact = part_area(part)
    solid = Solid(step(cut(part, 0.005), 0.005))
    used = Counter()
    for oriented in solid.all("ORIENTED_EDGE"):
        used[solid.refers(oriented)[0], solid.yes(oriented)] += 1
    edges = solid.all("EDGE_CURVE")
    assert set(used) == {(edge, way) for edge in edges for way in (True, False)} and set(used.values()) == {1}
    faces = solid.all("ADVANCED_FACE")
    assert sorted(solid.refers(solid.all("CLOSED_SHELL")[0])) == faces
    # Corners, edges and faces of a plate with holes: each hole is a handle, and adds a ring to both lids.
    holes = len(part.holes)
    rings = sum(len(solid.rings(face)) for face in faces)
    corners = len(solid.all("VERTEX_POINT"))
    assert corners - len(edges) + len(faces) - (rings - len(faces)) == 2 - 2 * holes
    by_lids = by_walls = 0.0
    for face in faces:
        kind, (origin, axis, _), radius, outward = solid.surface(face)
        for ring in solid.rings(face):
            for (_, last, _), (first, _, _) in zip(ring, ring[1:] + ring[:1]):
                assert (last == first).all()
            places = np.array([start for start, _, _ in ring])
            if kind == "PLANE" and abs(axis[2]) == 1:
                assert outward and (places[:, 2] == origin[2]).all()
                z = places[:, 0] + 1j * places[:, 1]
                area = (np.conj(z) * np.roll(z, -1)).imag.sum() / 2 + sum(bow for *_, bow in ring)
                # Round a lid that looks up, the outline runs counterclockwise; round the other, clockwise.
                by_lids += area * origin[2]
                continue
            if kind == "SURFACE_OF_LINEAR_EXTRUSION":
                # Seen from outside, its curve runs to the right, with the material on its left.
                z = solid.spline(origin)
                assert outward and abs(z[0] - complex(*places[0, :2])) < 1e-8
                by_walls += np.ptp(places[:, 2]) * ((z[1:] + z[:-1]).real / 2 * np.diff(z).imag).sum()
                continue
            assert axis[2] == (kind != "PLANE") and len(ring) == 4
            low, height = places[0], np.ptp(places[:, 2])
            if kind == "PLANE":
                assert outward and abs((places - origin) @ axis).max() < 1e-9
                by_walls += places[:, 0].mean() * axis[0] * np.linalg.norm((places[1] - low)[:2]) * height
                # Seen from outside the ring runs counterclockwise.
                assert np.cross(places[1] - low, places[2] - places[1]) @ axis > 0
            else:
                seen = (places - origin)[:, :2] @ [1, 1j]
                assert abs(abs(seen) - radius).max() < 1e-8
                a = np.angle(seen[0])
                t = np.array([a, a + turn(seen[0], seen[1], outward)])
                flux = origin[0] * np.sin(t) + radius[0] * (t / 2 + np.sin(2 * t) / 4)
                by_walls += radius[0] * height * (flux[1] - flux[0])
    has_splines = bool(solid.all("B_SPLINE_CURVE_WITH_KNOTS"))
    # Splines may deviate by a fifth of the tolerance along the outline; chords here are far finer.
    allowed = 0.001 * length(part.outline) * part.thickness if has_splines else 1e-9 * exact * part.thickness
    assert by_lids == pytest.approx(exact * part.thickness, abs=allowed)
    assert by_walls == pytest.approx(by_lids, rel=1e-6)


def twisted(teeth, thickness, *holes, **twist):
    return gk.Part("gear", gk.SpurGear(teeth, 2).outline, holes, thickness, twist=gk.model.part.Twist(**twist))


@pytest.mark.parametrize(
    "twist",
    [{"turn": 0.7}, {"turn": -0.7, "herringbone": True}, {"shift": 5.0}],
    ids=["helical", "herringbone", "sheared"],
)
def test_surfaces_of_twisted_teeth_are_on_the_turned_outline(twist):
    part = (
        twisted(7, 20.0, **twist)
        if "turn" in twist
        else gk.Part("rack", gk.plane.slot(0, 40, 8), (), 20.0, twist=gk.model.part.Twist(**twist))
    )
    content = step(solid_cut(part, 0.005), 0.005)
    walls = Solid(content).walls()
    pose = part.twist.at(walls[:, 2] / 20.0)
    local = (walls[:, 0] + 1j * walls[:, 1] - pose.origin) / pose.direction
    z = flatten(part.outline, 3e-4)
    distances = shapely.distance(
        shapely.LinearRing(np.column_stack([z.real, z.imag])), shapely.points(local.real, local.imag)
    )
    assert len(local) > 30 and distances.max() < 0.001 + 3e-4


def test_few_faces():
    """A face for each tip, flank and root, so four for a tooth; two for a bore and two lids."""
    for teeth in (24,):
        for twist in (None, gk.model.part.Twist(0.3)):
            part = gk.Part("gear", gk.SpurGear(teeth, 2).outline, (gk.plane.Circle(0j, 2.0),), 6.0, twist=twist)
            solid = Solid(step(solid_cut(part, 0.005), 0.005))
            assert len(solid.all("ADVANCED_FACE")) == 4 * teeth + 4
    disc = Solid(step(cut(PARTS[0], 0.005), 0.005))
    assert len(disc.all("ADVANCED_FACE")) == 6 and len(disc.all("CYLINDRICAL_SURFACE")) == 2


def test_arcs_of_a_cam_stay_cylinders():
    recipe = gk.load("recipes/roller-cam.toml")
    cam = next(part for part in recipe.parts if part.name == "cam")
    solid = Solid(step(cut(cam, 0.005), 0.005))
    # Two dwells and the bore; rise and return.
    assert len(solid.all("CYLINDRICAL_SURFACE")) == 3 and len(solid.all("SURFACE_OF_LINEAR_EXTRUSION")) == 2


def test_assembly_has_a_product_for_each_part_and_an_instance_for_each_position(tmp_path):
    recipe = gk.load("recipes/crank-rocker.toml")
    (written,) = gk.write(recipe, tmp_path / "a-assembly.step")
    solid, text = Solid(written.read_bytes()), written.read_text()
    _, placements = in_place(Job("a", recipe, 0.005))
    names = re.findall(r"PRODUCT\('([^']*)'", text)
    assert names[1:] == list(dict.fromkeys(p.name for p in placements if p.part.name == p.name))
    assert len(solid.all("NEXT_ASSEMBLY_USAGE_OCCURRENCE")) == len(placements)
    for number, placement in zip(solid.all("ITEM_DEFINED_TRANSFORMATION"), placements):
        origin, axis, east = solid.frame(solid.refers(number)[1])
        assert origin == pytest.approx([placement.origin.real, placement.origin.imag, placement.height], abs=1e-6)
        assert axis.tolist() == [0, 0, 1] and complex(*east[:2]) == pytest.approx(placement.direction, abs=1e-8)
    assert len(solid.all("STYLED_ITEM")) == len(names) - 1
    # Solids share no faces, so that each product can be edited.
    faces = [n for shell in solid.all("CLOSED_SHELL") for n in solid.refers(shell)]
    assert len(faces) == len(set(faces)) == len(solid.all("ADVANCED_FACE"))

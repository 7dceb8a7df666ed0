"""Every mechanism of the gallery put together from its folder alone: drawing, bill and steps, held against each other."""

from collections import Counter
from itertools import combinations
from pathlib import Path
from string import ascii_uppercase

import numpy as np
import pytest
import shapely
import shapely.affinity

import geomkin as gk
from geomkin.export.text import lettered
from geomkin.plane.primitives import Circle, Polyline
from tests.campaign import by_default
from tests.gear.test_parts_mates import LANTERN
from tests.making.test_bases import PAIR, PLANETARY, RACK
from tests.making.virtual import Piece, engraved, read

RECIPES = Path(__file__).parent.parent.parent / "recipes"
# A motor over a base, for which the gallery has no recipe.
ROLLER_CAM = (RECIPES / "roller-cam.toml").read_text()
DRIVEN = 'bore = 5, bore_form = "D", motor = "nema17"'
OVER = {
    "motor-over-pair": PAIR.replace("bore = 8", DRIVEN) + "[base]\n",
    "motor-over-rack": RACK.replace("bore = 8", DRIVEN) + "[base]\n",
    "motor-over-planetary": PLANETARY.replace("bore = 8", DRIVEN) + "[base]\n",
    "motor-over-cam": ROLLER_CAM.replace("\nbore = 10\n", "\n" + DRIVEN.replace(", ", "\n") + "\n"),
    "motor-over-lantern": f'{LANTERN}stock = {{{DRIVEN}, fit = "press", mate_bore = 12, mate_bore_form = "keyed"}}\n[base]\n',
}
# Recipes of one mechanism, since those of a machine have equal letters and spacers on their own parts; files in mm.
TEXTS = {path.stem: path.read_text() for path in RECIPES.glob("*.toml")}
SINGLE = [
    name
    for name, text in TEXTS.items()
    if not any(x in text for x in ('kind = "machine"', 'units = "in"', 'pins = "snap"'))
]
NAMES = by_default(sorted([*OVER, *SINGLE]), ["gear-pair", "rocker-cam"])


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    found = {}

    def make(name):
        if name not in found:
            out = tmp_path_factory.mktemp("made")
            recipe = RECIPES / f"{name}.toml"
            if name in OVER:
                recipe = out / f"{name}.toml"
                recipe.write_text(OVER[name])
            gk.make(recipe, out, ["dxf", "bom"])
            found[name] = read(out / name)
        return found[name]

    return make


def opened(folder, letter):
    """(piece, number of the opening) of all openings with a letter."""
    return [(piece, k) for piece in folder.pieces for k in piece.lettered.get(letter, ())]


def across(piece, k):
    """Diameter of a hole or width of a slot, mm; of a bore with a keyway its widest circle, nearly."""
    if k < len(piece.holes):
        return piece.holes[k][1]
    slot = piece.slots[k - len(piece.holes)]
    rectangle = np.array(slot.minimum_rotated_rectangle.exterior.coords)
    return float(np.linalg.norm(np.diff(rectangle[:3], axis=0), axis=1).min())


def lines(folder, letter):
    return [(item, count, joints) for item, count, joints in folder.bought if letter in joints]


@pytest.mark.parametrize("name", NAMES)
def test_each_part_is_cut_billed_and_used_as_often(name, made):
    """Outlines of the drawing, known by what is engraved on them, rows of the bill, and what the steps lay."""
    folder = made(name)
    wanted = {part: int(row["count"]) for part, row in folder.cut.items()}
    assert Counter(piece.name for piece in folder.pieces) == wanted
    for part in folder.summary["parts"]:
        sizes = [p.shape.bounds for p in folder.pieces if p.name == part["name"]]
        assert len({(round(d - b, 2), round(c - a, 2)) for a, b, c, d in sizes}) <= 4


@pytest.mark.parametrize("name", NAMES)
def test_letters_of_steps_bill_and_holes_are_the_same(name, made):
    folder = made(name)
    # Printed pins are parts that are cut, with the joints that they make.
    billed = {joint for _, _, joints in folder.bought for joint in joints}
    billed |= {joint for row in folder.cut.values() for joint in row["joints"].split()}
    engraved = {letter for piece in folder.pieces for letter in piece.lettered}
    assert billed - set(folder.cut) == engraved
    # A letter without a partner would join nothing.
    assert all(len({piece.name for piece, _ in opened(folder, letter)}) >= 2 for letter in engraved)
    for pin in folder.summary.get("stack", {}).get("pins", ()):
        # Copies of a linkage on a motor have plates without its holes.
        plates = {piece.name.removeprefix("plain_") for piece, _ in opened(folder, pin["letter"])} - {"counterweight"}
        assert plates == {*pin["holes_in"], *pin["slots_in"]}


@pytest.mark.parametrize("name", NAMES)
def test_plates_of_a_linkage_close_by_their_letters(name, made):
    """Laid so that holes of one letter coincide, and holes over slots lie on their middle lines."""
    folder = made(name)
    if "stack" not in folder.summary:
        pytest.skip("no linkage")
    plates = {}
    for piece in folder.pieces:
        if piece.lettered and piece.name not in plates and piece.name != "counterweight":
            plates[piece.name] = piece
    holes, slots = {}, {}
    for plate, piece in plates.items():
        for letter, numbers in piece.lettered.items():
            for k in numbers:
                if k < len(piece.holes):
                    holes[letter, plate] = piece.holes[k][0]
                elif any("motor" in item for item, *_ in lines(folder, letter)):
                    # More than half of a D-shaft is round.
                    circle = shapely.minimum_bounding_circle(piece.slots[k - len(piece.holes)])
                    holes[letter, plate] = complex(circle.centroid.x, circle.centroid.y)
                else:
                    slots[letter, plate] = middle(piece.slots[k - len(piece.holes)])
    assert closed(list(plates), holes, slots) < 5e-3


def middle(slot):
    """Ends of a slot's middle line."""
    corners = np.array(slot.minimum_rotated_rectangle.exterior.coords) @ [1, 1j]
    sides = sorted([(corners[0], corners[1]), (corners[1], corners[2])], key=lambda ends: abs(ends[1] - ends[0]))
    (a, b), wide = sides[1], abs(sides[0][1] - sides[0][0])
    across = (sides[0][1] - sides[0][0]) / 2 * (1 if sides[0][0] in (a, b) else -1)
    along = (b - a) / abs(b - a) * wide / 2
    centre = corners[:4].mean()
    half = (b - a) / 2 - along
    assert abs(across) > 0
    return centre - half, centre + half


def closed(names, holes, slots):
    """Largest distance, mm, of what should coincide, in the best of some attempts to lay the plates by Gauss-Newton."""

    def off(x):
        z = {n: (x[3 * k] + 1j * x[3 * k + 1], np.exp(1j * x[3 * k + 2])) for k, n in enumerate(names)}
        at = {key: z[key[1]][0] + z[key[1]][1] * place for key, place in holes.items()}
        found = []
        for one, two in combinations(at, 2):
            if one[0] == two[0]:
                gap = at[one] - at[two]
                found += [gap.real, gap.imag]
        for (letter, plate), ends in slots.items():
            a, b = (z[plate][0] + z[plate][1] * end for end in ends)
            for key, place in at.items():
                if key[0] == letter:
                    u = (b - a) / abs(b - a)
                    along = ((place - a) * np.conj(u)).real
                    beyond = max(0.0, -along, along - abs(b - a))
                    found += [((place - a) * np.conj(u)).imag, max(0.0, beyond - 1e-3)]
        return np.array(found)

    random = np.random.default_rng(1)
    size = max(abs(place) for place in holes.values())
    best = np.inf
    for _ in range(40):
        x = random.normal(size=3 * len(names)) * np.tile([size / 4, size / 4, 3], len(names))
        damping, f = 1.0, off(x)
        for _ in range(60):
            slope = np.array([(off(x + step) - f) / 1e-6 for step in 1e-6 * np.eye(len(x))]).T
            move = np.linalg.solve(slope.T @ slope + damping * np.eye(len(x)), -slope.T @ f)
            trial = off(x + move)
            if trial @ trial < f @ f:
                x, f, damping = x + move, trial, damping / 5
            else:
                damping *= 4
            if abs(f).max() < 1e-4 or damping > 1e12:
                break
        best = min(best, float(abs(f).max()))
        if best < 5e-3:
            break
    return best


DISTANCES = {
    "gear-pair": [("base", "A", "B", lambda s: s["pair"]["centre_distance_mm"])],
    "planetary": [("carrier", "A", "C", lambda s: s["sun_and_planet"]["centre_distance_mm"])],
    "rocker-cam": [
        ("base", "A", "B", lambda s: s["recipe"]["cam"]["follower"]["pivot_distance"]),
        ("arm", "B", "C", lambda s: s["recipe"]["cam"]["follower"]["arm_length"]),
    ],
}


@pytest.mark.parametrize("name", by_default(DISTANCES, DISTANCES.keys() - {"planetary"}))
def test_lettered_holes_are_as_far_apart_as_the_mechanism_works(name, made):
    folder = made(name)
    for part, one, two, wanted in DISTANCES[name]:
        (piece,) = [piece for piece in folder.pieces if piece.name == part]
        ((a, *_), others) = (([piece.holes[k][0] for k in piece.lettered[letter]]) for letter in (one, two))
        assert [abs(a - b) for b in others] == pytest.approx([wanted(folder.summary)] * len(others), abs=2e-3)
    if name == "planetary":
        # The ring's letter is at one of its screws; all six holes of that size lie as those of the base.
        patterns = []
        for part in ("base", "ring"):
            (piece,) = [piece for piece in folder.pieces if piece.name == part]
            size = piece.holes[piece.lettered["B"][0]][1]
            around = [z for z, d in piece.holes if abs(d - size) < 1e-6]
            middle_of = complex(*shapely.centroid(piece.shape).coords[0])
            ring = [z for z in around if abs(abs(z - middle_of) - 68.5) < 2]
            patterns.append(sorted(abs(a - b) for a, b in combinations(ring, 2)))
        assert len(patterns[0]) == 15 and patterns[0] == pytest.approx(patterns[1], abs=2e-3)


@pytest.mark.parametrize("names", [ascii_uppercase[:13], [*ascii_uppercase[13:], "MN"]], ids=["A to M", "N to Z"])
def test_every_letter_at_a_hole_is_read_as_itself(names):
    """A linkage of 14 pins has an N; a pair of letters is at a slot of two pins."""
    plate, hole = Polyline(np.array([-8 - 8j, 8 - 8j, 8 + 8j, -8 + 8j])), (Circle(0j, 2.0),)
    for name in names:
        _, strokes = lettered(gk.Part("x", plate, hole, 3.0, hole_names=(name,)), 1)
        (title,) = engraved(list(strokes), "x")
        left = [line for line in strokes if not any(line is one for one in title)]
        assert Piece(shapely.box(-8, -8, 8, 8), [(0j, 4.0)], strokes=left).lettered == {letter: [0] for letter in name}

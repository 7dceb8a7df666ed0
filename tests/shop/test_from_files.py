"""Every mechanism of the gallery put together from its folder alone: drawing, bill and steps, held against each other."""

import re
from collections import Counter
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity

import geomkin as gk
from tests.shop.virtual import read

from .test_bases import PAIR, PLANETARY, RACK
from .test_mated import LANTERN

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
MOTORS = [*OVER, "motor-crank"]
QUICK = [
    "gear-pair",
    "planetary",
    "rocker-cam",
    "scotch-yoke",
    "walker",
    "shaking-force",
    "motor-gear",
    "lantern",
    "motor-crank",
]
NAMES = [
    name if name in (*QUICK, *OVER) else pytest.param(name, marks=pytest.mark.campaign)
    for name in sorted([*OVER, *(path.stem for path in RECIPES.glob("*.toml"))])
]
# Widths of set collars by DIN 705 A for shafts of these diameters, mm.
COLLARS = {3: 5, 4: 5, 5: 6, 6: 8, 8: 8, 10: 10, 12: 12, 20: 14}
# How a bill tells the flat of a D-shaft, mm.
FLAT = r"D-shaft [\d.]+ mm, ([\d.]+) mm across its flat"
# What else a bill may name, by a word that the steps have for it.
WORDS = {"shaft collar": "collar", "key": "key", "tube": "tube", "motor": "motor", "nut": "nut", "washer": "nut"}


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


def clauses(folder):
    """(layer, or None for what comes last, and one thing to do)."""
    for step in folder.steps:
        head = re.match(r"layer (\d+): ", step)
        for clause in step[head.end() if head else 0 :].split("; "):
            yield int(head[1]) if head else None, clause


def copies(folder):
    return next((int(told[1]) for step in folder.steps if (told := re.match(r"(\d+) of these", step))), 1)


def marks(text):
    return re.findall(r"(?<![\w-])[A-Z](?![\w-])", text)


def used(folder):
    """How often the steps put each part in its place."""
    names, found = sorted(folder.cut, key=len, reverse=True), Counter()
    begin = r"(?:lay|press|screw(?= motor_plate)|glue(?= counterweight)|glue \d+ pins into the first|glue the second) "
    for _, clause in clauses(folder):
        if told := re.match(r"a spacer on (.*)", clause):
            found["spacer"] += len(told[1].split(", "))
        elif told := re.match(r"(\w+) is (?:a drawing, )?joined to nothing", clause):
            found[told[1]] += 1
        elif told := re.match(begin + r"(?:(\d+) x )?(.*)", clause):
            rest, each = told[2], int(told[1] or 1)
            while name := next((one for one in names if re.match(rf"{re.escape(one)}\b", rest)), None):
                found[name] += each
                rest = rest[len(name) + 2 :] if rest[len(name) :].startswith(", ") else ""
    return {name: count * (copies(folder) if "drawing" not in name else 1) for name, count in found.items()}


def thick(folder, name):
    return float(folder.cut[name]["thickness_mm"])


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


def diameter(item):
    told = re.match(r"(?:D-shaft|shaft|pin|rod|screw|motor .* D-shaft) ([\d.]+) mm|M([\d.]+) (?:x|threaded)", item)
    return float(told[1] or told[2]) if told else None


def lines(folder, letter):
    return [(item, count, joints) for item, count, joints in folder.bought if letter in joints]


def only(found):
    (one,) = found
    return one


def disc(middle, wide):
    return shapely.Point(middle.real, middle.imag).buffer(wide / 2)


def fixed(folder):
    """(plate, letter) of each motor under a plate that others turn on."""
    told = (
        re.match(r"fix the motor under (\w+), its shaft up through ([A-Z]),", clause) for _, clause in clauses(folder)
    )
    return [one.groups() for one in told if one]


def length(item):
    told = re.search(r"at least ([\d.]+) mm long|cut to ([\d.]+) mm|M[\d.]+ x ([\d.]+)", item)
    return float(next(filter(None, told.groups()))) if told else None


@pytest.mark.parametrize("name", NAMES)
def test_each_part_is_cut_billed_and_used_as_often(name, made):
    """Outlines of the drawing, known by what is engraved on them, rows of the bill, and what the steps lay."""
    folder = made(name)
    wanted = {part: int(row["count"]) for part, row in folder.cut.items()}
    assert Counter(piece.name for piece in folder.pieces) == wanted
    if folder.steps:
        assert used(folder) == wanted
    else:
        assert not folder.bought
    for part in folder.summary["parts"]:
        sizes = [p.shape.bounds for p in folder.pieces if p.name == part["name"]]
        assert len({(round(d - b, 2), round(c - a, 2)) for a, b, c, d in sizes}) <= 4


@pytest.mark.parametrize("name", NAMES)
def test_letters_of_steps_bill_and_holes_are_the_same(name, made):
    folder = made(name)
    told = {letter for step in folder.steps for letter in marks(step)}
    billed = {joint for _, _, joints in folder.bought for joint in joints}
    engraved = {letter for piece in folder.pieces for letter in piece.lettered}
    assert told == {joint for joint in billed if joint not in folder.cut} == engraved
    # Whatever is not a letter is a part; and a letter without a partner would join nothing.
    assert billed - told <= set(folder.cut)
    assert all(len({piece.name for piece, _ in opened(folder, letter)}) >= 2 for letter in engraved)
    for pin in folder.summary.get("stack", {}).get("pins", ()):
        plates = {piece.name for piece, _ in opened(folder, pin["letter"])} - {"counterweight"}
        assert plates == {*pin["holes_in"], *pin["slots_in"]}


@pytest.mark.parametrize("name", NAMES)
def test_what_is_bought_is_in_the_steps_and_fits_its_holes(name, made):
    """Every opening of a letter is as wide as its pin and a clearance; pressed on, a tenth of a mm less."""
    folder, words = made(name), " ".join(made(name).steps)
    for item, _, _ in folder.bought:
        assert (
            all(word in words for kind, word in WORDS.items() if re.match(rf".*\b{kind}\b", item)) or "close" in words
        )
    for letter in {letter for piece in folder.pieces for letter in piece.lettered}:
        sizes = {d for item, _, _ in lines(folder, letter) if (d := diameter(item)) is not None}
        sizes -= {3.0} if any("motor" in item for item, *_ in lines(folder, letter)) else set()
        assert len(sizes) == 1
        flats = [float(told[1]) for item, *_ in lines(folder, letter) if (told := re.search(FLAT, item))]
        for piece, k in opened(folder, letter):
            if (piece.name, letter) in fixed(folder):
                continue
            (wide,) = flats if flats and k >= len(piece.holes) else sizes
            assert -0.11 <= across(piece, k) - wide <= 0.45 or f"{piece.name} on {letter} with its key" in words
    collars = Counter()
    for _, clause in clauses(folder):
        if told := re.match(r"(a|\d+) collars? on (?:the shaft of )?(\w+)( at either end)?", clause):
            collars[told[2]] += (1 if told[1] == "a" else int(told[1])) * (2 if told[3] else 1)
    billed = sum(count for item, count, _ in folder.bought if "collar" in item)
    assert sum(collars.values()) == billed
    assert sum(count for item, count, _ in folder.bought if item.startswith("tube")) == sum(
        4 if "under each" in clause else 1 for _, clause in clauses(folder) if "tube of" in clause
    )


@pytest.mark.parametrize("name", MOTORS)
def test_a_motor_is_bought_once_and_fixed_before_what_turns_on_it(name, made):
    """Its shaft, for which nothing else is bought, is as long as plates and gaps; one part has the flat's bore."""
    folder = made(name)
    ((plate, letter),) = fixed(folder)
    (motor, *_), (screws, *_) = lines(folder, letter)
    assert [count for item, count, _ in folder.bought if item in (motor, screws)] == [1, 4]
    assert motor.startswith("motor NEMA 17") and re.fullmatch(r"M3 x \d+ countersunk screw ISO 7046", screws)
    done = list(clauses(folder))
    at = next(k for k, (_, clause) in enumerate(done) if clause.startswith("fix the motor"))
    assert done[at - 1] == (0, f"lay {plate}") and done[at][0] == 0 and "by its 4 countersunk screws" in done[at][1]
    later = [(layer, clause) for layer, clause in done[at + 1 :] if letter in marks(clause)]
    wheel = next(clause for _, clause in later if "flat on flat" in clause)
    turning = only({one.name for one, k in opened(folder, letter) if k >= len(one.holes)})
    assert all(layer > 0 for layer, _ in later)
    assert re.match(rf"(lay|press|fix) {'it' if turning == 'disc' else turning} on ", wheel)
    gaps = sum(float(told) for _, clause in done for told in re.findall(r"([\d.]+) mm (?:above|over) ", clause))
    assert length(motor) == sum(thick(folder, one.name) for one, _ in opened(folder, letter)) + gaps


@pytest.mark.parametrize("name", MOTORS)
def test_a_motor_s_plate_has_its_face_and_holds_nothing_under_which_it_lies(name, made):
    """Collars, twice as wide as what they are on and at least 8 mm, and screws' heads and nuts are clear of it."""
    folder = made(name)
    ((plate, letter),) = fixed(folder)
    (piece,) = folder.of(plate)
    shaft = only(piece.lettered[letter])
    boss, wide = piece.holes[shaft]
    screws = [k for k, (_, size) in enumerate(piece.holes) if abs(size - 3.4) < 1e-6]
    places = np.array([piece.holes[k][0] for k in screws])
    assert wide == pytest.approx(22, abs=0.21) and abs(places - boss) == pytest.approx([43.84 / 2] * 4, abs=5e-3)
    across_corners = places - boss
    face = shapely.Polygon(np.column_stack([across_corners.real, across_corners.imag])).convex_hull
    face = shapely.affinity.translate(shapely.affinity.scale(face, 42.3 / 31, 42.3 / 31), boss.real, boss.imag)
    letters = {k: other for other, numbers in piece.lettered.items() for k in numbers}
    for k in set(range(len(piece.holes) + len(piece.slots))) - {shaft, *screws}:
        named = lines(folder, letters[k]) if k in letters else []
        held = [diameter(item) for item, *_ in named if re.match(r"(shaft|pin) \d", item)]
        opening = piece.slots[k - len(piece.holes)] if k >= len(piece.holes) else disc(*piece.holes[k])
        assert face.distance(opening) >= max([4.0, *held]) - across(piece, k) / 2 - 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_what_goes_through_a_linkage_is_as_long_as_all_that_is_on_it(name, made):
    """By the steps: in each layer between a pin's ends there is a plate with its letter or a spacer, but where told."""
    folder = made(name)
    if "stack" not in folder.summary:
        pytest.skip("no linkage")
    first, last, on = {}, {}, Counter()
    sheet = thick(folder, next(iter(folder.cut)))
    for layer, clause in clauses(folder):
        if layer is None:
            continue
        letters = marks(clause)
        if clause.startswith("put") and "from below" in clause:
            first |= dict.fromkeys(letters, layer)
        elif clause.startswith("put"):
            first |= dict.fromkeys(letters, 0)
            last |= dict.fromkeys(letters, layer)
        elif clause.startswith("close"):
            last |= dict.fromkeys(letters, layer)
        elif clause.startswith(("a spacer", "nothing")):
            on.update(letters)
    laid = {}
    for layer, clause in clauses(folder):
        if clause.startswith("lay"):
            laid |= dict.fromkeys(clause[4:].split(", "), layer)
    assert set(first) == set(last)
    # Elsewhere a spacer keeps plates apart in every layer.
    assert name == "cognates" or not any(clause.startswith("nothing") for _, clause in clauses(folder))
    for letter in first:
        plates = {piece.name for piece, _ in opened(folder, letter)} - {"counterweight"}
        layers = [laid[plate] for plate in plates]
        assert (min(layers), max(layers)) == (first[letter], last[letter])
        assert len(set(layers)) + on[letter] == last[letter] - first[letter] + 1
        grip = (last[letter] - first[letter] + 1) * sheet
        for item, _, _ in lines(folder, letter):
            if length(item) and " x " in item:
                # A nut by ISO 4032 is 0.8 of its thread high, a lock nut somewhat more.
                assert grip + 0.8 * diameter(item) < length(item) <= grip + 3 * diameter(item) + 6
            elif length(item):
                assert length(item) >= grip


@pytest.mark.parametrize("name", NAMES)
def test_shafts_of_gears_and_cams_pass_all_that_is_on_them(name, made):
    """Plates with the letter, tubes that keep them apart, and a collar at each end where there is one."""
    folder = made(name)
    if "stack" in folder.summary or not folder.bought:
        pytest.skip("a linkage, or nothing is bought")
    for letter in {letter for piece in folder.pieces for letter in piece.lettered}:
        bought = lines(folder, letter)
        if any("motor" in item or "screw" in item for item, *_ in bought):
            continue
        ((item, count),) = [
            (item, n) for item, n, _ in bought if length(item) and "tube" not in item and "key" not in item
        ]
        sheets = sum(thick(folder, part) for part in {piece.name for piece, _ in opened(folder, letter)})
        tubes = sum(length(item) * n for item, n, _ in bought if "tube" in item)
        shared = [one for one in bought if "collar" in one[0]]
        collars = sum(n * COLLARS[int(diameter(item))] / len(joints) for _, n, joints in shared) / count
        assert sheets + tubes + collars <= length(item) <= sheets + tubes + collars + 2 * 20


@pytest.mark.parametrize("name", NAMES)
def test_collars_over_and_under_a_base_do_not_meet(name, made):
    """By DIN 705 A they are at most twice as wide as their shafts, and 8 mm on thinner ones than 4 mm."""
    folder = made(name)
    bases = folder.of("base")
    for base in bases:
        wide = {}
        for letter, numbers in base.lettered.items():
            held = [diameter(item) for item, _, _ in lines(folder, letter) if re.match(r"(shaft|pin) \d", item)]
            wide |= {base.holes[k][0]: max(2 * held[0], 8.0) for k in numbers if held and k < len(base.holes)}
        assert all(abs(a - b) > (wide[a] + wide[b]) / 2 for a, b in combinations(wide, 2))
    if not bases:
        pytest.skip("no base")


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


@pytest.mark.parametrize("name", DISTANCES)
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

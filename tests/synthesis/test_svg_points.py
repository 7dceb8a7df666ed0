"""Paths of SVG drawings said in several ways are the same points; arcs lie on their ellipses."""

import itertools

import numpy as np
import pytest

import geomkin as gk

points_of = gk.synthesis.svg_path_points
COUNT = 97


def alike(*texts, near=1e-9):
    """All texts give the same points."""
    (first, closed), *others = (points_of(text, COUNT) for text in texts)
    for points, shut in others:
        assert shut is closed and np.abs(points - first).max() < near
    return first


def pair(z):
    z = complex(z)
    return f"{z.real!r} {z.imag!r}"


def reported(command, here, *places):
    """One command with absolute places, and the same with places seen from where it begins."""
    absolute = " ".join(pair(place) for place in places)
    return f"{command} {absolute} ", f"{command.lower()} {' '.join(pair(place - here) for place in places)} "


@pytest.mark.parametrize("seed", range(2))
def test_relative_and_absolute_commands_give_the_same_points(seed):
    rng = np.random.default_rng(seed)
    place = lambda: complex(*np.round(rng.uniform(-50, 50, 2), 3))  # noqa: E731
    here = place()
    texts = [f"M {pair(here)} "] * 3
    before, handle = "", here
    for command in rng.permutation(list("LCSSQTTHVCLSQLT")):
        if command in "HV":
            end = complex(place().real, here.imag) if command == "H" else complex(here.real, place().imag)
            far, near = (end.real, end.real - here.real) if command == "H" else (end.imag, end.imag - here.imag)
            words = f"{command}{far!r} ", f"{command.lower()}{near!r} ", reported("L", here, end)[0]
            next_handle = end
        else:
            places = [place() for _ in range({"L": 1, "C": 3, "S": 2, "Q": 2, "T": 1}[command])]
            # A smooth one takes up the handle of its like, mirrored at the place; after any other its own is there.
            mirrored = 2 * here - handle if before and before in {"S": "CS", "T": "QT"}.get(command, "") else here
            full = [mirrored, *places] if command in "ST" else places
            if command in "QT":
                corner, end = full
                next_handle, full = corner, [here + (corner - here) * 2 / 3, end + (corner - end) * 2 / 3, end]
            elif command in "CS":
                next_handle = full[1]
            else:
                next_handle, full = full[0], [here + (full[0] - here) / 3, here + (full[0] - here) * 2 / 3, full[0]]
            words = (
                *reported(command, here, *places),
                reported("L" if command == "L" else "C", here, *(full[-1:] if command == "L" else full))[0],
            )
            end = places[-1]
        texts = [text + word for text, word in zip(texts, words, strict=True)]
        here, handle, before = end, next_handle, command
    alike(*texts)
    assert points_of(texts[0] + "Z", COUNT)[1] and not points_of(texts[0], COUNT)[1]
    # A start in lower case is the same first place.
    alike(texts[0], "m" + texts[0][1:])


@pytest.mark.parametrize("smooth", ["S 9 -3 12 0", "T 12 0"])
@pytest.mark.parametrize("before", ["H 5", "Q 2 2 5 1", "C 1 1 3 2 5 1"])
def test_a_smooth_curve_takes_up_the_handle_of_its_own_kind_alone(before, smooth):
    takes = before[0] + smooth[0] in ("QT", "CS")
    end = 5 + (0 if before[0] == "H" else 1j)
    handle = 2 * end - (2 + 2j if before[0] == "Q" else 3 + 2j) if takes else end
    word = "C" if smooth[0] == "S" else "Q"
    alike(f"M 0 0 {before} {smooth}", f"M 0 0 {before} {word} {pair(handle)} {smooth[2:]}")


def test_numbers_go_on_without_their_command_and_as_close_as_the_grammar_lets_them():
    alike(
        "M 1 2 3 4 L 5 -6",
        "M1,2 3,4 5-6",
        "M 1 2 L 3 4 5 -6",
        "M1 2L3 4L5-6",
        "m 1 2 2 2 2 -10",
        " M+1e0,.2e1\tL3.\n4\r5-6 ",
    )
    alike("M 0 0 H 3 5 V 2 7", "M 0 0 H 3 H 5 V 2 V 7", "m 0 0 h 3 2 v 2 5")
    alike("M 0 0 C 1 1 2 1 3 0 4 -1 5 -1 6 3", "M0 0C1 1 2 1 3 0C4-1 5-1 6 3", "m0 0c1 1 2 1 3 0 1-1 2-1 3 3")
    alike("M 0 0 Q 1 1 3 0 T 6 1 8 8", "M 0 0 Q 1 1 3 0 T 6 1 T 8 8")
    alike("M.5.5.7.9 1.5.5", "M 0.5 0.5 L 0.7 0.9 L 1.5 0.5")
    alike("M 0 0 A 5 5 0 0 1 5 5 5 5 0 0 1 0 10", "M0 0A5 5 0 015 5A5 5 0 01 0 10")


ARCS = list(itertools.product((0, 1), (0, 1), (35.0,)))


@pytest.mark.parametrize(("large", "sweep", "turn"), ARCS)
def test_flags_select_one_of_four_arcs(large, sweep, turn):
    """In the frame of its half axes it is an arc of the unit circle: from end to end, the flagged way about."""
    wide, high, start, end = 8.0, 5.0, 1 + 2j, 7 - 1j
    points, closed = points_of(f"M {pair(start)} A {wide} {high} {turn} {large} {sweep} {pair(end)}", 1000)
    assert not closed and points[[0, -1]] == pytest.approx(np.conj([start, end]))
    seen = np.conj(points) * np.exp(-1j * np.radians(turn))
    flat = seen.real / wide + 1j * seen.imag / high
    # The circle through three of them is the unit circle.
    one, two, three = flat[[0, 300, -1]]
    shifted, other = two - one, three - one
    middle = one + np.linalg.solve(
        [[shifted.real, shifted.imag], [other.real, other.imag]], [abs(shifted) ** 2 / 2, abs(other) ** 2 / 2]
    ) @ [1, 1j]
    assert np.abs(flat - middle) == pytest.approx(np.ones(1000), abs=3e-3)
    steps = np.diff(np.unwrap(np.angle(flat - middle)))
    # y goes down in SVG: a sweep of 1 is the way of rising angles there.
    assert (np.sign(steps) == (1 if sweep else -1)).all() and bool(abs(steps.sum()) > np.pi) is bool(large)
    way = np.abs(np.diff(points))
    assert way.max() < 1.02 * way.min()


@pytest.mark.parametrize(("turn", "sweep"), [(0, 1), (50, 0)])
def test_an_arc_too_small_for_its_ends_is_half_of_an_enlarged_one(turn, sweep):
    end = 20 * np.exp(1j * np.radians(turn))
    small, large = (points_of(f"M 0 0 A {a} {b} {turn} 0 {sweep} {pair(end)}", 301)[0] for a, b in ((2, 1), (10, 5)))
    assert np.abs(small - large).max() < 1e-5
    seen = np.conj(small) * np.exp(-1j * np.radians(turn)) - 10
    assert (seen.real / 10) ** 2 + (seen.imag / 5) ** 2 == pytest.approx(np.ones(301), abs=2e-3)
    assert bool(seen.imag[150] < 0) is bool(sweep) and abs(seen.imag[150]) == pytest.approx(5, abs=1e-2)
    # The signs of radii say nothing.
    alike(f"M 0 0 A 12 -7 {turn} 0 {sweep} {pair(end)}", f"M 0 0 A -12 7 {turn} 0 {sweep} {pair(end)}")


def test_a_run_that_comes_back_is_closed_and_later_ones_are_left_out():
    square = "M 0 0 L 10 0 L 10 10 L 0 10"
    points = alike(square + " Z", square + " L 0 0", square + " z M 50 50 L 60 60", square + " L 1e-6 0", near=1e-5)
    assert len(np.unique(np.round(points, 6))) == COUNT
    assert not points_of(square + " L 1e-4 0")[1] and not points_of("M 0 0 L 1 0 L 0 0")[1]
    alike(square, square + " M 3 3 L 4 4", square + " m 3 3")
    assert not points_of(square)[1] and points_of(square, 4)[0] == pytest.approx([0, 10, 10 - 10j, -10j])


@pytest.mark.parametrize(
    "text",
    ["M 0 0 L 10", "M 0 0 L 1 2 C 1 2 3 x", "M 0 0 A 1 1 0 2 0 3 3", "M 0 0 L 1 1 X 3", "L 1 1", "M 0 0 L 2e9 0",
     "M 9e8 0 l 9e8 0", "M 3 3 L 3 3"],
)  # fmt: skip
def test_invalid_text_is_refused(text):
    with pytest.raises(gk.DesignError) as refusal:
        points_of(text)
    assert refusal.value.field == "path" and refusal.value.remedy

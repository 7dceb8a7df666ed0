"""Places of guide pins: the nearest that leave room, against all that there are, by distances of shapely."""

import numpy as np
import pytest
import shapely

from geomkin.linkage.parts.plates import guide_places

WIDTH = 10.0
# Places are a quarter of the width apart.
STEP = WIDTH / 4


def drawn(ends):
    """A hole's middle, or the middle line of a slot."""
    z = [(complex(end).real, complex(end).imag) for end in ends]
    return shapely.Point(z[0]) if len(z) == 1 else shapely.LineString(z)


def puzzle(seed):
    """A slide, and openings of plate and guide about it."""
    random = np.random.default_rng(seed)

    def openings(count, about, along):
        for _ in range(count):
            place = about + along * complex(random.uniform(-45, 45), random.uniform(-14, 14))
            long = along * random.uniform(5, 25) if random.random() < 0.4 else None
            yield [place] if long is None else [place, place + long]

    ahead, direction = np.exp(1j * random.uniform(0, 2 * np.pi, 2))
    point, start = (complex(*random.uniform(-20, 20, 2)) for _ in range(2))
    travel = start, start + ahead * random.choice([0.0, 12.0, 31.0, 55.0])
    taken, taken_on_guide = (
        list(openings(seed % n, *about)) for n, about in ((4, (point, direction)), (3, (start, ahead)))
    )
    return travel, complex(ahead), point, complex(direction), taken, taken_on_guide


@pytest.mark.parametrize("seed", range(4))
def test_guide_pins_stand_as_near_as_any_two_that_leave_room(seed):
    travel, ahead, point, direction, taken, on_guide = puzzle(seed)
    (start, end), length = travel, abs(travel[1] - travel[0])
    places, slots = guide_places(WIDTH, travel, ahead, point, direction, taken, on_guide)
    offsets = sorted(float(((place - point) / direction).real) for place in places)
    assert all(abs(place - point - offset * direction) < 1e-9 for place, offset in zip(places, offsets))

    def clear(shapes, openings):
        """Whether shapes keep a bar's width from all openings; rounding does not choose."""
        apart = [shapely.distance(shapes, drawn(opening)) >= WIDTH * (1 - 1e-8) for opening in openings]
        return np.all(apart, axis=0) if apart else np.ones(len(shapes), dtype=bool)

    reach = 160.0
    grid = STEP * np.arange(-int(reach / STEP), int(reach / STEP) + 1)
    z = point + grid * direction
    grid = grid[clear(shapely.points(z.real, z.imag), taken)]
    one, two = (grid[k] for k in np.triu_indices(len(grid), 1))
    near = np.maximum(abs(one), abs(two))
    # Those no farther than what was found, of two that are apart.
    kept = (two - one >= 2 * WIDTH) & (near <= max(abs(offsets[0]), abs(offsets[1])) + 1e-9)
    one, two, near = one[kept], two[kept], near[kept]
    shared = two - one - length < WIDTH
    ends = [
        (start + one * ahead, np.where(shared, end + two * ahead, end + one * ahead)),
        (np.where(shared, start + one * ahead, start + two * ahead), end + two * ahead),
    ]
    free = np.ones(len(one), dtype=bool)
    for a, b in ends:
        lines = shapely.linestrings(np.stack([np.stack([a.real, a.imag], 1), np.stack([b.real, b.imag], 1)], axis=1))
        free &= clear(lines, on_guide)
    best = min((n, t - o, abs(o + t), o) for n, o, t in zip(near[free], one[free], two[free]))
    assert (best[3], best[3] + best[1]) == pytest.approx(tuple(offsets), abs=1e-9)
    # Each pin's slot is its whole way, or both have one for both.
    ways = [(start + offset * ahead, end + offset * ahead) for offset in offsets]
    together = offsets[1] - offsets[0] - length < WIDTH
    wanted = [(ways[0][0], ways[1][1])] * 2 if together else ways
    assert np.array(slots) == pytest.approx(np.array(wanted), abs=1e-9)

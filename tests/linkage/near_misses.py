"""Six-bars whose output dyad comes near to being in line and is not, and their motion by brute force."""

import numpy as np

import geomkin as gk


def near_misses(count, seed):
    """(six-bar, drive of the near miss, relative gap) at random: the gap from 1e-2 to 1e-11, stretched or folded."""
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        crank, coupler, rocker = rng.uniform(15, 35), rng.uniform(60, 110), rng.uniform(50, 100)
        ground = rng.uniform(60, 120)
        ordered = sorted((crank, coupler, rocker, ground))
        if crank != ordered[0] or ordered[0] + ordered[3] > 0.97 * (ordered[1] + ordered[2]):
            continue
        four_bar = gk.FourBar(ground, crank, coupler, rocker, complex(*rng.uniform(-80, 80, 2)))
        pivot = complex(*rng.uniform(-150, 150, 2))

        def distance(q, four_bar=four_bar, pivot=pivot):
            return np.abs(path(four_bar, q) - pivot)

        look = np.linspace(0, 2 * np.pi, 1441)
        s, gap, stretched = distance(look), 10.0 ** -rng.uniform(2, 11), rng.random() < 0.5
        if s.min() < 0.2 * s.max():
            continue
        middle = look[(s if stretched else -s).argmax()]
        for width in 0.01 * 0.2 ** np.arange(12):
            near = middle + width * np.linspace(-1, 1, 41)
            middle = near[(distance(near) if stretched else -distance(near)).argmax()]
        extreme = float(distance(np.array([middle]))[0])
        if stretched:
            both, apart = extreme * (1 + gap), s.min() * rng.uniform(-0.8, 0.8)
        else:
            both, apart = s.max() * rng.uniform(1.2, 2), extreme * (1 - gap) * rng.choice([-1, 1])
        six_bar = gk.StephensonSixBar(four_bar, (both + apart) / 2, (both - apart) / 2, pivot)
        found.append((six_bar, float(middle), gap))
    return found


def path(four_bar, q, side=1):
    """The coupler point by two circles that meet."""
    pin = four_bar.crank * np.exp(1j * q)
    other = meet(pin, four_bar.coupler, four_bar.ground, four_bar.rocker)[0 if side == 1 else 1]
    return pin + (other - pin) / four_bar.coupler * four_bar.coupler_point


def meet(one, b, two, c):
    """Where circles about two points meet: left of the way from the first to the second, and right of it."""
    w = two - one
    along = (abs(w) ** 2 + b**2 - c**2) / (2 * abs(w))
    height = np.sqrt(np.maximum(b**2 - along**2, 0))
    return [one + w / abs(w) * (along + side * 1j * height) for side in (1, -1)]


def by_brute_force(six_bar, middle, gap, side=1):
    """Drives over a turn about a near miss, and the output pin there: of both places the one nearer to the pin before.

    That is right where a step is small against the distance of the branches: the steps shrink towards the near miss.
    """
    beside = np.geomspace(1e-3 * np.sqrt(gap), np.pi, 3000)
    q = middle + np.concatenate([-beside[::-1], beside])
    places = np.array(meet(path(six_bar.four_bar, q), six_bar.link, six_bar.output_pivot, six_bar.output))
    track = np.empty(len(q), dtype=complex)
    track[0] = places[0 if side == 1 else 1, 0]
    for k in range(1, len(q)):
        track[k] = places[np.abs(places[:, k] - track[k - 1]).argmin(), k]
    return q, track

"""Optima of linkages, against a random search in a shrinking box that solves many linkages at once in closed form."""

import numpy as np
import pytest

import geomkin as gk

pytestmark = pytest.mark.campaign

STEP_DEG = 10
DRIVE = np.radians(np.arange(0, 361, STEP_DEG))
SPEED = 2 * np.pi  # rad/s, of 60 rpm


def acute_deg(angle):
    folded = np.abs(np.angle(np.exp(1j * angle)))
    return np.degrees(np.minimum(folded, np.pi - folded))


def four_bar(ground=100.0, crank=30.0, coupler=90.0, rocker=70.0, x=40.0, y=25.0):
    """Results by id, (frames, linkages), by the intersection of two circles; nan where the loop is open."""
    crank_pin = crank * np.exp(1j * DRIVE[:, None])
    apart = ground - crank_pin
    distance = np.abs(apart)
    along = (coupler**2 - rocker**2 + distance**2) / (2 * distance)
    bar = apart / distance * (along + 1j * np.sqrt(coupler**2 - along**2))
    arm = bar - apart
    omega = SPEED * crank * np.sin(np.angle(bar) - DRIVE[:, None]) / (rocker * np.sin(np.angle(bar) - np.angle(arm)))
    point = crank_pin + (x + 1j * y) * bar / np.abs(bar)
    return {
        "transmission_angle": acute_deg(np.angle(bar) - np.angle(arm)),
        "rocker_angle": np.degrees(np.unwrap(np.angle(arm), axis=0)),
        "rocker_omega": omega,
        "coupler_point_x": point.real,
        "coupler_point_y": point.imag,
    }


def slider_crank(crank=30.0, coupler=90.0, offset=0.0):
    """The same of a slider-crank, by its vector loop."""
    angle = DRIVE[:, None]
    sine = (offset - crank * np.sin(angle)) / coupler
    rod = np.arcsin(sine)
    rod_rate = -crank * SPEED * np.cos(angle) / (coupler * np.cos(rod))
    velocity = -crank * SPEED * np.sin(angle) - coupler * np.sin(rod) * rod_rate
    return {
        "transmission_angle": 90 - np.degrees(np.abs(rod)),
        "slide_displacement": crank * np.cos(angle) + coupler * np.cos(rod),
        "slide_velocity": velocity,
    }


SUMMARIES = {
    "min": np.min, "max": np.max, "mean": np.mean, "range": np.ptp, "rms": lambda v, axis: np.sqrt(np.mean(v**2, axis)),
}  # fmt: skip


def by_random_search(solve, vary, minimise, constraints, rounds=60, count=4000):
    """The least objective of all linkages: the box shrinks about the best ones. minimise: (sign, summary, id)."""
    rng = np.random.default_rng(1)
    low, high = np.array(list(vary.values()), dtype=float).T
    best, centre, width = np.inf, 0.5 * (low + high), high - low
    for _ in range(rounds):
        tried = np.clip(
            centre[:, None] + (rng.random((len(low), count)) - 0.5) * width[:, None], low[:, None], high[:, None]
        )
        with np.errstate(all="ignore"):
            results = solve(**dict(zip(vary, tried)))
        sign, summary, id = minimise
        value = sign * SUMMARIES[summary](results[id], axis=0)
        for summary, id, side, limit in constraints:
            found = SUMMARIES[summary](results[id], axis=0)
            value = np.where(found >= limit if side == ">=" else found <= limit, value, np.inf)
        value = np.where(np.isfinite(value), value, np.inf)
        if value.min() < best:
            best, centre = value.min(), tried[:, value.argmin()]
        width = width * 0.85
    return best


CRANK_ROCKER = {"crank": (15, 45), "coupler": (60, 130), "rocker": (40, 100)}
POINT = {"x": (0, 80), "y": (0, 60)}
SLIDER_CRANK = {"crank": (20, 50), "coupler": (70, 150), "offset": (-30, 30)}
MU, SWING, STROKE = "transmission_angle", "rocker_angle", "slide_displacement"
PROBLEMS = {
    "transmission": (four_bar, {"coupler": (60, 120), "rocker": (60, 120)}, (-1, "min", MU), []),
    "transmission at a swing": (four_bar, CRANK_ROCKER, (-1, "min", MU), [("range", SWING, ">=", 60)]),
    "transmission at a large swing": (four_bar, CRANK_ROCKER, (-1, "min", MU), [("range", SWING, ">=", 95)]),
    "mean transmission": (four_bar, CRANK_ROCKER, (-1, "mean", MU), [("range", SWING, ">=", 60)]),
    "swing": (four_bar, CRANK_ROCKER, (-1, "range", SWING), [("min", MU, ">=", 40)]),
    "swing below a position": (
        four_bar, CRANK_ROCKER, (-1, "range", SWING), [("min", MU, ">=", 35), ("max", SWING, "<=", 150)],
    ),
    "speed": (four_bar, CRANK_ROCKER, (1, "max", "rocker_omega"), [("range", SWING, ">=", 50)]),
    "speed driven well": (
        four_bar, CRANK_ROCKER, (1, "max", "rocker_omega"), [("range", SWING, ">=", 50), ("min", MU, ">=", 45)],
    ),
    "mean square speed": (
        four_bar, CRANK_ROCKER, (1, "rms", "rocker_omega"), [("range", SWING, ">=", 50), ("min", MU, ">=", 20)],
    ),
    "range of speeds": (
        four_bar, CRANK_ROCKER, (1, "range", "rocker_omega"), [("range", SWING, ">=", 40), ("min", MU, ">=", 30)],
    ),
    "flat path": (four_bar, POINT, (1, "range", "coupler_point_y"), [("range", "coupler_point_x", ">=", 50)]),
    "low path": (four_bar, POINT, (1, "max", "coupler_point_y"), [("range", "coupler_point_x", ">=", 45)]),
    "narrow path": (four_bar, POINT, (1, "range", "coupler_point_x"), [("min", "coupler_point_y", ">=", 20)]),
    "high path of any four-bar": (
        four_bar, {**CRANK_ROCKER, "y": (0, 60)}, (-1, "min", "coupler_point_y"), [("min", MU, ">=", 45)],
    ),
    "slider, transmission": (slider_crank, SLIDER_CRANK, (-1, "min", MU), [("range", STROKE, ">=", 70)]),
    "slider, speed": (slider_crank, SLIDER_CRANK, (1, "max", "slide_velocity"), [("range", STROKE, ">=", 60)]),
    "slider, mean square speed": (
        slider_crank, SLIDER_CRANK, (1, "rms", "slide_velocity"), [("range", STROKE, ">=", 60), ("min", MU, ">=", 50)],
    ),
    "slider, stroke": (
        slider_crank, SLIDER_CRANK, (-1, "range", STROKE), [("min", MU, ">=", 55), ("max", STROKE, "<=", 150)],
    ),
    "slider, short": (slider_crank, SLIDER_CRANK, (1, "max", STROKE), [("range", STROKE, ">=", 70), ("min", MU, ">=", 50)]),
    "slider, slow back": (
        slider_crank, SLIDER_CRANK, (-1, "min", "slide_velocity"), [("range", STROKE, ">=", 50), ("min", MU, ">=", 40)],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PROBLEMS)
def test_no_linkage_of_a_random_search_is_better(name):
    solve, vary, (sign, summary, id), constraints = PROBLEMS[name]
    kind = solve.__name__.replace("_", "-")
    sizes = {"crank": 30.0, "coupler": 90.0}
    sizes |= {"ground": 100.0, "rocker": 70.0, "coupler_point": [40.0, 25.0]} if solve is four_bar else {"offset": 0.0}
    places = {"x": "coupler_point[0]", "y": "coupler_point[1]"}
    best = gk.optimise(
        {"kind": kind, "linkage": sizes, "drive": {"step_deg": STEP_DEG}},
        {f"linkage.{places.get(key, key)}": pair for key, pair in vary.items()},
        f"{'-' if sign < 0 else ''}{summary}({id})",
        [f"{what}({of}) {side} {limit}" for what, of, side, limit in constraints],
        starts=3,
    )
    expected = by_random_search(solve, vary, (sign, summary, id), constraints)
    scale = max(abs(expected), 1.0)
    assert best.objective <= expected + 1e-6 * scale
    # The random search ends near a corner of two constraints, not in it.
    assert best.objective >= expected - 1e-2 * scale

"""Prints how well function generators do, beside published ones; never pass or fail.

.venv/bin/python -m tests.speed.synthesis_function; seconds are of the processor.
"""

import time

import numpy as np

import geomkin as gk
from geomkin.synthesis import chebyshev_points, slider_function_generator

# The function, its range, swings; the starts of published linkages that stay where they are, or none; and what is
# published: three points, Freudenstein's equation, minimax, each at these starts, and the minimax of free starts.
CASES = {
    "log10(x)": ((1, 2), (60, 90), (45, 0), (2.364, 1.230, 0.642, 0.0470)),
    "x**1.5": ((1, 3), (90, 90), (210, 240), (0.581, 0.623, 0.320, 0.0102)),
    "sin(x)": ((0, np.pi / 2), (90, 90), None, (np.nan, np.nan, np.nan, 0.1903)),
    "x**2": ((1, 3), (90, 90), None, (np.nan, np.nan, np.nan, 0.0153)),
    "exp(x)": ((0, 1), (60, 90), None, None),
    "1/x": ((1, 2), (60, 90), None, None),
    "x**3": ((0, 1), (90, 60), None, None),
    "cos(x)": ((0, 1.5), (-120, 80), None, None),
    "tanh(x)": ((-1, 1), (120, -90), None, None),
    "sqrt(x)": ((0.1, 2), (100, 150), None, None),
}
COLUMNS = (
    "3 points, given",
    "equation, given",
    "mean square, given",
    "minimax, given",
    "minimax, free",
    "slider, 50 mm",
)
# Published linkages of given starts keep no other limits.
LOOSE = {"least_transmission_angle_deg": 5, "largest_ratio": 100}


def timed(search, *wish, **given):
    """The largest error, deg or mm, and seconds; nan where nothing keeps the limits."""
    before = time.process_time()
    try:
        found = search(*wish, **given)
    except gk.DesignError:
        return np.nan, time.process_time() - before, None
    return found.largest, time.process_time() - before, found


def by_equation(found, count=2001):
    """Largest error, deg, of the four-bar that fits Freudenstein's equation best at the starts of one that was found."""
    wanted = found.wanted
    x = np.linspace(wanted.x0, wanted.x1, count)
    phi, psi = found.input_at(x), np.radians(found.wanted_at(x))
    terms = np.stack([np.cos(psi), -np.cos(phi), np.ones(count)], axis=1)
    k = np.linalg.lstsq(terms, np.cos(phi - psi), rcond=None)[0]
    a, c = 1 / k[0], 1 / k[1]
    b = np.sqrt(1 + a * a + c * c - 2 * a * c * k[2])
    # A link of negative length starts half a turn on.
    motion = gk.move(gk.FourBar(1, abs(a), b, abs(c)), phi + np.pi * (a < 0), found.branch)
    error = np.angle(motion.rocker.direction * np.exp(-1j * (psi + np.pi * (c < 0))))
    return float(np.degrees(np.abs(error).max()))


def figures():
    """Largest errors, deg, seconds in brackets; below each, what is published.

    Given starts are the published ones, and elsewhere those of the least mean square error, whole degrees.
    """
    print(f"{'':10}{'swings':>10}{'starts':>10}" + "".join(f"{name:>22}" for name in COLUMNS))
    for text, (span, swings, starts, published) in CASES.items():
        wish = (text, span, *swings)
        if starts is None:
            mean = gk.function_generator(*wish, method="least-squares").starts_deg
            starts = tuple(float(round(start)) for start in mean)
        given = dict(zip(("input_start_deg", "output_start_deg"), starts)) | LOOSE
        points = timed(gk.function_generator, *wish, **given, method="points")
        mean = timed(gk.function_generator, *wish, **given, method="least-squares")
        least = timed(gk.function_generator, *wish, **given)
        best = timed(gk.function_generator, *wish)
        slider = timed(slider_function_generator, text, span, swings[0], 50)
        columns = (points, (by_equation(least[2]), 0.0), mean, least, best, slider)
        reported = "".join(f"{error:12.5f} ({seconds:5.2f} s)" for error, seconds, *_ in columns)
        print(f"{text:10}{swings[0]:>5}{swings[1]:>5}{starts[0]:5.0f}{starts[1]:5.0f}{reported}")
        if published:
            one, two, three, four = ("" if np.isnan(value) else f"{value:.4f}" for value in published)
            print(f"{'':30}{one:>12}{two:>22}{three:>44}{four:>22}   published")
    print("Chebyshev's three points from 1 to 3:", np.round(chebyshev_points((1, 3), 3), 3))


if __name__ == "__main__":
    figures()

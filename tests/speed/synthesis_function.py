"""Prints how well function generators do, beside published ones; never pass or fail.

.venv/bin/python -m tests.speed.synthesis_function; seconds are of the processor.
"""

import time

import numpy as np

import geomkin as gk
from geomkin.synthesis import chebyshev_points, slider_function_generator

# The function, its range, swings, and the least largest error that is published at 30 deg and a ratio of 10.
PUBLISHED = {
    "log10(x)": ((1, 2), (60, 90), 0.0470),
    "x**1.5": ((1, 3), (90, 90), 0.0102),
    "sin(x)": ((0, np.pi / 2), (90, 90), 0.1903),
    "x**2": ((1, 3), (90, 90), 0.0153),
}
OTHERS = {
    "exp(x)": ((0, 1), (60, 90)),
    "1/x": ((1, 2), (60, 90)),
    "x**3": ((0, 1), (90, 60)),
    "cos(x)": ((0, 1.5), (-120, 80)),
    "tanh(x)": ((-1, 1), (120, -90)),
    "sqrt(x)": ((0.1, 2), (100, 150)),
}
COLUMNS = ("3 points", "equation", "mean square", "minimax, its starts", "minimax", "slider, mm")


def timed(search, *wish, **given):
    """The largest error, deg or mm, and seconds; nan where nothing keeps the limits."""
    before = time.process_time()
    try:
        found = search(*wish, **given)
    except gk.DesignError:
        return np.nan, time.process_time() - before, None
    return found.largest, time.process_time() - before, found


def by_equation(found, count=181):
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
    """One line a function: largest errors, deg; seconds in brackets."""
    print(f"{'':10}{'swings':>10}" + "".join(f"{name:>22}" for name in COLUMNS) + f"{'published':>12}")
    for text, (span, swings, *published) in (PUBLISHED | OTHERS).items():
        wish = (text, span, *swings)
        points = timed(gk.function_generator, *wish, method="points")
        mean = timed(gk.function_generator, *wish, method="least-squares")
        # The starts of the best by the mean, which the given ones stand for.
        starts = dict(zip(("input_start_deg", "output_start_deg"), mean[2].starts_deg))
        equation = (by_equation(mean[2]), 0.0)
        given = timed(gk.function_generator, *wish, **starts)
        best = timed(gk.function_generator, *wish)
        slider = timed(slider_function_generator, text, span, swings[0], 50)
        told = "".join(f"{one[0]:12.5f} ({one[1]:5.2f} s)" for one in (points, equation, mean, given, best, slider))
        print(f"{text:10}{swings[0]:>5}{swings[1]:>5}{told}{published[0] if published else np.nan:12.4f}")
    print("Chebyshev's three points from 1 to 3:", np.round(chebyshev_points((1, 3), 3), 3))


if __name__ == "__main__":
    figures()

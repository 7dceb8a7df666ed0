"""Linkages of every make, for tests that hold for all of them."""

import numpy as np

import geomkin as gk

FOUR_BAR = gk.FourBar(100, 30, 90, 70, 40 + 25j)
TURN = np.linspace(0, 2 * np.pi, 73)


def walking_leg():
    """Jansen's leg as bodies that share the names of their pins."""
    return gk.Linkage(
        {
            "ground": {"O": 0, "F": -38 - 7.8j},
            "crank": {"O": 0, "M": 15},
            "upper": {"M": 0, "B": 50},
            "triangle": {"F": 0, "B": 41.5, "D": 1.3 + 40.1j},
            "lower": {"M": 0, "E": 61.9},
            "link": {"F": 0, "E": 39.3},
            "parallel": {"D": 0, "G": 39.4},
            "leg": {"E": 0, "G": 36.7, "foot": -4 + 49j},
        },
        driver="crank",
    )


def locked():
    """A six-bar driven by its last link: no dyad to begin with, so its loops go to iteration."""
    bodies = {
        "ground": {"O": 0, "C": 100, "E": 60 + 120j},
        "crank": {"O": 0, "A": 30},
        "coupler": {"A": 0, "B": 90, "P": 40 + 25j},
        "rocker": {"C": 0, "B": 70},
        "rod": {"P": 0, "D": 80},
        "out": {"E": 0, "D": 60},
    }
    free = gk.move(gk.Linkage(bodies, "crank"), [0.6])
    estimate = {pin: free.point(pin).position[0] + 0.5 for pin in "ABPD"}
    start = float(np.angle(free.bodies["out"].direction[0]))
    return gk.Linkage(bodies, "out", estimate=estimate), np.linspace(start, start + 0.15, 20)


# name: (linkage, drives, branch)
ALL = {
    "four-bar": (FOUR_BAR, TURN, 1),
    "four-bar by rocker": (gk.FourBar(100, 30, 90, 70, 40 + 25j, driver="rocker"), np.linspace(1.7, 2.4, 30), -1),
    "four-bar by coupler": (gk.FourBar(100, 90, 25, 90, 12 + 40j, driver="coupler"), TURN, 1),
    "four-bar placed elsewhere": (gk.FourBar(100, 30, 90, 70, 40, origin=5 - 3j, ground_angle_deg=37), TURN, -1),
    "slider-crank": (gk.SliderCrank(30, 90, 12, 40 + 5j), TURN, 1),
    "slider-crank the other way": (gk.SliderCrank(30, 90, -12, ground_angle_deg=200), TURN, -1),
    "slider-crank by coupler": (gk.SliderCrank(30, 90, 12, driver="coupler"), np.linspace(-0.2, 0.3, 30), 1),
    "slider-crank by slider": (gk.SliderCrank(30, 90, 12, driver="slider"), np.linspace(70, 110, 30), -1),
    "slotted lever": (gk.InvertedSliderCrank(80, 30, 7, point=130), TURN, 1),
    "slotted lever by lever": (gk.InvertedSliderCrank(80, 30, driver="rocker"), np.linspace(2.9, 3.3, 30), -1),
    "whitworth": (gk.InvertedSliderCrank(20, 60, 3), TURN, 1),
    "sliding coupler": (gk.InvertedSliderCrank(80, 30, 5, "coupler", 130), TURN, 1),
    "stephenson": (gk.StephensonSixBar(FOUR_BAR, 80, 60, 60 + 120j), TURN, {"output_pin": -1}),
    "watt": (gk.WattSixBar(FOUR_BAR, 50 - 30j, 90, 60, 180), TURN, 1),
    "shaper": (gk.Shaper(90, 30, 180, 60, 85, origin=3j), TURN, 1),
    "trammel": (gk.EllipticTrammel(60, 100, 80), TURN, 1),
    "trammel by shuttle": (gk.EllipticTrammel(60, 100, driver="shuttle"), np.linspace(-50, 50, 30), 1),
    "scotch yoke": (gk.ScotchYoke(30, 100, 70), TURN, 1),
    "oldham": (gk.OldhamCoupling(6), TURN, 1),
    "walking leg": (walking_leg(), TURN, {"B": -1, "G": -1}),
    "loops": (*locked(), 1),
}

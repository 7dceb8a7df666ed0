"""The seven-body mechanism of Andrews, a test problem for multibody programs.

Data and results: IVP test set, release 2.4, part II-14; Hairer and Wanner, Solving Ordinary Differential Equations II,
section VII.7. Lengths in mm, so that inertias are in kg mm2.
"""

import numpy as np

import geomkin as gk

BODIES = {
    "ground": {"O": 0, "A": -69.34 - 2.27j, "B": -36.35 + 32.73j, "C": 14 + 72j},
    "K1": {"O": 0, "F": 7},
    "K2": {"F": 0, "E": -28},
    "K3": {"B": 0, "E": -35j, "D": 20 - 18j},
    "K4": {"H": 0, "E": -20j},
    "K5": {"A": 0, "H": 40},
    "K6": {"G": 0, "E": 20},
    "K7": {"A": 0, "G": -40j},
}
MASSES = {
    "K1": gk.Mass(0.04325, 0.92, 2.194),
    "K2": gk.Mass(0.00365, -11.5, 0.4410),
    "K3": gk.Mass(0.02373, 10.43 - 18.74j, 5.255),
    "K4": gk.Mass(0.00706, -5.79j, 0.5667),
    "K5": gk.Mass(0.07050, 23.08 + 9.16j, 11.69),
    "K6": gk.Mass(0.00706, 5.79, 0.5667),
    "K7": gk.Mass(0.05498, -4.49 - 12.28j, 19.12),
}
SPRING = gk.Spring("K3", "D", "ground", "C", 4.530, 77.85)
LOADS = gk.Loads(masses=MASSES, springs=[SPRING])
# Angles at the start, rad: of K1, K3, K5, K7.
BETA, GAMMA, DELTA, EPSILON = -0.06171389001427645, 0.45527981916307038, 0.48736497954384255, 1.23054744454982119
TORQUE = 33.0


def start():
    """The linkage, and its branch by the positions of its pins at the start."""
    pins = {
        "E": BODIES["ground"]["B"] - 35j * np.exp(1j * GAMMA),
        "H": BODIES["ground"]["A"] + 40 * np.exp(1j * DELTA),
        "G": BODIES["ground"]["A"] - 40j * np.exp(1j * EPSILON),
    }
    return gk.Linkage(BODIES, "K1"), {pin: complex(place) for pin, place in pins.items()}

"""Roads to the truth for teeth that shape each other: the tooth moved past its mate by brute force."""

import numpy as np


def facing(mate, z):
    """Points of the mate, as it stands when the gear's tooth on +y faces it: those of the space on that tooth."""
    signed = -mate.pitch_radius if mate.pose.origin.imag < mate.pitch_radius else mate.pitch_radius
    z = mate.pose.direction * z
    towards = -1j if signed > 0 else 1j
    pitch = 2 * np.pi / mate.teeth
    return z * np.exp(-1j * pitch * np.round(np.angle(np.mean(z) / towards) / pitch)), signed


def least_clearance(mate, z, clearance, steps=24_001):
    """Least over all positions of clearance(points in the gear's frame), for each point of the mate.

    The gear stands still, the mate rolls round it: its axis by psi, itself by psi (1 + r / R).
    """
    z, signed = facing(mate, z)
    r = abs(signed) * mate.gear_teeth / mate.teeth
    k = 1 + r / signed

    def at(w, psi):
        return clearance(w * np.exp(1j * k * psi) + 1j * (r + signed) * np.exp(1j * psi))

    every = np.linspace(-np.pi, np.pi, steps)
    least = np.empty(len(z))
    for i, w in enumerate(z):
        near = at(w, every)
        valleys = np.flatnonzero((near[1:-1] <= near[:-2]) & (near[1:-1] <= near[2:])) + 1
        middle = every[valleys[np.argsort(near[valleys])[:6]]][:, None]
        reach = every[1] - every[0]
        for _ in range(5):
            psi = middle + reach * np.linspace(-1, 1, 201)
            close = at(w, psi)
            middle = np.take_along_axis(psi, close.argmin(axis=1)[:, None], 1)
            reach /= 40
        least[i] = close.min()
    return least


def inner_points(curve, count=9):
    """Points of every smooth piece but the last, which is the tip land."""
    b = curve.breaks[:-1]
    share = 0.5 - 0.5 * np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return curve.point(np.concatenate([b0 + (b1 - b0) * share for b0, b1 in zip(b, b[1:])]))

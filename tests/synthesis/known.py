"""Random linkages moved to a few poses of their coupler: searches must give their dyads back."""

from dataclasses import dataclass

import numpy as np

import geomkin as gk


@dataclass
class Known:
    """poses, and the two dyads: pivots on the ground and pins on the body, or where at infinity the slide's direction."""

    poses: list
    fixed: list
    moving: list
    fixed_far: list
    moving_far: list


def known_linkages(rng, count, poses, size=1.0):
    """Four-bars, slider-cranks, inverted slider-cranks, and the last two seen from their other side, each a fifth."""
    each = -(-count // 5)
    found = [*_moved(rng, each, poses, "four-bar", size), *_moved(rng, 2 * each, poses, "slider", size)]
    found += _moved(rng, 2 * each, poses, "inverted", size)
    return found[:count]


def _moved(rng, count, poses, kind, size):
    out = []
    while len(out) < count:
        many = 4 * count
        a, b, c, d = rng.uniform(0.2, 1.5, (4, many))
        offset = rng.uniform(-0.3, 0.3, many)
        make = {
            "four-bar": lambda: gk.FourBar(d, a, b, c),
            "slider": lambda: gk.SliderCrank(a, b, offset),
            "inverted": lambda: gk.InvertedSliderCrank(d, a, offset, line="coupler"),
        }[kind]
        start = rng.uniform(0, 2 * np.pi)
        drive = np.sort(start + rng.uniform(0, rng.uniform(1, 6), 5 * poses))
        motion = gk.move(make(), drive, int(rng.choice([1, -1])))
        body = motion.bodies["coupler"]
        for k in range(many):
            frames = np.nonzero(motion.assembled[:, k])[0]
            if len(out) == count or len(frames) < poses:
                continue
            frames = np.sort(rng.choice(frames, poses, replace=False))
            z, u = body.origin.position[frames, k], body.direction[frames, k]
            # Nearly equal poses determine nothing.
            if min(abs(u[i] - u[j]) for i in range(poses) for j in range(i)) < 0.02:
                continue
            if kind == "four-bar":
                truth = (0j, d[k] + 0j), (0j, b[k] + 0j), (False, False), (False, False)
            elif kind == "slider":
                truth = (0j, 1 + 0j), (0j, b[k] + 0j), (False, True), (False, False)
            else:
                truth = (0j, d[k] + 0j), (0j, 1 + 0j), (False, False), (False, True)
            fixed, moving, fixed_far, moving_far = truth
            # Another frame on the body, and another on the ground.
            at, spin, there, turn = *_random(rng), *_random(rng)
            z, u = z + u * at, u * spin
            moving = [
                m * np.conj(spin) if far else (m - at) * np.conj(spin) * size for m, far in zip(moving, moving_far)
            ]
            z, u = (z - there) * turn * size, u * turn
            fixed = [f * turn if far else (f - there) * turn * size for f, far in zip(fixed, fixed_far)]
            out.append(Known(list(zip(z.tolist(), np.angle(u).tolist())), fixed, moving, fixed_far, moving_far))
    return out


def _random(rng):
    return complex(*rng.normal(size=2)) * 0.7, np.exp(1j * rng.uniform(0, 2 * np.pi))


def apart(known, which, dyads, size=1.0):
    """How far the nearest of the dyads found is from one that is known, as a share of the poses' size."""
    fixed, moving = known.fixed[which], known.moving[which]
    if known.fixed_far[which]:
        one = np.abs((np.conj(fixed) * dyads.fixed_direction).imag)
    else:
        one = np.abs(dyads.fixed - fixed) / (size + abs(fixed))
    if known.moving_far[which]:
        two = np.abs((np.conj(moving) * dyads.moving_direction).imag)
    else:
        two = np.abs(dyads.moving - moving) / (size + abs(moving))
    return np.nanmin(np.append(np.maximum(one, two), np.inf))

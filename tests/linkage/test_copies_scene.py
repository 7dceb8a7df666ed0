"""Copies of a linkage: one that is mirrored is the mirror image of one that is not, plates, holes, engravings and all."""

import numpy as np

import geomkin as gk
from tests.gallery import marks, named

TEXT = """kind = "four-bar"
linkage = { ground = 100, crank = 30, coupler = 90, rocker = 70, coupler_point = [40, 25] }
drive = { step_deg = 15 }
copies = [{ phase_deg = 90 }, { phase_deg = 90, mirrored = true }, {}]
"""


def world(body, curve):
    ends = np.asarray(curve.breaks)
    local = curve.point(np.linspace(ends[0], ends[-1], 33)[:-1])
    return body.origin[:, None] + body.direction[:, None] * local


def test_a_mirrored_copy_is_the_mirror_image_of_a_plain_one():
    """All cranks turn one way on their shaft: a quarter turn ahead, one is mirrored where the other is as far behind."""
    scene = gk.load(TEXT).scene
    own = [body.name for body in scene.bodies if ", copy" not in body.name]
    assert {f"{name}, copy {k}" for name in own for k in (2, 3, 4)} == {b.name for b in scene.bodies} - set(own)
    lines = []
    for name in own:
        plain, mirrored = (named(scene, f"{name}, copy {k}") for k in (2, 3))
        assert plain.fixed == mirrored.fixed == named(scene, name).fixed and not (plain.named or mirrored.named)
        for one, other in zip(plain.parts, mirrored.parts, strict=True):
            for curves in (((one.outline,), (other.outline,)), (one.holes, other.holes), (one.marks, other.marks)):
                for a, b in zip(*curves, strict=True):
                    # The mean of both and their difference: x of the mirror, and the same heights.
                    seen, image = world(plain, a)[::-1], world(mirrored, b)
                    lines += [(seen.mean(axis=1) + image.mean(axis=1)).real / 2]
                    assert np.abs(np.sort(seen.imag, axis=1) - np.sort(image.imag, axis=1)).max() < 1e-9
    mirror = lines[0][0]
    assert np.abs(np.array(lines) - mirror).max() < 1e-9
    ((plain,), (mirrored,), (same,)) = (marks(scene, "point", f"coupler_point, copy {k}") for k in (2, 3, 4))
    assert np.abs(mirrored.place - (2 * mirror - np.conj(plain.place[::-1]))).max() < 1e-9
    assert plain.trail and mirrored.trail and plain.role == "traced"
    # One without a phase goes with the first, and the other's crank is 90 deg ahead.
    (first,) = (mark for mark in marks(scene, "point") if mark.label == "coupler_point")
    assert np.abs(same.place - first.place).max() < 1e-9
    crank = named(scene, "crank, copy 2").direction / named(scene, "crank").direction
    assert np.abs(crank - np.exp(1j * np.radians(90))).max() < 1e-9

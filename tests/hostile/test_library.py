"""Odd but possible calls of the library: worked out, or refused by the argument's name; never a warning."""

import pickle
import warnings

import numpy as np
import pytest

import geomkin as gk
from tests.texts import template_of

LINKAGE = gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j)
MOTION = gk.move(LINKAGE, [0.0, 1.0])
GEAR = {"kind": "spur-gear", "gear": {"teeth": 20, "module": 2}}


def test_invalid_values_are_refused_by_its_argument():
    for call, field in [
        (lambda: MOTION.point("pen"), "name"),
        (lambda: MOTION.point(3), "name"),
        (lambda: MOTION.point(["pen"]), "name"),
        (lambda: MOTION.slide("pen"), "name"),
        (lambda: gk.move(LINKAGE, (x for x in [0.0])), "drive"),
        (lambda: gk.path_generator(x for x in [1, 2, 3]), "points"),
        (lambda: gk.sweep(GEAR, {"gear.teeth": (x for x in [18, 20])}), "values"),
        *(
            (lambda only=only: gk.make(GEAR, "out", only=only), "only")
            for only in (3, {"csv"}, "csv", [None], b"csv", {})
        ),
        (lambda: gk.linkage.newton_raphson(lambda x: "a", lambda x: [[1.0]], [1.0]), "f"),
        (lambda: gk.linkage.newton_raphson(lambda x: x, lambda x: "b", [1.0]), "jacobian"),
        (lambda: gk.linkage.newton_raphson(lambda x: x, lambda x: [[1.0, 2.0]], [1.0]), "jacobian"),
        (lambda: gk.linkage.newton_raphson(lambda x: x, lambda x: x, np.ones(200_000)), "estimate"),
        (lambda: gk.function_generator(lambda x: "a", (0, 1)), "function"),
        (lambda: gk.flatten(gk.plane.Circle(0, 10), 1e-300), "tolerance"),
    ]:
        with pytest.raises(gk.DesignError) as refused:
            call()
        assert refused.value.field == field


def test_half_precision_is_bears_no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        half = gk.move(gk.FourBar(np.float16(100), 30, 90, np.array([70, 71], np.float16)), np.float16([0.5, 1]))
    assert half.drive.tolist() == [0.5, 1] and half.rocker.direction.dtype == complex
    whole = gk.move(gk.FourBar(100, 30, 90, np.array([70.0, 71])), [0.5, 1])
    assert half.rocker.direction == pytest.approx(whole.rocker.direction, abs=1e-6)


def test_results_can_be_pickled_and_work_as_before():
    motion = pickle.loads(pickle.dumps(MOTION))
    assert motion.point("coupler_point").position == pytest.approx(MOTION.point("coupler_point").position)
    cam = gk.load(template_of("disk-cam"))
    _ = cam.checks, cam.parts
    assert pickle.loads(pickle.dumps(cam)).checks == cam.checks
    square = gk.synthesis.Expression("x**2 + sin(x)")
    assert pickle.loads(pickle.dumps(square))(2.0) == square(2.0)

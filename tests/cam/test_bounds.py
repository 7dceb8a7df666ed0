"""Very large programmes and tables: done in little, or refused with the number that would do."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.program import Program
from geomkin.cam.program.segments import LiftSpline


def waves(count):
    ends = (360 * np.arange(1, count + 1) / count).tolist()
    return [
        gk.Rise("harmonic", rise=1e-3, end_deg=end) if k % 2 == 0 else gk.Return("harmonic", end_deg=end)
        for k, end in enumerate(ends)
    ]


def test_adjacent_dwells_are_merged():
    program = Program([gk.Dwell(end_deg=360 * k / 10_000) for k in range(1, 10_001)])
    assert program.breaks.tolist() == [0, 2 * np.pi]
    mixed = Program([gk.Dwell(end_deg=10), gk.Dwell(end_deg=40), gk.Rise("harmonic", rise=3, end_deg=90),
                     gk.Dwell(end_deg=100), gk.Dwell(end_deg=200), gk.Return("harmonic", end_deg=360)])  # fmt: skip
    whole = Program([gk.Dwell(end_deg=40), gk.Rise("harmonic", rise=3, end_deg=90), gk.Dwell(end_deg=200),
                     gk.Return("harmonic", end_deg=360)])  # fmt: skip
    angle = np.linspace(0, 7, 500)
    assert (mixed.breaks == whole.breaks).all()
    assert (mixed.motion(angle).lift == whole.motion(angle).lift).all()


def test_too_many_pieces_are_refused():
    with pytest.raises(gk.DesignError) as refused:
        gk.Cam(gk.TranslatingFlat(), Program(waves(502)), 40)
    assert refused.value.field == "program"
    assert not gk.undercut(gk.Cam(gk.TranslatingRoller(2), Program(waves(500)), 4000)).found


def test_too_many_segments_and_rows_are_refused():
    with pytest.raises(gk.DesignError):
        Program([gk.Dwell(end_deg=360)] * 10_001)
    angles = np.linspace(0, 180, 6001)
    one = LiftSpline(points=tuple(zip(angles.tolist(), (10 - 10 * np.cos(np.radians(angles))).tolist())))
    for rest, refused in ((4001, True), (3999, False)):
        angles = np.linspace(180, 360, rest)
        lifts = 10 - 10 * np.cos(np.radians(angles))
        lifts[0], lifts[-1] = one.points[-1][1], 0
        segments = [one, LiftSpline(points=tuple(zip(angles.tolist(), lifts.tolist())))]
        if refused:
            with pytest.raises(gk.DesignError) as error:
                Program(segments)
            assert error.value.field == "program[1]"
        else:
            assert Program(segments).motion(np.pi / 2).lift == pytest.approx(10)

"""Very large programmes and tables: done in little, or refused with the number that would do."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.program import Program


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

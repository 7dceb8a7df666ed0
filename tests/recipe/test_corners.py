"""Points given by two distances, held against the distances."""

import numpy as np
import pytest

from geomkin.kinds.linkage_tables import BodyList, TriangleCorner


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("lengths", [(50.0, 60.0), (75.0, 30.0), (40.0, 51.0)])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e4])
def test_a_corner_has_its_distances_and_its_side(lengths, side, size):
    one, two = np.array([3 - 4j, 75 + 50j]) * size
    bodies = {"ground": {"O": 0j}, "plate": {"O": 0j, "A": one, "B": two}}
    corner = TriangleCorner("plate", "pen", ("A", "B"), tuple(np.array(lengths) * size), side)
    pen = BodyList(bodies, "plate", (corner,)).linkage.bodies["plate"]["pen"]
    assert [abs(pen - one), abs(pen - two)] == pytest.approx([length * size for length in lengths], rel=1e-12)
    assert np.sign(np.imag(np.conj(two - one) * (pen - one))) == (1 if side == "left" else -1)

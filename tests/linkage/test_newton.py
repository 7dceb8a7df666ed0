"""Newton-Raphson says where it stands, converged or not."""

import numpy as np
import pytest

import geomkin as gk


def test_a_root_is_found_with_its_path_and_residual():
    root = gk.linkage.newton_raphson(
        lambda x: [x[0] ** 2 + x[1] - 3, x[0] - x[1]], lambda x: [[2 * x[0], 1], [1, -1]], [1, 1]
    )
    golden = (np.sqrt(13) - 1) / 2
    assert root.converged and root.value == pytest.approx([golden, golden], rel=1e-14)
    assert root.residual < 1e-14 and np.array_equal(root.path[0], [1, 1]) and np.array_equal(root.path[-1], root.value)


def test_no_root_is_said_and_not_made_up():
    root = gk.linkage.newton_raphson(lambda x: x**2 + 1, lambda x: 2 * x, 0.7)
    assert not root.converged and root.residual >= 1


@pytest.mark.parametrize("estimate", [0.0, np.nan])
def test_a_singular_start_stops_at_once(estimate):
    root = gk.linkage.newton_raphson(lambda x: x**2 - 1, lambda x: 2 * x, estimate)
    assert not root.converged and len(root.path) == 1


def test_a_double_root_converges_slowly_and_is_told_when_steps_run_out():
    few = gk.linkage.newton_raphson(lambda x: (x - 1) ** 2, lambda x: 2 * (x - 1), 2.0, steps=10)
    assert not few.converged and few.value[0] == pytest.approx(1, abs=2e-3)

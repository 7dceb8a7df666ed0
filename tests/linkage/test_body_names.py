"""Bodies are reached by name, and their names hide no attribute of a motion."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.linkage import MOTION_ATTRIBUTES


def crank(name):
    return gk.Linkage({"ground": {"O": 0}, name: {"O": 0, "A": 30}}, name)


def test_a_body_may_not_be_named_as_an_attribute_of_a_motion():
    motion = gk.move(crank("crank"), [0.0, 1.0])
    own = {name for name in {*object.__dir__(motion), *vars(motion)} if not name.startswith("_")} - {"crank", "ground"}
    assert own == MOTION_ATTRIBUTES
    for name in own:
        with pytest.raises(gk.DesignError) as caught:
            crank(name)
        assert caught.value.field == "bodies" and name in caught.value.problem
    for name, body in motion.bodies.items():
        assert motion[name] is body is getattr(motion, name)
    assert np.allclose(motion["crank"].direction, np.exp(1j * motion.drive))
    with pytest.raises(gk.DesignError) as caught:
        motion["rod"]
    assert caught.value.field == "name" and "crank" in caught.value.remedy

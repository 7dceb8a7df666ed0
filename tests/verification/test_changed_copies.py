"""Files changed a little, or written again by other programs: what passes, and what is said of the rest."""

import re

import numpy as np
import pytest

import geomkin as gk
from tests.verification.damage import GEAR


@pytest.mark.parametrize(("code", "by", "passes"), [("10", 1e-3, True), ("10", 1.0, False), ("42", 0.1, False)])
def test_a_vertex_of_an_old_drawing_is_measured(tmp_path, code, by, passes):
    settings = 'dxf_version = "R12"\ncurves = "arcs"\nwrite = ["dxf"]'
    gk.make(gk.load(re.sub(r"write = .*", settings, GEAR)).with_name("disk"), tmp_path)
    path = tmp_path / "disk/disk.dxf"
    text = path.read_text()
    found = re.search(rf"VERTEX\n(?:(?! *0\n).*\n.*\n)*? *{code}\n(.*)\n", text)
    path.write_text(f"{text[: found.start(1)]}{float(found[1]) + by}{text[found.end(1) :]}")
    (certificate,) = gk.verify(tmp_path)
    (file,) = (file for file in certificate.files if file.file == "disk.dxf")
    assert file.passed == passes and np.isfinite(file.deviation) and len(file.problems) == (not passes)

"""Prints the CPU time, s, that making the recipes of the gallery takes, and that of certifying their files.

.venv/bin/python tests/speed/certificates.py [RECIPE ...]
"""

import sys
import tempfile
import time
from pathlib import Path

import geomkin as gk

RECIPES = Path(__file__).parent.parent.parent / "recipes"


def main(names):
    with tempfile.TemporaryDirectory() as out:
        times = [time.process_time()]
        for name in names or sorted(path.stem for path in RECIPES.glob("*.toml")):
            gk.make(RECIPES / f"{name}.toml", out)
        times.append(time.process_time())
        certificates = gk.verify(out)
        times.append(time.process_time())
    files = sum(len(certificate.files) for certificate in certificates)
    wrong = sum(not certificate.passed for certificate in certificates)
    print(f"{len(certificates)} recipes, {files} files, {wrong} not as designed")
    print(f"made in {times[1] - times[0]:.1f} s, certified in {times[2] - times[1]:.1f} s")


if __name__ == "__main__":
    main(sys.argv[1:])

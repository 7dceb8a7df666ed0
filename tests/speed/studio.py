"""Prints the processor time of the studio's answers, each from a changed text to the bytes for the page. Never passes or
fails.

.venv/bin/python tests/speed/studio.py [RECIPE KEY ...]

Each answer is to another value of a key. The checks are asked for after the scene of the same text, as the page does.
The last column is the scene's time over that of a JSON round trip of its bytes.
"""

import json
import statistics
import sys
import time
from pathlib import Path

import geomkin as gk
from geomkin.core.field_visitor import numbers_in
from geomkin.recipe.keys import edited_text
from geomkin.studio.service import Studio
from geomkin.studio.workspace import Workspace

RECIPES = Path(__file__).parent.parent.parent / "recipes"
CASES = [
    ("crank-rocker", "linkage.rocker"),
    ("walking-leg", "linkage.bodies.crank.M[0]"),
    ("gear-pair", "first.profile_shift"),
    ("roller-cam", "cam.base_radius"),
    ("three-poses", "wanted.poses[1][0]"),
]
RUNS = 15


def spent_ms(action):
    """Processor time of a call, of all threads, and its result."""
    start = time.process_time()
    result = action()
    return 1000 * (time.process_time() - start), result


def answered(studio, text, lane):
    """The bytes of an answer; of a search that goes on as a job, those of its result."""
    reply = studio.post("answer", {"text": text, "recipe": "", "lane": lane})
    if "job" in reply:
        job = studio.jobs.get(reply["job"])
        job.done.wait()
        reply = job.result
    assert not reply["problems"], reply["problems"]
    return json.dumps(reply, ensure_ascii=False, separators=(",", ":")).encode()


def main(cases):
    print(f"{'recipe':<20}{'scene, ms':>10}{'checks, ms':>12}{'bytes':>10}{'scene / JSON':>14}")
    for name, key in cases:
        text = (RECIPES / f"{name}.toml").read_text()
        studio = Studio(Workspace(RECIPES))
        value = next(n.value for n in numbers_in(gk.load(text)) if n.key == key)
        times = []
        for k in range(RUNS + 1):
            changed = edited_text(text, {key: round(value + 0.001 * (k + 1), 6)})
            scene, content = spent_ms(lambda changed=changed: answered(studio, changed, "scene"))
            checks, _ = spent_ms(lambda changed=changed: answered(studio, changed, "checks"))
            plain, _ = spent_ms(lambda content=content: json.dumps(json.loads(content)))
            times.append((scene, checks, plain))
        scene, checks, plain = map(statistics.median, zip(*times[1:]))
        print(f"{name:<20}{scene:>10.1f}{checks:>12.1f}{len(content):>10,}{scene / plain:>14.1f}", flush=True)


if __name__ == "__main__":
    words = sys.argv[1:]
    main(list(zip(words[::2], words[1::2])) or CASES)

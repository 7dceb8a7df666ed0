"""All figures of the searches, beside the published ones: `python -m tests.speed.synthesis`, some minutes."""

import subprocess
import sys

ROOMS = ("rockers", "function", "dyads", "guidance", "path")

if __name__ == "__main__":
    for room in ROOMS:
        print(f"\n{room}\n", flush=True)
        # Each by itself: what one has loaded and kept would help the next.
        subprocess.run([sys.executable, "-m", f"tests.speed.synthesis_{room}"], check=True)

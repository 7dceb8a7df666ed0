"""The bill of materials as CSV: what is cut, then what is bought, a line each."""

from __future__ import annotations

import numpy as np

from ..table import Column, Table
from .csv import csv
from .job import Job


def write(job: Job) -> dict[str, bytes]:
    """The bill in one file."""
    return {f"{job.name}-bom.csv": csv(bill(job))}


def bill(job: Job) -> Table:
    """A row for each part, as wide and high as it is drawn, mm, and for each thing that is bought."""
    cuts, bought = job.solids, job.source.bought
    sizes = np.array([cut.box[1] - cut.box[0] for cut in cuts], dtype=complex)
    none, nothing = [np.nan] * len(bought), [""] * len(cuts)
    return Table(
        (
            Column("item", "", "what it is", np.array([*(cut.part.name for cut in cuts), *(b.name for b in bought)])),
            Column("count", "", "how many", np.array([*(cut.part.count for cut in cuts), *(b.count for b in bought)])),
            Column("thickness", "mm", "of its sheet", np.array([*(cut.part.thickness for cut in cuts), *none])),
            Column("width", "mm", "along x", np.array([*sizes.real.tolist(), *none])),
            Column("height", "mm", "along y", np.array([*sizes.imag.tolist(), *none])),
            Column(
                "joints",
                "",
                "its joints or parts",
                np.array([*nothing, *(" ".join(b.joints) for b in bought)]),
            ),
        )
    )

"""The operations a cutting program tells apart, with colours that colour-blind readers tell apart too."""

from __future__ import annotations

# name -> (colour index for programs that know only those, RGB)
LAYERS = {
    "CUT": (1, (213, 94, 0)),
    "HOLE": (5, (0, 114, 178)),
    "ENGRAVE": (3, (0, 158, 115)),
    "REFERENCE": (8, (110, 110, 110)),
}

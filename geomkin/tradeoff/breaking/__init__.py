"""Where methods fail: cells of the stability study, a file of them for each kind of mechanism."""

from __future__ import annotations

from ..cell import Cell
from . import cams as cams
from . import gears as gears
from . import linkages as linkages
from . import poses as poses

CELLS: tuple[Cell, ...] = (*linkages.CELLS, *poses.CELLS, *cams.CELLS, *gears.CELLS)

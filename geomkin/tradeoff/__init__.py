"""Speed against accuracy: how long each way to a result takes, how far it errs, and where its digits go."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .families import FAMILIES as FAMILIES
    from .family import Method as Method
    from .family import MethodFamily as MethodFamily
    from .files import chart_files as chart_files
    from .measurement import Measurement as Measurement
    from .results import Chart as Chart
    from .results import FamilyChart as FamilyChart
    from .results import chart as chart
    from .results import pareto_front as pareto_front
    from .study import Stability as Stability
    from .study import stability as stability
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)

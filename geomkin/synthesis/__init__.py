"""From the wanted motion to the linkage. Knows nothing of plates, files or recipes."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .found import Found as Found
    from .function.expression import Expression as Expression
    from .function.expression import named_function as named_function
    from .function.function import chebyshev_points as chebyshev_points
    from .function.function import function_generator as function_generator
    from .function.function import slider_function_generator as slider_function_generator
    from .function.results import FunctionGenerator as FunctionGenerator
    from .function.results import Peak as Peak
    from .function.results import SliderFunctionGenerator as SliderFunctionGenerator
    from .guidance.burmester import Burmester as Burmester
    from .guidance.burmester import BurmesterCurve as BurmesterCurve
    from .guidance.burmester import burmester_curves as burmester_curves
    from .guidance.displacement_poles import SliderCircle as SliderCircle
    from .guidance.displacement_poles import circle_of_sliders as circle_of_sliders
    from .guidance.displacement_poles import image_poles as image_poles
    from .guidance.displacement_poles import poles as poles
    from .guidance.dyads import Dyads as Dyads
    from .guidance.dyads import dyads_through as dyads_through
    from .guidance.filemon_waldron import Rectification as Rectification
    from .guidance.filemon_waldron import rectification as rectification
    from .guidance.guidance import BodyGuide as BodyGuide
    from .guidance.guidance import body_guides as body_guides
    from .guidance.infinitesimal import BodyState as BodyState
    from .guidance.infinitesimal import StateFourBar as StateFourBar
    from .guidance.infinitesimal import acceleration_state_four_bar as acceleration_state_four_bar
    from .guidance.infinitesimal import velocity_state_four_bar as velocity_state_four_bar
    from .path.path import path_generator as path_generator
    from .path.points import svg_path_points as svg_path_points
    from .path.results import PathFound as PathFound
    from .rockers.crank_rockers import CrankRocker as CrankRocker
    from .rockers.crank_rockers import crank_rocker as crank_rocker
    from .rockers.double_rockers import DoubleRocker as DoubleRocker
    from .rockers.double_rockers import double_rocker as double_rocker
    from .rockers.families import Family as Family
    from .rockers.strokes import StrokeCrank as StrokeCrank
    from .rockers.strokes import slider_crank_stroke as slider_crank_stroke
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)

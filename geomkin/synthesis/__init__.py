"""From the wanted motion to the linkage. Knows nothing of plates, files or recipes."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .burmester import Burmester as Burmester
    from .burmester import BurmesterCurve as BurmesterCurve
    from .burmester import burmester_curves as burmester_curves
    from .displacement_poles import SliderCircle as SliderCircle
    from .displacement_poles import circle_of_sliders as circle_of_sliders
    from .displacement_poles import image_poles as image_poles
    from .displacement_poles import poles as poles
    from .double_rockers import DoubleRocker as DoubleRocker
    from .double_rockers import double_rocker as double_rocker
    from .dyads import Dyads as Dyads
    from .dyads import dyads_through as dyads_through
    from .expression import Expression as Expression
    from .expression import named_function as named_function
    from .families import Family as Family
    from .filemon_waldron import Rectification as Rectification
    from .filemon_waldron import rectification as rectification
    from .found import Found as Found
    from .function import function_generator as function_generator
    from .function import slider_function_generator as slider_function_generator
    from .function_results import FunctionGenerator as FunctionGenerator
    from .function_results import Peak as Peak
    from .function_results import SliderFunctionGenerator as SliderFunctionGenerator
    from .guidance import BodyGuide as BodyGuide
    from .guidance import body_guides as body_guides
    from .infinitesimal import BodyState as BodyState
    from .infinitesimal import StateFourBar as StateFourBar
    from .infinitesimal import acceleration_state_four_bar as acceleration_state_four_bar
    from .infinitesimal import velocity_state_four_bar as velocity_state_four_bar
    from .path import path_generator as path_generator
    from .path_found import PathFound as PathFound
    from .path_points import svg_path_points as svg_path_points
    from .precision_points import chebyshev_points as chebyshev_points
    from .rockers import CrankRocker as CrankRocker
    from .rockers import crank_rocker as crank_rocker
    from .strokes import StrokeCrank as StrokeCrank
    from .strokes import slider_crank_stroke as slider_crank_stroke
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)

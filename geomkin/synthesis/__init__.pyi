# The public names of this package. Each is imported when it is first used.
from .found import Found as Found
from .function.function import (
    chebyshev_points as chebyshev_points,
)
from .function.function import (
    function_generator as function_generator,
)
from .function.function import (
    slider_function_generator as slider_function_generator,
)
from .function.results import (
    FunctionGenerator as FunctionGenerator,
)
from .function.results import (
    Peak as Peak,
)
from .function.results import (
    SliderFunctionGenerator as SliderFunctionGenerator,
)
from .function.wanted import Expression as Expression
from .function.wanted import named_function as named_function
from .guidance.burmester import (
    Burmester as Burmester,
)
from .guidance.burmester import (
    BurmesterCurve as BurmesterCurve,
)
from .guidance.burmester import (
    burmester_curves as burmester_curves,
)
from .guidance.dyads import Dyads as Dyads
from .guidance.dyads import dyads_through as dyads_through
from .guidance.guidance import BodyGuide as BodyGuide
from .guidance.guidance import body_guides as body_guides
from .guidance.guide_search import Rectification as Rectification
from .guidance.guide_search import rectification as rectification
from .guidance.infinitesimal import (
    BodyState as BodyState,
)
from .guidance.infinitesimal import (
    StateFourBar as StateFourBar,
)
from .guidance.infinitesimal import (
    acceleration_state_four_bar as acceleration_state_four_bar,
)
from .guidance.infinitesimal import (
    velocity_state_four_bar as velocity_state_four_bar,
)
from .guidance.poses import (
    SliderCircle as SliderCircle,
)
from .guidance.poses import (
    circle_of_sliders as circle_of_sliders,
)
from .guidance.poses import (
    image_poles as image_poles,
)
from .guidance.poses import (
    poles as poles,
)
from .kinds.body_guidance import BodyGuidanceRecipe as BodyGuidanceRecipe
from .kinds.burmester_curves import BurmesterCurvesRecipe as BurmesterCurvesRecipe
from .kinds.function_generators import (
    FunctionGeneratorRecipe as FunctionGeneratorRecipe,
)
from .kinds.function_generators import (
    SliderFunctionGeneratorRecipe as SliderFunctionGeneratorRecipe,
)
from .kinds.path_generator import PathGeneratorRecipe as PathGeneratorRecipe
from .kinds.rockers import (
    CrankRockerRecipe as CrankRockerRecipe,
)
from .kinds.rockers import (
    DoubleRockerRecipe as DoubleRockerRecipe,
)
from .kinds.rockers import (
    SliderCrankStrokeRecipe as SliderCrankStrokeRecipe,
)
from .path.nine_points import PathCount as PathCount
from .path.path import nearest_linkages as nearest_linkages
from .path.path import path_generator as path_generator
from .path.path_found import PathFound as PathFound
from .path.svg_drawings import svg_path_points as svg_path_points
from .rockers.crank_rockers import CrankRocker as CrankRocker
from .rockers.crank_rockers import crank_rocker as crank_rocker
from .rockers.double_rockers import DoubleRocker as DoubleRocker
from .rockers.double_rockers import double_rocker as double_rocker
from .rockers.families import Family as Family
from .rockers.strokes import StrokeCrank as StrokeCrank
from .rockers.strokes import slider_crank_stroke as slider_crank_stroke

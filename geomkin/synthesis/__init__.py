"""From the wanted motion to the linkage. Knows nothing of plates, files or recipes."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .expression import Expression as Expression
    from .expression import named_function as named_function
    from .found import Found as Found
    from .function import function_generator as function_generator
    from .function import slider_function_generator as slider_function_generator
    from .function_results import FunctionGenerator as FunctionGenerator
    from .function_results import Peak as Peak
    from .function_results import SliderFunctionGenerator as SliderFunctionGenerator
    from .precision_points import chebyshev_points as chebyshev_points
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)

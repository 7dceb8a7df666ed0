"""Four-bar and slider-crank in 60 digits, by circles that meet and by linear loop equations of the rates."""

from decimal import Decimal, getcontext

getcontext().prec = 60


def cosine_sine(angle):
    """Of the very number that the float is."""
    t = Decimal(angle)
    terms = [Decimal(1)]
    for k in range(1, 90):
        terms.append(terms[-1] * t / k)
    return (
        sum((-1) ** (k // 2) * terms[k] for k in range(0, 90, 2)),
        sum((-1) ** (k // 2) * terms[k] for k in range(1, 90, 2)),
    )


def solve(a, b, right):
    """Real x, y with x a + y b = right for vectors of two numbers."""
    det = a[0] * b[1] - a[1] * b[0]
    return (right[0] * b[1] - right[1] * b[0]) / det, (a[0] * right[1] - a[1] * right[0]) / det


def four_bar(ground, crank, coupler, rocker, angle, branch):
    """Directions of coupler and rocker, and the first and second derivatives of their angles by the crank's."""
    d, a, b, c = map(Decimal, (ground, crank, coupler, rocker))
    cos, sin = cosine_sine(angle)
    px, py = a * cos, a * sin
    ux, uy = d - px, -py
    s = ux * ux + uy * uy
    along = (s + b * b - c * c) / (2 * s)
    left = branch * ((b * b - along * along * s) / s).sqrt()
    bar = along * ux - left * uy, along * uy + left * ux
    arm = bar[0] - ux, bar[1] - uy
    # a e^{it} + bar = d + arm, differentiated once and twice; i z is (-y, x).
    columns = (-bar[1], bar[0]), (arm[1], -arm[0])
    h3, h4 = solve(*columns, (py, -px))
    right = tuple(p + h3 * h3 * m - h4 * h4 * n for p, m, n in zip((px, py), bar, arm))
    g3, g4 = solve(*columns, right)
    return (
        [complex(float(bar[0] / b), float(bar[1] / b)), complex(float(arm[0] / c), float(arm[1] / c))],
        [float(h3), float(h4)],
        [float(g3), float(g4)],
    )


def slider_crank(crank, coupler, offset, angle, branch):
    """Direction of the coupler and place of the slider, and their first and second derivatives by the crank angle."""
    a, b, e = map(Decimal, (crank, coupler, offset))
    cos, sin = cosine_sine(angle)
    px, py = a * cos, a * sin
    along = branch * (b * b - (e - py) ** 2).sqrt()
    bar = along, e - py
    # a e^{it} + bar = x + i e.
    columns = (-bar[1], bar[0]), (Decimal(-1), Decimal(0))
    h, f = solve(*columns, (py, -px))
    right = tuple(p + h * h * m for p, m in zip((px, py), bar))
    h2, f2 = solve(*columns, right)
    return (
        [complex(float(bar[0] / b), float(bar[1] / b)), float(px + along)],
        [float(h), float(f)],
        [float(h2), float(f2)],
    )


def actuator(still, bar, offset, place, branch):
    """Directions of an actuator's slide and of its bar, and the derivatives of their angles by the rod's place.

    The actuator stands at the origin and is place + i offset along its slide; the bar stands at `still` on +x.
    """
    s, b, n, x = map(Decimal, (still, bar, offset, place))
    square = x * x + n * n
    along = (s * s + square - b * b) / (2 * s)
    pin = along, branch * (square - along * along).sqrt()
    arm = pin[0] - s, pin[1]
    slide = (pin[0] * x + pin[1] * n) / square, (pin[1] * x - pin[0] * n) / square
    # slide (x + i n) = s + arm, differentiated once and twice.
    columns = (-pin[1], pin[0]), (arm[1], -arm[0])
    h, k = solve(*columns, (-slide[0], -slide[1]))
    coriolis = -2 * h * slide[1], 2 * h * slide[0]
    h2, k2 = solve(*columns, tuple(h * h * p - k * k * a - c for p, a, c in zip(pin, arm, coriolis)))
    return (
        [complex(*map(float, slide)), complex(float(arm[0] / b), float(arm[1] / b))],
        [float(h), float(k)],
        [float(h2), float(k2)],
    )

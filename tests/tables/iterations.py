"""Newton-Raphson as printed in course notes (AME 352): from an estimate to each further value."""

# x^3 - 3x^2 - 10x + 24
CUBIC = {
    10: (7.2870, 5.5937, 4.6153, 4.1478, 4.0121, 4.0001, 4.0000),
    -5: (-3.6737, -3.1153, -3.0043, -3.0000),
}
# Four-bar 5, 2, 6, 4 at 120 deg, coupler and rocker estimated at 30 and 90 deg: the first correction, rad.
FOUR_BAR_STEP = (-0.1409, 0.0953)

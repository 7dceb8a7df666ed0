"""Published slider-crank results, with what the print gets wrong."""

# Theory of Machines, example 25.2: crank 200, rod 750, offset 50; crank at 20 rad/s, 10 rad/s2.
# crank deg: rod deg below the slide line, slider m/s, rod rad/s. The book measures the rod's angle downward.
# The printed rod velocities come from a program that multiplies by cos(beta) where it must divide: it prints
# -5.32, -4.61, -2.63; what follows is right. The printed accelerations inherit it: -101.15 and -35.62 m/s2
# for -101.34 and -35.92.
EXAMPLE_25_2 = {0: (3.82, 0.27, -5.35), 60: (-9.46, -3.80, -2.70), 210: (11.54, 1.29, 4.71)}
EXAMPLE_25_2_PRINTED_ROD = {0: -5.32, 30: -4.61, 60: -2.63}
EXAMPLE_25_2_ROD = {0: -5.35, 30: -4.63, 60: -2.70}
EXAMPLE_25_2_SLIDER_ACCELERATION = {0: -101.34, 60: -35.92, 210: 61.08}
EXAMPLE_25_2_SLIDER_PRINTED = {0: -101.15, 60: -35.62}
EXAMPLE_25_2_ROD_ACCELERATION = {210: -47.54}

# AME 352 course notes: crank 0.12, rod 0.26, 65 deg, 1.6 rad/s; right as printed:
# rod deg, slider, rod rad/s, slider velocity, rod rad/s2, slider acceleration (lengths in m).
AME_352 = (-24.727, 0.287, -0.344, -0.211, 1.125, -0.035)

"""Published four-bar results, with what the print gets wrong."""

# Theory of Machines, example 25.1: lengths 300, 360, 360, ground 600; crank at 10 rad/s, -30 rad/s2.
# crank deg: rocker deg, coupler deg, rocker rad/s, coupler rad/s, rocker rad/s2, coupler rad/s2.
# The print gives -170.39 for the last number at 330 deg; -176.39 is right.
EXAMPLE_25_1 = {
    0: (114.62, 65.38, -10.00, -10.00, 121.67, -61.67),
    30: (97.30, 35.12, -0.84, -8.69, 181.43, 101.52),
    60: (106.19, 13.81, 6.02, -6.02, 77.45, 38.02),
    90: (132.14, -5.27, 12.26, -8.26, 216.18, -180.18),
    270: (-174.73, 47.86, -8.26, 12.26, 229.73, -289.73),
    300: (166.19, 73.81, -6.02, 6.02, -1.90, -113.57),
    330: (144.88, 82.70, -8.69, -0.84, -49.36, -176.39),
}

# AME 352 course notes: 5, 2, 6, 4 (ground, crank, coupler, rocker), 120 deg, 1 rad/s, -1 rad/s2.
# Right as printed: coupler and rocker angle deg, coupler and rocker rad/s.
AME_352 = (21.964, 96.250, 0.1395, 0.5143)
# The printed angular accelerations 0.0041 and -0.6865 lose a sign in the right-hand side.
AME_352_ALPHA = (-0.000228, -0.631037)
# Coupler point 5.5 at 22.5 deg: position, velocity; the printed acceleration (2.6399, -0.7908) inherits the slip.
AME_352_POINT = (2.9253 + 5.5846j, -2.2693 - 0.4526j, 2.6566 - 0.8079j)

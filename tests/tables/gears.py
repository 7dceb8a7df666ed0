"""Gear numbers worked out by rolling the rack by brute force, and textbook limits."""

# Module 2, ISO 53 A rack, no shift: radius where the involute begins, mm. 12 teeth are undercut.
FORM_RADIUS = {24: 22.675877531160143, 12: 11.302702044909595}

# Same rack: thickness of the tooth at its tip, modules.
TIP_THICKNESS = {24: 0.7156, 12: 0.6209, 5: 0.4175}

# z = 2 / sin^2(alpha): least tooth count without undercut for a flank one module deep.
UNDERCUT_LIMIT = {14.5: 31.9029, 20: 17.0973, 25: 11.1978}

# 20 deg, addendum 1 module, no shift: teeth of the pair and contact ratio.
CONTACT_RATIO = {(17, 17): 1.5148, (20, 40): 1.6352, (24, 24): 1.6019}

# A worked example of a shifted pair, its tips shortened to keep the clearance; KHK's gear handbook.
SHIFTED_PAIR = {
    "module": 3,
    "teeth": (12, 24),
    "profile_shift": (0.6, 0.36),
    "working_pressure_angle_deg": 26.0886,
    "centre_distance": 56.4999,
    "tip_diameter": (44.840, 79.400),
    "root_diameter": (32.100, 66.660),
    "base_diameter": (33.8289, 67.6579),
    "contact_ratio": 1.202,
}

# Rings of 50 teeth with pinions without shift: teeth of the pinion, shift of the ring, working pressure angle in
# deg, centre distance in modules; the same handbook.
INTERNAL_PAIRS = [
    (49, 1.00, 61.0605, 0.971),
    (47, 0.40, 37.4155, 1.775),
    (45, 0.20, 28.2019, 2.666),
    (43, 0.06, 22.3755, 3.557),
]

# Span over 3 teeth of 20, module 2, 20 deg, mm.
SPAN = 15.321

# Module 10, 12 teeth, shift 0.3, tips 13 mm above the pitch circle: thickness along the arc and the chord, mm, half
# the angle that it takes, deg, and the height of the tip above the chord, mm.
CHORDAL = {"arc": 17.8918, "half_angle_deg": 8.5427, "chord": 17.8256, "height": 13.6657}

"""Gear numbers worked out by rolling the rack by brute force, and textbook limits."""

# Module 2, ISO 53 A rack, no shift: radius where the involute begins, mm. 12 teeth are undercut.
FORM_RADIUS = {24: 22.675877531160143, 12: 11.302702044909595}

# Same rack: thickness of the tooth at its tip, modules.
TIP_THICKNESS = {24: 0.7156, 12: 0.6209, 5: 0.4175}

# z = 2 / sin^2(alpha): least tooth count without undercut for a flank one module deep.
UNDERCUT_LIMIT = {14.5: 31.9029, 20: 17.0973, 25: 11.1978}

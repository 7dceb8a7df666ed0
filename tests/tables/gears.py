"""Gear numbers worked out by rolling the rack by brute force, and textbook limits."""

# Module 2, ISO 53 A rack, no shift: radius where the involute begins, mm. 12 teeth are undercut.
FORM_RADIUS = {24: 22.675877531160143, 12: 11.302702044909595}

# Same rack: thickness of the tooth at its tip, modules.
TIP_THICKNESS = {24: 0.7156, 12: 0.6209, 5: 0.4175}

# 20 deg, addendum 1 module, no shift: teeth of the pair and contact ratio.
CONTACT_RATIO = {(17, 17): 1.5148, (20, 40): 1.6352, (24, 24): 1.6019}

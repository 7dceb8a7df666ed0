"""Linkages of a wanted swing or stroke: crank-rockers, double rockers, slider-cranks."""

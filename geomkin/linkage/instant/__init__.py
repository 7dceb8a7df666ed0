"""The geometry of a motion at an instant: centres, centrodes, curvature, polygons."""

"""Linkages that carry a body through poses: dyads, curves of their points, defects, whole linkages."""

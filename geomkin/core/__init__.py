"""Shared by all of geomkin: errors, validation, names, reprs, progress, processes."""

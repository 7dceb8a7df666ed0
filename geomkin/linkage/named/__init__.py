"""Linkages that have a name: their sizes, and nothing else."""

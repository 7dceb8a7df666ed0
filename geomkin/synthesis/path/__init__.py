"""Linkages whose coupler point goes through given points."""

"""Gears with teeth of any form, and the mates that they shape."""

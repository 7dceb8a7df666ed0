"""`python -m geomkin`."""

from .cli import main

main()

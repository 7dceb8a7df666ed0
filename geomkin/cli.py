"""The `geomkin` command's front door: light, so that help and errors come at once."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line; never a traceback for what a user can cause."""
    try:
        _calm()
        from .commands import cli

        cli()
    except KeyboardInterrupt:
        sys.exit(130)
    except BrokenPipeError:
        # The reader of our output left (`geomkin list | head`): nothing more to say, not even at exit.
        sys.stderr.close()
        sys.exit(141)
    except Exception as error:
        # What is refused on purpose is told elsewhere; this is ours to mend, and a traceback helps no user.
        sys.exit(f"geomkin failed by a fault of its own ({type(error).__name__}: {error}); please report the recipe")


def _calm() -> None:
    """Settings for a short process, before anything heavy is loaded."""
    import gc
    import os

    # NumPy's linear algebra would start a thread for every core; nothing here multiplies matrices.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Importing makes objects that stay: collecting among them every 700 costs a tenth of the run.
    gc.set_threshold(100_000)


if __name__ == "__main__":
    main()

"""The front door of the `geomkin` command and of `python -m geomkin`: light, so that help and errors come at once."""

from __future__ import annotations

import io
import sys
from contextlib import suppress
from typing import NoReturn


def main() -> None:
    """Run the command line; never a traceback for what a user can cause."""
    try:
        _calm()
        import click

        try:
            from .cli import cli
            from .core.errors import GeomkinError, harmless

            try:
                sys.exit(cli(standalone_mode=False))
            except GeomkinError as error:
                sys.exit(str(error))
        except click.ClickException as error:
            told = io.StringIO()
            error.show(told)
            sys.stderr.writelines(f"{harmless(line)}\n" for line in told.getvalue().splitlines())
            sys.exit(error.exit_code)
        except click.Abort:
            _stop()
    except KeyboardInterrupt:
        # One that came before there was a handler for it.
        _stop()
    except BrokenPipeError:
        # The reader of our output left (`geomkin list | head`): nothing more to say, not even at exit.
        sys.stderr.close()
        sys.exit(141)
    except OSError as error:
        sys.exit(f"geomkin cannot go on: {error.strerror or error}")
    except Exception as error:
        # What is refused on purpose is told elsewhere; this is ours to mend, and a traceback helps no user.
        fault = harmless(f"{type(error).__name__}: {error}")
        sys.exit(f"geomkin failed by a fault of its own ({fault}); please report the recipe")
    finally:
        import gc

        # The interpreter looks once more through all objects for rings of them when it ends: a fifth of a short run,
        # for memory that goes with the process.
        gc.freeze()


def _calm() -> None:
    """Settings for a short process, before anything heavy is loaded."""
    import signal

    # Ctrl-C ends the process itself: as an exception it would be swallowed by libraries that try their own optional
    # imports.
    signal.signal(signal.SIGINT, _stop)
    import gc
    import os

    # NumPy's linear algebra would start a thread for every core; nothing here multiplies matrices.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Looking through every package there is for plugins of the validator takes longer, the more there are.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # Importing makes objects that stay: collecting among them every 700 costs a tenth of the run, every 100 000 still
    # 7 %. Larger, and what many recipes leave behind piles up in the memory.
    gc.set_threshold(1_000_000)


def _stop(*_: object) -> NoReturn:
    """End at once, with a line and a terminal's cursor back: files are written whole or not at all."""
    import os

    # Not by the stream, which may be in the middle of a line itself.
    with suppress(OSError):
        os.write(2, b"\x1b[?25h\n" if os.isatty(2) else b"")
        os.write(2, b"geomkin was stopped; nothing is half written\n")
    os._exit(130)


if __name__ == "__main__":
    main()

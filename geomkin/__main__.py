"""The front door of the `geomkin` command and of `python -m geomkin`: light, so that help and errors come at once."""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
from contextlib import suppress
from typing import NoReturn


def main() -> None:
    """Run the command line; never a traceback for what a user can cause."""
    try:
        _settings()
        import click

        try:
            from .cli import cli
            from .core.errors import GeomkinError, harmless

            try:
                sys.exit(cli(standalone_mode=False))
            except GeomkinError as error:
                sys.exit(str(error))
        except click.ClickException as error:
            message = io.StringIO()
            error.show(message)
            sys.stderr.writelines(f"{harmless(line)}\n" for line in message.getvalue().splitlines())
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
        # Refusals are reported above; this is our own fault, and a traceback helps no user.
        fault = harmless(f"{type(error).__name__}: {error}")
        sys.exit(f"internal error ({fault}); please report it with this recipe")
    finally:
        # Otherwise the interpreter searches all objects for cycles when it ends: a tenth of a short run.
        gc.freeze()


def _settings() -> None:
    """Settings for a short process, before anything heavy is loaded."""
    # Ctrl-C ends the process itself: as an exception it would be swallowed by libraries that try their own optional
    # imports.
    signal.signal(signal.SIGINT, _stop)
    # With more threads, sums of NumPy's linear algebra have other last digits.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # The many objects that imports make stay: searching them for garbage takes a tenth of a short run.
    gc.set_threshold(1_000_000)


def _stop(*_: object) -> NoReturn:
    """End at once, with a line and a terminal's cursor back: files are written whole or not at all."""
    # Not by the stream, which may be in the middle of a line itself.
    with suppress(OSError):
        os.write(2, b"\x1b[?25h\n" if os.isatty(2) else b"")
        os.write(2, b"geomkin was stopped; nothing is half written\n")
    os._exit(130)


if __name__ == "__main__":
    main()

"""`gaitdisc` and `python -m gaitdisc`: Ctrl-C ends both with exit code 130, from the first import to the last line."""

from __future__ import annotations

import os
import signal
import sys
import threading
from io import TextIOWrapper
from types import FrameType

STOPPED = 130
AGAIN_S = 0.05  # so long does an interrupt wait for a module that is being loaded


def main() -> None:
    """Run the command line; Ctrl-C never shows a traceback, and a character that the terminal lacks becomes "?"."""
    hears = signal.getsignal(signal.SIGINT) is signal.default_int_handler  # a shell's background job does not
    if hears:
        signal.signal(signal.SIGINT, _end)
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    from gaitdisc.cli import main as command_line

    if hears:
        sys.unraisablehook = _hear_again
        signal.signal(signal.SIGINT, _interrupt)
    try:
        command_line()
    except KeyboardInterrupt:  # a second one, while the first was obeyed
        sys.exit(STOPPED)
    finally:
        if hears:
            signal.signal(signal.SIGINT, _end)


def _end(*_: object) -> None:
    os._exit(STOPPED)  # before and after all work: nothing is half written


def _interrupt(_: int, frame: FrameType | None) -> None:
    """Interrupt what runs, but not a module that is being loaded: compiled ones swallow it and the run goes on."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return _repeat()
        frame = frame.f_back
    raise KeyboardInterrupt


def _hear_again(lost: sys.UnraisableHookArgs) -> None:
    """Repeat an interrupt that came where no exception can be raised."""
    _repeat() if isinstance(lost.exc_value, KeyboardInterrupt) else sys.__unraisablehook__(lost)


def _repeat() -> None:
    """Send the interrupt once more, to the main thread, so that it ends a wait as well."""
    if sys.platform == "win32":
        timer = threading.Timer(AGAIN_S, signal.raise_signal, (signal.SIGINT,))
    else:
        timer = threading.Timer(AGAIN_S, signal.pthread_kill, (threading.main_thread().ident, signal.SIGINT))
    timer.daemon = True
    timer.start()


if __name__ == "__main__":
    main()

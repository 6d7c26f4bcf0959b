"""What a command's exit code says; 0 is done and 2 is wrong usage, as everywhere."""

from __future__ import annotations

REFUSED = 1  # a sentence says what was needed, what was found and what to do
SOME_REFUSED = 3  # done, but some trials or participants were refused and are listed
ENDED = 143  # by the system (SIGTERM)
STOPPED = 130  # by the person at the keyboard; the same command goes on

"""`python -m gaitdisc` is `gaitdisc`."""

from gaitdisc.cli import main

main()

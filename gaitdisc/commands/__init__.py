"""One file a command of `gaitdisc`; `gaitdisc/cli.py` says which there are."""

"""The library: what a script calls, one verb a thing, with plain arguments.

`import gaitdisc as gd` gives these names. Imports every room but commands.
"""

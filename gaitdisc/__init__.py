"""Gaitdisc: where a simulation or a model of walking and measured gait disagree, and what the difference is."""

__version__ = "0.1.0"

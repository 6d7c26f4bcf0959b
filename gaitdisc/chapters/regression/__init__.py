"""Fits that the dissertation compares: SINDy, dynamic mode decomposition, Gaussian process; each is a `Model`."""

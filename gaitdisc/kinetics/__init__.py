"""Kinetics: from ground forces and segments to joint moments and powers: platforms, inertia, inverse dynamics.

Imports kinematics, signals and what is below them.
"""

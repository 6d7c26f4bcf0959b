"""Kinematics: from markers to the body's motion: marker sets, joint centres, segments, joint angles.

Nouns: `MarkerSet`, `Calibration`, `Pose`, `Motion`. Imports recordings and the ground.
"""

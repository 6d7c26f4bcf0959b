"""Models: networks and their trainer, ridge regression, Fourier features.

The only home of torch. Imports recordings and the ground.
"""

"""Signals: what is computed from raw channels before a fit: filters, derivatives, contacts, strides, quality.

Imports recordings and the ground.
"""

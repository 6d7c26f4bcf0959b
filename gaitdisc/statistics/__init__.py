"""Statistics: signed rank, Holm-Sidak, permutation clusters, R2, residuals over the stride, filter nulls.

The only home of pingouin and statsmodels. Imports recordings and the ground.
"""

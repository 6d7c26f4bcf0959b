import numpy as np
import pytest
from chapter3.gaussian_process import KERNELS, kernel
from sklearn.gaussian_process.kernels import RBF, Matern

PEERS = {
    "squared_exponential": RBF,
    "matern_3_2": lambda lengths: Matern(lengths, nu=1.5),
    "matern_5_2": lambda lengths: Matern(lengths, nu=2.5),
}


@pytest.mark.parametrize("kind", KERNELS)
def test_every_kernel_is_that_of_scikit_learn(kind):
    rng = np.random.default_rng(0)
    a, b, lengths = rng.normal(size=(7, 3)), rng.normal(size=(5, 3)), np.array([0.5, 1.0, 3.0])
    assert kernel(kind, a, b, lengths) == pytest.approx(PEERS[kind](lengths)(a, b), abs=1e-12)


@pytest.mark.parametrize("kind", KERNELS)
def test_every_kernel_is_positive(kind):
    x = np.random.default_rng(1).normal(size=(40, 2))
    assert np.linalg.eigvalsh(kernel(kind, x, x, np.ones(2))).min() > -1e-12

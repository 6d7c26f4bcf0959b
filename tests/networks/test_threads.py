from __future__ import annotations

import pytest
import torch
from threadpoolctl import threadpool_info

from gaitdisc.networks.threads import pinned_threads, torch_threads


def test_threads_are_as_before_also_after_an_error():
    before = torch.get_num_threads()
    with pytest.raises(RuntimeError), torch_threads(3):
        assert torch.get_num_threads() == 3
        raise RuntimeError
    assert torch.get_num_threads() == before


def blas_threads():
    return [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"]


def test_every_blas_is_pinned_and_let_go_again():
    before = blas_threads()
    with pytest.raises(RuntimeError), pinned_threads(1):
        assert set(blas_threads()) == {torch.get_num_threads()} == {1}
        raise RuntimeError
    assert blas_threads() == before

"""Against spm1d on the data sets that it publishes; skipped where it is not installed (extra `dev`)."""

import numpy as np
import pytest

from gaitdisc.statistics.cluster_test import PermutationPlan, one_sample_test, two_sample_test

spm1d = pytest.importorskip("spm1d")
EDGE = (
    1.5  # % of the stride: spm1d interpolates where the threshold is crossed, and its threshold has one percentile more
)
CASES = (
    "t1.Random",
    "t1.SimulatedPataky2015a",
    "t1.SimulatedPataky2015b",
    "tpaired.PlantarArchAngle",
    "t2.PlantarArchAngle",
)


def curves_of(case):
    kind, name = case.split(".")
    first, second = getattr(getattr(spm1d.data.uv1d, kind), name)().get_data()
    return kind, np.asarray(first, float), np.asarray(second, float)


def ours(kind, first, second):
    plan = PermutationPlan(permutations=5000)
    if kind == "t2":
        return two_sample_test(second[:, :, None], first[:, :, None], plan)  # spm1d: first minus second
    return one_sample_test((first - second)[:, :, None], plan)


def theirs(kind, first, second, module):
    tests = {"t1": "ttest", "tpaired": "ttest_paired", "t2": "ttest2"}
    return getattr(module, tests[kind])(first, second)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.filterwarnings("ignore")
def test_t_threshold_and_regions(case):
    np.random.seed(0)  # noqa: NPY002  spm1d draws its permutations from numpy's global state
    kind, first, second = curves_of(case)
    found = ours(kind, first, second)
    by_permutation = theirs(kind, first, second, spm1d.stats.nonparam)
    np.testing.assert_allclose(found.t[:, 0], by_permutation.z, atol=1e-8)
    inference = by_permutation.inference(
        0.05, two_tailed=True, iterations=-1 if by_permutation.nPermUnique < 5000 else 5000
    )
    limits = np.abs(np.atleast_1d(inference.zstar))
    assert found.threshold == pytest.approx(limits.max(), rel=0.03)
    assert len(found.clusters) == len(inference.clusters)
    for cluster, spm in zip(found.clusters, inference.clusters, strict=True):
        assert (cluster.first, cluster.last) == pytest.approx(spm.endpoints, abs=EDGE)
        assert cluster.p == pytest.approx(spm.P, abs=0.02)


@pytest.mark.parametrize("case", ["t1.SimulatedPataky2015b", "tpaired.PlantarArchAngle", "t2.PlantarArchAngle"])
@pytest.mark.filterwarnings("ignore")
def test_random_fields_agree_where_they_are_smooth(case):
    kind, first, second = curves_of(case)
    found = ours(kind, first, second)
    by_field = theirs(kind, first, second, spm1d.stats).inference(0.05, two_tailed=True)
    assert found.threshold == pytest.approx(by_field.zstar, rel=0.10)
    [cluster], [spm] = found.clusters, by_field.clusters
    assert (cluster.first, cluster.last) == pytest.approx(spm.endpoints, abs=EDGE)
    assert cluster.p == pytest.approx(spm.P, abs=0.04)

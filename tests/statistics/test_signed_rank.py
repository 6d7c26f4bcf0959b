import itertools

import numpy as np
import pingouin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import PermutationMethod, wilcoxon

from gaitdisc.errors import ComparisonError, ShapeError
from gaitdisc.statistics.holm_sidak import step_levels
from gaitdisc.statistics.signed_rank import exact_p, shift_interval, signed_rank, smallest_p

P_AT_11 = {
    0: 0.000977, 1: 0.00195, 2: 0.00293, 3: 0.00488, 4: 0.00684, 5: 0.00977,
    6: 0.0137, 7: 0.0186, 8: 0.0244, 9: 0.0322, 10: 0.0420, 11: 0.0537,
}  # fmt: skip


def with_sum(w, n=11):
    """Differences 1 to n whose negative ranks sum to w."""
    chosen = next(set(c) for k in range(n) for c in itertools.combinations(range(1, n + 1), k) if sum(c) == w)
    return np.array([-i if i in chosen else i for i in range(1, n + 1)], float)


def enumerated(differences):
    """Plain statement of the definition: all signs of all ranks."""
    kept = [d for d in differences if d != 0]
    ranks = [sum((abs(e) < abs(d)) + (abs(e) == abs(d)) / 2 for e in kept) + 0.5 for d in kept]
    total = sum(ranks)
    seen = min(s := sum(r for r, d in zip(ranks, kept, strict=True) if d > 0), total - s)
    sums = [sum(r for r, u in zip(ranks, ups, strict=True) if u) for ups in itertools.product((0, 1), repeat=len(kept))]
    return min(1.0, sum(min(s, total - s) <= seen for s in sums) / len(sums))


@pytest.mark.parametrize(("w", "p"), P_AT_11.items())
def test_the_table_of_eleven_pairs(w, p):
    found = signed_rank(np.zeros(11), with_sum(w))
    assert (found.n, found.zeros, found.w, found.ties) == (11, 0, w, False)
    assert found.p == pytest.approx(p, rel=6e-3)


def test_the_printed_p_of_the_dissertation():
    assert f"{exact_p(with_sum(10)):.4f}" == "0.0420"
    assert f"{smallest_p(11):.6f}" == "0.000977"


def test_zeros_are_dropped_and_counted():
    found = signed_rank(np.zeros(11), np.array([0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8.0]))
    assert (found.n, found.zeros) == (8, 3)
    assert found.p == 2 / 2**8
    assert found.median == 3.0


def test_no_difference_at_all_is_no_evidence():
    found = signed_rank(np.ones(6), np.ones(6))
    assert (found.n, found.zeros, found.w, found.p, found.shift) == (0, 6, 0.0, 1.0, 0.0)
    assert np.isnan(found.rank_biserial)


@given(st.lists(st.integers(-4, 4), min_size=1, max_size=9))
def test_p_is_the_share_of_all_signs(differences):
    assert exact_p(np.array(differences, float)) == pytest.approx(enumerated(differences), abs=1e-12)


def test_p_is_that_of_scipy_where_scipy_is_exact():
    rng = np.random.default_rng(0)
    for n in range(1, 30):
        d = rng.normal(0.3, 1, n)
        assert exact_p(d) == wilcoxon(d, method="exact").pvalue
        assert exact_p(d) == pytest.approx(exact_p(-d))


def test_ties_are_exact_where_scipy_is_not():
    d = np.array([1, 1, 2, 2, 3, -3, 4, 5, 6, 7.0])
    every_sign = wilcoxon(d, method=PermutationMethod(n_resamples=2**11)).pvalue
    assert exact_p(d) == pytest.approx(every_sign, abs=1e-12)
    assert wilcoxon(d, method="exact").pvalue != pytest.approx(every_sign, rel=0.05)
    assert signed_rank(np.zeros(10), d).ties


def test_missing_numbers_are_refused_unless_explained():
    first, second = np.zeros(7), np.arange(1.0, 8)
    second[2] = np.nan
    with pytest.raises(ComparisonError, match=r"1 of 7 pairs.*3\)"):
        signed_rank(first, second)
    found = signed_rank(first, second, left_out={2: "P03: no switch"})
    assert (found.n, found.p, found.left_out) == (6, 2 / 2**6, ("P03: no switch",))


def test_pairs_must_be_pairs():
    with pytest.raises(ShapeError, match=r"\(3,\).*\(4,\)"):
        signed_rank(np.zeros(3), np.zeros(4))
    with pytest.raises(ComparisonError, match=r"least one pair.*1; excluded: 1"):
        signed_rank([1.0], [2.0], left_out={0: "refused"})


@given(st.lists(st.floats(-5, 5).filter(lambda x: abs(x) > 1e-6), min_size=2, max_size=12, unique_by=abs))
def test_effect_size_is_the_share_of_ranks(differences):
    d = np.array(differences)
    found = signed_rank(np.zeros(len(d)), d)
    total = len(d) * (len(d) + 1) / 2
    assert abs(found.rank_biserial) == pytest.approx(1 - 2 * found.w / total)
    back = signed_rank(d, np.zeros(len(d)))
    assert back.rank_biserial == pytest.approx(-found.rank_biserial)
    assert (back.w, back.shift, back.low, back.high) == pytest.approx((found.w, -found.shift, -found.high, -found.low))


def test_pingouin_agrees():
    rng = np.random.default_rng(3)
    first, second = rng.normal(size=(2, 11))
    theirs = pingouin.wilcoxon(second, first)
    found = signed_rank(first, second)
    assert found.p == pytest.approx(theirs.filter(regex="^p").iloc[0, 0])
    assert found.w == theirs.filter(regex="^W").iloc[0, 0]
    assert found.rank_biserial == pytest.approx(theirs["RBC"].iloc[0])


def test_the_shift_and_its_interval_by_hand():
    d = np.array([1.1, 2.2, 3.3, 4.4, 5.5, 6.6])  # n = 6: only the outermost mean lies outside, p = 2/64
    shift, low, high = shift_interval(d)
    assert (shift, low, high) == pytest.approx((3.85, 1.1, 6.6))
    at_11 = shift_interval(np.arange(1.0, 12) ** 2)
    means = np.sort([(i**2 + j**2) / 2 for i in range(1, 12) for j in range(i, 12)])
    assert at_11 == ((means[32] + means[33]) / 2, means[10], means[-11])  # P(W <= 10) = .021: eleven at each end


@pytest.mark.parametrize("n", [6, 9, 12])
def test_the_interval_holds_what_the_test_does_not_reject(n):
    d = np.random.default_rng(n).normal(1, 1, n)
    _, low, high = shift_interval(d)
    for inside in (low + 1e-9, high - 1e-9):
        assert exact_p(d - inside) > 0.05
    for outside in (low - 1e-9, high + 1e-9):
        assert exact_p(d - outside) <= 0.05


def test_five_pairs_have_no_interval():
    assert shift_interval(np.arange(1.0, 6))[1:] == (-np.inf, np.inf)
    assert smallest_p(5) > 0.05 > smallest_p(6)


def test_the_interval_covers_the_truth():
    rng = np.random.default_rng(5)
    held = [low <= 0.3 <= high for _, low, high in (shift_interval(rng.normal(0.3, 1, 11)) for _ in range(2000))]
    assert np.mean(held) == pytest.approx(1 - 2 * 43 / 2048, abs=0.012)  # 43 of the 2048 signs have W+ <= 10


def test_eleven_pairs_carry_the_dissertations_steps():
    assert smallest_p(11) < step_levels(52)[0]
    assert smallest_p(11) > step_levels(53)[0]

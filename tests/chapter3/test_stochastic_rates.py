import numpy as np
from chapter3.record import StochasticRates


def test_without_pushes_it_is_the_system_and_with_them_only_the_pushed_state_leaves_it(van_der_pol):
    start = van_der_pol.start[None]
    alone = van_der_pol.true.run(start, 0.01, 50)
    assert np.allclose(StochasticRates(van_der_pol.true, (0.0, 0.0)).run(start, 0.01, 50), alone, rtol=0, atol=1e-9)
    pushed = StochasticRates(van_der_pol.true, (0.0, 0.1), 3).run(start, 0.01, 50)
    assert pushed[0, 1, 0] == alone[0, 1, 0]
    assert pushed[0, 1, 1] != alone[0, 1, 1]


def test_a_seed_gives_the_same_pushes_and_the_rates_are_those_without(van_der_pol):
    start = van_der_pol.start[None]
    one, same, other = (StochasticRates(van_der_pol.true, (0.0, 0.1), seed).run(start, 0.01, 20) for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
    assert np.array_equal(StochasticRates(van_der_pol.true, (0.0, 0.1))(start), van_der_pol.true(start))

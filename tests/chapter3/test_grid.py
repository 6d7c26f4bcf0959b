from chapter3.cell import grid
from chapter3.record import Conditions


def test_cells_come_in_order_and_one_seed_is_enough_without_noise(van_der_pol):
    computed = []
    chosen = (("sindy",), ("dynamics", "state"))
    found = grid(van_der_pol, Conditions(duration_s=10.0), (0.0, 0.01), (0, 1), chosen, computed=computed.append)
    assert [(c.noise, c.seed, c.approach) for c in found] == [
        (0.0, 0, "dynamics"), (0.0, 0, "state"), (0.01, 0, "dynamics"), (0.01, 0, "state"), (0.01, 1, "dynamics"),
        (0.01, 1, "state"),
    ]  # fmt: skip
    assert computed == list(found)

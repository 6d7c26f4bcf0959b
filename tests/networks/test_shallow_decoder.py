import torch

from gaitdisc.networks.shallow_decoder import ShallowDecoder


def test_it_has_two_hidden_layers_and_its_readout_is_linear():
    network = ShallowDecoder(3, 18, 350, 400)
    assert sum(w.numel() for w in network.parameters()) == 4 * 350 + 351 * 400 + 401 * 18
    x = torch.rand(5, 3)
    torch.testing.assert_close(network(x), network.readout(network.features(x)))

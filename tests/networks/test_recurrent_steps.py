import numpy as np
import torch
from torch import nn

from gaitdisc.networks.recurrent_steps import decoded, gru_step, lstm_step
from gaitdisc.networks.shallow_decoder import ShallowDecoder


def laid_out(cell):
    return (
        tuple(np.ascontiguousarray(w.detach().numpy().T) for w in (cell.weight_ih, cell.weight_hh)),
        tuple(b.detach().numpy() for b in (cell.bias_ih, cell.bias_hh)),
    )


def test_one_step_of_torchs_cells():
    torch.manual_seed(0)
    x, h, c = torch.randn(5, 3).double(), torch.randn(5, 4).double(), torch.randn(5, 4).double()
    gru, lstm = nn.GRUCell(3, 4).double(), nn.LSTMCell(3, 4).double()
    np.testing.assert_allclose(gru_step(x.numpy(), h.numpy(), *laid_out(gru)), gru(x, h).detach(), atol=1e-14)
    after, kept = lstm_step(x.numpy(), (h.numpy(), c.numpy()), *laid_out(lstm))
    wanted = [part.detach().numpy() for part in lstm(x, (h, c))]
    np.testing.assert_allclose([after, kept], wanted, atol=1e-14)


def test_states_stay_bounded_however_far_out_a_reading_is():
    torch.manual_seed(0)
    weights, offsets = laid_out(nn.GRUCell(3, 4).double())
    after = gru_step(np.full((1, 3), 1e6), np.zeros((1, 4)), weights, offsets)
    assert np.isfinite(after).all() and np.abs(after).max() <= 1.0


def test_the_decoder_is_torchs():
    torch.manual_seed(0)
    network = ShallowDecoder(6, 3).double()
    layers = (network.first, network.second, network.readout)
    weights = tuple(np.ascontiguousarray(layer.weight.detach().numpy().T) for layer in layers)
    offsets = tuple(layer.bias.detach().numpy() for layer in layers)
    x = torch.randn(6).double()
    np.testing.assert_allclose(decoded(x.numpy(), weights, offsets), network(x[None])[0].detach(), atol=1e-13)

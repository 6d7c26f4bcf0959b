"""The dissertation's networks: feed-forward (section 4.2.2), and SHRED with its shallow decoder (section 2.3.5)."""

from typing import cast

import torch
from torch import Tensor, nn

from gaitdisc.errors import ShapeError

CELLS = {"gru": nn.GRU, "lstm": nn.LSTM}
AT_ONCE = 8192  # windows that are read side by side; more need more memory and no less time


class FeedForward(nn.Module):
    """Three layers: log-sigmoid, radial basis exp(-n^2) with n = Wx + b, pure linear.

    The radial basis is that of a feed-forward layer: n is an inner product, not a distance to a centre.

    nodes: nodes of either hidden layer; the dissertation has 64
    Source: Ebers 2023, section 4.2.2: "each layer had 64 nodes". We read 49-64-64-8, with 7,880 parameters; a third
        layer of 64 linear nodes before the eight outputs would describe the same functions.

    >>> sum(weights.numel() for weights in FeedForward(49, 8).parameters())
    7880
    """

    def __init__(self, inputs: int, outputs: int, nodes: int = 64) -> None:
        super().__init__()
        self.sigmoid = nn.Linear(inputs, nodes)
        self.radial = nn.Linear(nodes, nodes)
        self.readout = nn.Linear(nodes, outputs)

    def features(self, x: Tensor) -> Tensor:
        """What the linear layer reads, (sample, node), of scaled inputs (sample, input)."""
        n = self.radial(torch.sigmoid(self.sigmoid(x)))
        return torch.exp(-n * n)

    def forward(self, x: Tensor) -> Tensor:
        """Scaled outputs (sample, output) of scaled inputs (sample, input)."""
        return self.readout(self.features(x))


class Shred(nn.Module):
    """GRU or LSTM over a window of the sensors' history, its last hidden state decoded.

    inputs, outputs: numbers of a window (readings times sensors, oldest first), and states
    sensors: sensors; `inputs` is a multiple of it
    layers: recurrent layers; the dissertation's code has two of 64
    first, second: nodes of the decoder's hidden layers
    masked: whether readings may be missing (NaN): the network then reads 0, the mean, in their place, and beside every
        reading whether it is missing
    Source: Williams, Zahn and Kutz 2024, Sensing with shallow recurrent decoder networks. Its code has two LSTM layers
        of 64 and a decoder of 350 and 400; one GRU layer is the default here, since it learns faster and errs no more.

    >>> Shred(75, 18, 3)(torch.zeros(2, 75)).shape
    torch.Size([2, 18])
    """

    def __init__(  # noqa: PLR0913, PLR0917 a layer has as many sizes
        self,
        inputs: int,
        outputs: int,
        sensors: int,
        nodes: int = 64,
        layers: int = 1,
        cell: str = "gru",
        masked: bool = False,
        first: int = 128,
        second: int = 128,
    ) -> None:
        super().__init__()
        if inputs % sensors:
            raise ShapeError(
                f"a window must have the same number of samples from each of its {sensors} sensors",
                f"it has {inputs} numbers",
                "Give the number of sensors that the windows were made with.",
            )
        self.sensors, self.cell, self.masked = sensors, cell, masked
        self.recurrent = CELLS[cell](2 * sensors if masked else sensors, nodes, layers, batch_first=True)
        self.decoder = ShallowDecoder(nodes, outputs, first, second)

    @property
    def readout(self) -> nn.Linear:
        """Last layer, which is linear."""
        return cast(nn.Linear, self.decoder.readout)

    def latent(self, x: Tensor) -> Tensor:
        """Last hidden state (window, node) of the recurrent layers (Eq. 5.3), of windows (window, reading * sensor)."""
        history = x.reshape(len(x), -1, self.sensors)
        if self.masked:
            missing = history.isnan()
            history = torch.cat([history.masked_fill(missing, 0.0), missing.to(history.dtype)], dim=2)
        return torch.cat([self.recurrent(part)[0][:, -1] for part in history.split(AT_ONCE)])

    def features(self, x: Tensor) -> Tensor:
        """What the linear layer reads, (window, node), of scaled windows (window, reading * sensor)."""
        return self.decoder.features(self.latent(x))

    def forward(self, x: Tensor) -> Tensor:
        """Scaled states (window, state) of scaled windows (window, reading * sensor)."""
        return self.decoder.readout(self.features(x))


class ShallowDecoder(nn.Module):
    """Two layers of rectified linear nodes, and a linear one.

    first, second: nodes of the hidden layers; the code of SHRED has 350 and 400
    Source: Erichson et al. 2020, Shallow neural networks for fluid flow reconstruction with limited sensors.

    >>> ShallowDecoder(3, 18)(torch.zeros(2, 3)).shape
    torch.Size([2, 18])
    """

    def __init__(self, inputs: int, outputs: int, first: int = 128, second: int = 128) -> None:
        super().__init__()
        self.first = nn.Linear(inputs, first)
        self.second = nn.Linear(first, second)
        self.readout = nn.Linear(second, outputs)

    def features(self, x: Tensor) -> Tensor:
        """What the linear layer reads, (sample, node), of scaled inputs (sample, input)."""
        return torch.relu(self.second(torch.relu(self.first(x))))

    def forward(self, x: Tensor) -> Tensor:
        """Scaled states (sample, state) of scaled inputs (sample, input)."""
        return self.readout(self.features(x))

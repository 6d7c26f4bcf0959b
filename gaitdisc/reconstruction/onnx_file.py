"""A fitted reconstructor as an ONNX file: windows in, states out, both in their units."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc._version import __version__
from gaitdisc.errors import SchemaError
from gaitdisc.models.fourier_ridge import FourierRidge
from gaitdisc.reconstruction.model_folder import SensingModel
from gaitdisc.reconstruction.window_model import Ensemble
from gaitdisc.recording import Scale
from gaitdisc.whole_file import whole_file

if TYPE_CHECKING:
    from gaitdisc.models.trained_network import TrainedNetwork

OPSET = 17
WINDOW, STATES = "window", "states"
ORDERS = {"gru": ("GRU", (1, 0, 2)), "lstm": ("LSTM", (0, 3, 1, 2))}  # of torch's gates in ONNX's operator


def write_onnx(model: SensingModel, path: Path) -> None:
    """Write a model as an ONNX graph.

    Its input `window` (window, reading * sensor) holds the readings as `reconstruction.windows` does, oldest first and
    sensors side by side, in the sensors' units; NaN where a model takes missing readings. Its output `states`
    (window, state) is in the states' units. Names, units, rate and lags stand in the file's metadata.

    model: what to write; ridge regression in double precision, networks in single, as they are computed here
    path: of an `.onnx` file; written whole or not at all
    """
    try:
        from onnx import checker, helper
    except ImportError as error:
        raise SchemaError(
            "ONNX export requires the package onnx", "it is not installed", "Install it: pip install 'gaitdisc[onnx]'."
        ) from error
    fitted = model.reconstructor.model
    graph = _Graph(helper, np.float64 if isinstance(fitted, FourierRidge) else np.float32)
    x = graph.add("Cast", WINDOW, to=graph.tensor_type(graph.number))
    if isinstance(fitted, FourierRidge):
        h = graph.scaled(x, fitted.x_scale)
        if len(fitted.phases):
            cosines = graph.add("Cos", graph.linear(h, fitted.frequencies, fitted.phases))
            scaled = graph.add("Mul", cosines, graph.constant(np.array(np.sqrt(2 / len(fitted.phases)))))
            h = graph.add("Concat", h, scaled, axis=1)
        states = graph.unscaled(graph.linear(h, fitted.weights, fitted.offset), fitted.y_scale)
    elif isinstance(fitted, Ensemble):
        outputs = [_network(graph, member, x, model) for member in fitted.members]
        states = graph.add("Mean", *outputs)
    else:
        states = _network(graph, fitted, x, model)  # type: ignore[arg-type]
    graph.add("Cast", states, to=graph.tensor_type(np.float32), output=STATES)
    onnx_model = graph.whole(len(fitted.inputs), len(fitted.outputs))
    helper.set_model_props(onnx_model, _metadata(model))
    checker.check_model(onnx_model, full_check=True)
    with whole_file(path) as part:
        part.write_bytes(onnx_model.SerializeToString())


def _metadata(model: SensingModel) -> dict[str, str]:
    what = model.reconstructor.sensing
    count = len(what.sensors)
    return {
        "program": f"gaitdisc {__version__}",
        "kind": model.reconstructor.kind,
        "sensors": json.dumps(what.sensors),
        "sensor_units": json.dumps([channel.unit for channel in model.channels[:count]]),
        "states": json.dumps(what.states),
        "state_units": json.dumps([channel.unit for channel in model.channels[count:]]),
        "half_widths": json.dumps(model.half_widths.tolist()),
        "rate_hz": f"{what.rate_hz:g}",
        "readings": json.dumps({"spacing": what.lags.spacing, "ahead": what.lags.ahead,
                                "count": len(model.reconstructor.model.inputs) // count}),
    }  # fmt: skip


@dataclass
class _Graph:
    """Nodes and constants as they come."""

    helper: Any
    number: type
    nodes: list[Any] = field(default_factory=list)
    constants: list[Any] = field(default_factory=list)

    def tensor_type(self, number: type) -> int:
        return self.helper.np_dtype_to_tensor_dtype(np.dtype(number))

    def constant(self, values: NDArray[Any] | list[int]) -> str:
        kind = np.int64 if isinstance(values, list) else self.number
        array, name = np.ascontiguousarray(values, kind), f"c{len(self.constants)}"
        data = array.tobytes()
        self.constants.append(self.helper.make_tensor(name, self.tensor_type(kind), array.shape, data, raw=True))
        return name

    def add(self, operator: str, *inputs: str, output: str = "", outputs: int = 1, **attributes: Any) -> str:
        """Add a node; give back the name of its last output."""
        names = [output or f"n{len(self.nodes)}_{k}" for k in range(outputs)]
        self.nodes.append(self.helper.make_node(operator, list(inputs), names, **attributes))
        return names[-1]

    def whole(self, inputs: int, outputs: int) -> Any:
        single = self.tensor_type(np.float32)
        ends = [
            self.helper.make_tensor_value_info(name, single, [None, size])
            for name, size in ((WINDOW, inputs), (STATES, outputs))
        ]
        graph = self.helper.make_graph(self.nodes, "gaitdisc", ends[:1], ends[1:], self.constants)
        opset = [self.helper.make_opsetid("", OPSET)]
        return self.helper.make_model(graph, opset_imports=opset, ir_version=8)

    def scaled(self, x: str, scale: Scale) -> str:
        part = self.add("Sub", x, self.constant(scale.mean))
        return self.add("Mul", part, self.constant(1 / scale.sd))

    def unscaled(self, y: str, scale: Scale) -> str:
        part = self.add("Mul", y, self.constant(np.where(scale.constant, 0.0, scale.sd)))
        return self.add("Add", part, self.constant(scale.mean))

    def linear(self, x: str, weights: NDArray[Any], offset: NDArray[Any]) -> str:
        """Of weights (input, output)."""
        return self.add("Add", self.add("MatMul", x, self.constant(weights)), self.constant(offset))


def _network(graph: _Graph, model: TrainedNetwork, x: str, sensing_model: SensingModel) -> str:
    from gaitdisc.models.networks import Shred

    weights, h = model.weights(), graph.scaled(x, model.x_scale)
    prefix = ""
    if isinstance(model.network, Shred):
        h = _recurrent(graph, model.network, weights, h, len(sensing_model.reconstructor.sensing.sensors))
        prefix = "decoder."
    for name in ("first", "second"):
        h = graph.add("Relu", graph.linear(h, weights[f"{prefix}{name}.weight"].T, weights[f"{prefix}{name}.bias"]))
    states = graph.linear(h, weights[f"{prefix}readout.weight"].T, weights[f"{prefix}readout.bias"])
    return graph.unscaled(states, model.y_scale)


def _recurrent(graph: _Graph, shred: Any, weights: dict[str, NDArray[Any]], x: str, sensors: int) -> str:
    """Last state (window, node) of the last layer."""
    h = graph.add("Reshape", x, graph.constant([0, -1, sensors]))
    if shred.masked:
        missing = graph.add("IsNaN", h)
        known = graph.add("Where", missing, graph.constant(np.array(0.0)), h)
        h = graph.add("Concat", known, graph.add("Cast", missing, to=graph.tensor_type(graph.number)), axis=2)
    h = graph.add("Transpose", h, perm=[1, 0, 2])  # (reading, window, input)
    operator, order = ORDERS[shred.cell]
    extra: dict[str, Any] = {"linear_before_reset": 1} if shred.cell == "gru" else {}
    last = h
    for layer in range(shred.recurrent.num_layers):
        arrays = [
            np.concatenate([np.split(weights[f"recurrent.{word}_l{layer}"], len(order))[k] for k in order])
            for word in ("weight_ih", "weight_hh", "bias_ih", "bias_hh")
        ]
        constants = [graph.constant(array[None]) for array in (arrays[0], arrays[1], np.concatenate(arrays[2:]))]
        nodes = shred.recurrent.hidden_size
        last = graph.add(operator, h, *constants, outputs=2, hidden_size=nodes, **extra)
        h = graph.add("Squeeze", last.replace("_1", "_0"), graph.constant([1]))
    return graph.add("Squeeze", last, graph.constant([0]))

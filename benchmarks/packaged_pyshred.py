"""The packaged pyshred on one walk, run by `reconstruct.py` with the Python of an environment that has it.

    PYTHON benchmarks/packaged_pyshred.py VALUES.npy SENSORS EPOCHS

Its defaults, but for 100 lags (its 20 are a fifth of a second), 70/10/20 % in time, and compress=False: an SVD of so
few states saves nothing. Prints one line of JSON: processor time, epochs, RMSE over states of the last 20 %.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("values", "a .npy file: time by columns, sensors first", type=Path),
    argument("sensors", "how many of the columns are sensors", type=int),
    argument("epochs", "of the training", type=int),
)  # before the slow imports

import json
import time
from importlib.metadata import version

import numpy as np
import torch
from pyshred import SHRED, DataManager  # type: ignore[import-not-found]  # in an environment of its own

torch.set_num_threads(1)
values, sensors, epochs = np.load(GIVEN.values), GIVEN.sensors, GIVEN.epochs
manager = DataManager(lags=100, train_size=0.7, val_size=0.1, test_size=0.2)
manager.add_data(values[:, sensors:], "angles", measurements=values[:, :sensors], compress=False)
train, val, test = manager.prepare()
model = SHRED(sequence_model="LSTM", decoder_model="MLP", latent_forecaster=None)
begun = time.process_time()
model.fit(train, val, num_epochs=epochs, verbose=False)
spent = time.process_time() - begun
model.eval()
with torch.no_grad():
    states = manager.data_scaler.inverse_transform(model(test.X).numpy())
error = states - values[-len(states) :, sensors:]
rmse = float(np.sqrt(np.mean(error**2)))
print(json.dumps({"version": version("pyshred"), "epochs": epochs, "seconds": spent, "rmse_deg": rmse}))

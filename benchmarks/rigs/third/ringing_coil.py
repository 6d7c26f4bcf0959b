"""A coil and a capacitor ring after a pulse: voltage, 500 kHz; one pulse is learned, a weaker one is unseen."""

import numpy as np

REPOSITORY = "nicmontalti/RLC-Pulse"
COMMIT = "e0e41217aff747f516ff663d79cc6e685bd97b02"
FILES = {
    "data/Pulse_1-oscilloscope.csv": "73848c6121e4c980187c050baacaac2580d8bc00b7211a998f704b5c216013c7",
    "data/Pulse_2-oscilloscope.csv": "dc98535d5fffcb4df19a3dff943cb8da42a38b734d31ad85671d273b7f083f3f",
}


def read_trials(files):
    """Learned and unseen trials."""
    pulses = []
    for content in files.values():
        volts = np.array([line.split(b",")[2] for line in content.splitlines()[5:]], float)[8:248]
        pulses.append({"time": np.arange(240) * 2e-6, "volts": volts})
    return pulses[:1], pulses[1:]

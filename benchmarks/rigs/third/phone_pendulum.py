"""A phone swings on strings: rate by its gyroscope, 48 Hz; 2.9 s are learned, the next 1.9 s are unseen."""

import re

import numpy as np

REPOSITORY = "estmiguelplazas-web/Experimento-Phyphox---Pendulo-Simple"
COMMIT = "5fc59dcffe4b12e8cc3fd41251fd265ee44c36b8"
FILE = "Datos/Pndulo 2026-07-27 12-55-17.phyphox"
FILES = {FILE: "747a47ca356092871c194c14c24740851afb0665c25b9bc461e259e245a80e1f"}


def read_trials(files):
    """Learned and unseen trials."""
    stored = dict(re.findall(r'init="([^"]*)">(gyr\w+)<', files[FILE].decode())[::-1])
    stored = {name: np.array(values.split(","), float)[160:390] for values, name in stored.items()}
    swing = {"time": stored["gyr_time"], "rate": stored["gyrZ"]}
    return [{k: v[:140] for k, v in swing.items()}], [{k: v[140:] for k, v in swing.items()}]

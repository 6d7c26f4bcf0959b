"""A small electric car coasts to rest, in both directions of a road.

Speed once a second from four runs, three are learned.
"""

import numpy as np

REPOSITORY = "Abaiquni/Finding-Rolling-Resistance-for-Electric-Car"
COMMIT = "83b58542a8930455c18214c0cafab6b197d73e6b"
FILES = {
    "Data/Michelin60A.csv": "99322061badeb56d6d454cad7eaef9c3300b1f5eca1df55e761a421eb40b0db8",
    "Data/Michelin60B.csv": "17fe279d9e6e29c5f1944ae586d2cfb4c7d882e96a67abff2255de199e82c425",
    "Data/Michelin60B1.csv": "6f27443892b93a6a4f62bacd7916bba1e1382ea4e0f837be16ab0a6db3d6d5ca",
    "Data/Michelin60A1.csv": "119ef4364b937d8c5d6ee5683a917118562735a36f4605c7e903891bd380526e",
}


def read_trials(files):
    """Learned and unseen trials."""
    trials = []
    for content in files.values():
        speed = np.array(content.decode("utf-8-sig").split(), float) / 3.6
        end = np.argmax(speed < 1.0) if (speed < 1.0).any() else len(speed)
        trials.append({"time": np.arange(float(end)), "speed": speed[:end]})
    return trials[:3], trials[3:]

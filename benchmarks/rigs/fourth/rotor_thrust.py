"""The rotor of a small drone is switched on and off on a scale: commanded and measured thrust, every 20 ms.

The moment of the command was not recorded: it is taken as the sample before the reading moves; the commanded thrust is
where the reading rests. Two runs are learned, a third one is unseen.
"""

import io

import numpy as np

REPOSITORY = "peterkrull/quad"
COMMIT = "665344460b289ca199b904bcdfbd7a8c74917310"
FOLDER = "tests/thrust_response/"
FILES = {
    FOLDER + "0500_thrust_response.csv": "f9c66ae30bc64cb94463490c0f005de38723da361a415928fc5052ab68862e7b",
    FOLDER + "1200_thrust_response.csv": "02ee1f11b43698c9c7f4917d120367d2172aa5c047cbccb396682bae95273a89",
    FOLDER + "1500_thrust_response.csv": "1748a91db952f8c9888de5eaf15822040902d510caf27351000c6b4e05d33f1e",
}
MEASURED = "5a93f6846bc5fceebb76096e56794d5f79d21bee7fac94b8b0f973d054087f3e"


def read_trials(files):
    """Learned and unseen trials."""
    runs = []
    for content in files.values():
        clock, reading = np.loadtxt(io.StringIO(content.decode()), delimiter=",", unpack=True)
        time = np.arange(0, clock[-1], 0.02)
        thrust = np.interp(time, clock, np.median(reading[:50]) - reading)
        high = np.median(thrust[thrust > thrust.max() / 2])
        on = np.flatnonzero(thrust > 0.1 * high)[0] - 1
        off = on + np.flatnonzero(thrust[on + 20 :] < 0.9 * high - 0.15 * high)[0] + 19
        command = np.where((np.arange(len(time)) >= on) & (np.arange(len(time)) < off), high, 0.0)
        cut = slice(on - 15, off + 25)
        runs.append({"time": time[cut] - time[cut][0], "command": command[cut], "thrust": thrust[cut]})
    return runs[1:], runs[:1]

"""A board with two heaters and two thermometers (TCLab), both heaters switched by a controller: every 5 s for 20 min.

Three episodes are learned, a fourth is unseen.
"""

import io

import numpy as np

REPOSITORY = "heeejini/TCLab"
COMMIT = "70d8248056332c9b8b7121260bb35b2c8db96b2f"
FOLDER = "csv/data_back6/"
FILES = {
    FOLDER + "mpc_episode_1_data.csv": "707a7c84a7ddc55bd88daed7990d9950273c18f91270a804963abb2ed443d477",
    FOLDER + "mpc_episode_2_data.csv": "f8461324227c33e5188e0752524b8a238dbcc11738883f2e57d296d1cb2df284",
    FOLDER + "mpc_episode_3_data.csv": "e81cf73a3aafbaa7b10d386ac9af5c1ffef4cffd4facc9101000053e13c2aacb",
    FOLDER + "mpc_episode_4_data.csv": "c1bdf2cc54400ede76ccf47237e3560a724c9c56a970d7b4e3e5281c214e94f5",
}
MEASURED = "5f70357473d6a4d6c878239ae2c30776c696dcea769bd602b09566736f2f68d7"


def read_trials(files):
    """Learned and unseen trials."""
    trials = []
    for content in files.values():
        rows = np.genfromtxt(io.StringIO(content.decode()), delimiter=",", names=True)
        columns = {"heater1": rows["Q1"], "heater2": rows["Q2"], "warm1": rows["T1"], "warm2": rows["T2"]}
        trials.append({"time": rows["Time"], **columns})
    return trials[:3], trials[3:]

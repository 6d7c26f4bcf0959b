"""A pendulum of which every number is known, for MuJoCo and for OpenSim; both are extras."""

from importlib.util import find_spec

import pytest

MUJOCO, OPENSIM = (find_spec(name) is not None for name in ("mujoco", "opensim"))
MASS, LENGTH, INERTIA, DAMPING, GEAR, GRAVITY = 2.0, 0.4, 0.05, 0.3, 5.0, 9.81

PENDULUM = f"""<mujoco model="pendulum">
  <!-- the user's own words stay -->
  <option timestep="0.001" gravity="0 0 -{GRAVITY}"/>
  <worldbody>
    <body name="rod">
      <joint name="pivot" type="hinge" axis="0 -1 0" damping="{DAMPING}"/>
      <inertial pos="0 0 -{LENGTH}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 0.001"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="drive" joint="pivot" gear="{GEAR}"/>
  </actuator>
</mujoco>
"""


@pytest.fixture
def pendulum(tmp_path):
    """Path of a pendulum for MuJoCo; the test is skipped where MuJoCo is not installed."""
    if not MUJOCO:
        pytest.skip("MuJoCo is not installed: pip install 'gaitdisc[mujoco]'")
    path = tmp_path / "pendulum.xml"
    path.write_text(PENDULUM)
    return path


@pytest.fixture(scope="session")
def needs_opensim():
    if not OPENSIM:
        pytest.skip("OpenSim is not installed: pip install 'gaitdisc[opensim]'")

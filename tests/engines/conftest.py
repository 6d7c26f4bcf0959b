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


def _muscle(kind: str, name: str, x: float, force: float) -> str:
    """Two points, above and below a hinge, before it or behind it."""
    points = "".join(
        f'<PathPoint name="{one}"><socket_parent_frame>{frame}</socket_parent_frame><location>{x} {y} 0</location>'
        "</PathPoint>"
        for one, frame, y in (("above", "/ground", 1.25), ("below", "/bodyset/forearm", -0.04))
    )
    return (
        f'<{kind} name="{name}"><GeometryPath name="path"><PathPointSet><objects>{points}</objects></PathPointSet>'
        f"</GeometryPath><max_isometric_force>{force}</max_isometric_force>"
        "<optimal_fiber_length>0.12</optimal_fiber_length><tendon_slack_length>0.16</tendon_slack_length></"
        + kind
        + ">"
    )


def _hinged(joint: str, coordinate: str, body: str) -> str:
    frames = "".join(
        f'<PhysicalOffsetFrame name="{side}"><socket_parent>{on}</socket_parent><translation>0 {y} 0</translation>'
        "<orientation>0 0 0</orientation></PhysicalOffsetFrame>"
        for side, on, y in (("outer", "/ground", 1), ("inner", f"/bodyset/{body}", 0))
    )
    return (
        f'<PinJoint name="{joint}"><socket_parent_frame>outer</socket_parent_frame>'
        "<socket_child_frame>inner</socket_child_frame><coordinates>"
        f'<Coordinate name="{coordinate}"/></coordinates><frames>{frames}</frames></PinJoint>'
    )


WHEEL = 0.01  # [kg m^2], which turns twice as far as the elbow
ELBOW = f"""<?xml version="1.0" encoding="UTF-8" ?>
<OpenSimDocument Version="40600"><Model name="elbow"><Ground name="ground"/><gravity>0 -{GRAVITY} 0</gravity>
<BodySet name="bodyset"><objects>
<Body name="forearm"><mass>1.5</mass><mass_center>0 -0.15 0</mass_center><inertia>0.02 0.002 0.02 0 0 0</inertia></Body>
<Body name="wheel"><mass>1</mass><mass_center>0 0 0</mass_center><inertia>{WHEEL} {WHEEL} {WHEEL} 0 0 0</inertia></Body>
</objects></BodySet>
<JointSet name="jointset"><objects>{_hinged("elbow_joint", "elbow", "forearm")}{_hinged("axle", "turn", "wheel")}
</objects></JointSet>
<ConstraintSet name="constraintset"><objects><CoordinateCouplerConstraint name="belt">
<coupled_coordinates_function><LinearFunction><coefficients>2 0</coefficients></LinearFunction>
</coupled_coordinates_function>
<independent_coordinate_names>elbow</independent_coordinate_names>
<dependent_coordinate_name>turn</dependent_coordinate_name></CoordinateCouplerConstraint></objects></ConstraintSet>
<ForceSet name="forceset"><objects>
{_muscle("Thelen2003Muscle", "flexor", 0.03, 600)}
{_muscle("Millard2012EquilibriumMuscle", "extensor", -0.03, 500)}
</objects></ForceSet></Model></OpenSimDocument>
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


@pytest.fixture(scope="session")
def elbow(needs_opensim, tmp_path_factory):
    """Path of a forearm with two muscles for OpenSim, and a wheel that it drives by a belt."""
    path = tmp_path_factory.mktemp("elbow") / "elbow.osim"
    path.write_text(ELBOW)
    return path

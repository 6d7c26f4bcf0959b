"""Step by step through time: both legs on the belt, the phase, the pelvis. Compiled, and kept compiled.

Semi-implicit Euler at 0.5 ms. Per leg: three links with their equations of motion; nine muscle groups with activation
dynamics, force-velocity and arms; what they leave of the moments, behind a lag; impedance about the habit, firmer under
load; a reflex through a lag, on the muscles; the ground; the spring. The pelvis moves as a mass on soft springs under
what the ground gives beyond the habit, and so couples the legs. The phase runs at the habitual pace, unsteadily, and a
leg that is ahead of its habit hurries it.
"""

from typing import NamedTuple

import numpy as np

from gaitdisc.cohort.body import add_ground_force, bias, inertia, solved
from gaitdisc.cohort.controller import COLUMNS, LAG_S
from gaitdisc.cohort.muscles import LEAST, MOST, activate, muscle_moments
from gaitdisc.compiled import compiled
from gaitdisc.recording.arrays import Values

STEP_S = 0.0005
LEAST_LOAD = 0.3  # of the habitual vertical force
TURNED_OVER = 2.5  # rad; 143 deg
HIP_LEVER_M = 0.09  # of the vertical force about the hip, in the frontal plane
KNEE_TURNS_HIP = 0.4  # N m s/rad
NOISE_STEPS = 10  # noise is drawn at 200 Hz and interpolated
EVERY_MS, EVERY_TEN_MS = 2, 20
MUSCLES_A_LEG = 9
SLOW_MUSCLES = 5 + MUSCLES_A_LEG
PER_LEG_NOISE = SLOW_MUSCLES + MUSCLES_A_LEG  # three moments, two angles of the hip, muscles fast, muscles slow
PACE_NOISE = 2 * PER_LEG_NOISE  # two more channels: the pace, fast and slow
WANDER = PACE_NOISE + 2
NOISE = WANDER + 1
# quick: phase, force right x y, left x y, excitation right 9, left 9
QUICK = 1 + 4 + 2 * MUSCLES_A_LEG
# slow: phase, psi (2, 3), adduction and rotation (2, 2), moments (2, 3), spring (2), slip (2), pelvis x y,
# second derivative of psi (2, 3), turning moment of the belt (2)
SLOW = 1 + 6 + 4 + 6 + 2 + 2 + 2 + 6 + 2


class Loop(NamedTuple):
    """Feedback and unrest of one person."""

    stiffness: Values  # (3,), impedance of hip, knee, ankle about the habit [N m/rad]
    damping: Values  # (3,), of the same [N m s/rad]
    # (3,), by which share the impedance of each joint grows under load, its damping by half as much [1]
    loaded: Values
    reflex: float  # gain of the reflex [N m/rad]
    reflex_lag_s: float  # lag of the reflex
    side_stiffness: Values  # (2,), of hip adduction and rotation [N m/rad]
    side_damping: Values  # (2,), of the same [N m s/rad]
    side_inertia: Values  # (2,), of the same [kg m2]
    hurry: float  # relative pace for each rad that a leg is ahead [1/rad]
    moment_noise: Values  # (5,), standard deviation at hip, knee, ankle, adduction, rotation [N m]
    muscle_noise: Values  # (2,), relative, fast and slow [1]
    pace_noise: Values  # (2,), relative, fast and slow [1]
    whole_kg: float
    # (4,), support of the pelvis: stiffness and damping fore-aft, then vertical [N/m, N s/m]
    pelvis: Values


class Worn(NamedTuple):
    """Device and treadmill in the units of the equations."""

    stiffness: float  # of the spring [N m/rad]
    engaged: float  # dorsiflexion at which it engages [rad]
    speed: float  # of the belt [m/s]
    stride_s: float


@compiled
def integrate(leg, strength, belt, loop, worn, tables, noise):  # noqa: PLR0912, PLR0915
    """Integrate the walk of both legs.

    `tables` (2 drifts, 2 sides, phase, column), `noise` (time at 200 Hz, channel) of standard deviation 1, its last
    channel the drift itself. Returns what is kept at 1000 Hz, at 100 Hz, and whether the person kept walking.
    """
    # One function, in order of cause: split into nine, it took 0.87 instead of 0.48 s for 240 s of walking, numba
    # counting references at every call.
    steps = (len(noise) - 1) * NOISE_STEPS
    phases = tables.shape[2] - 1
    quick, slow = np.zeros((steps // EVERY_MS, QUICK)), np.zeros((steps // EVERY_TEN_MS, SLOW))
    psi, rate, speedup = np.empty((2, 3)), np.empty((2, 3)), np.zeros((2, 3))
    activation, excitation = np.empty((2, MUSCLES_A_LEG)), np.empty((2, MUSCLES_A_LEG))
    others, reflex = np.empty((2, 3)), np.zeros((2, 3))
    side, side_rate = np.empty((2, 2)), np.empty((2, 2))
    carried, slip, spring, turn = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    standing = np.zeros(2, np.bool_)
    pelvis, pelvis_rate, pelvis_speedup, pelvis_push = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    row, rattle, taken = np.empty((2, COLUMNS.width)), np.empty(NOISE), np.empty(3)
    joint, joint_rate, moments, leg_moments = np.empty(3), np.empty(3), np.empty(3), np.empty((2, 3))
    m, b, q, force, arm = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty((2, 2)), np.empty(2)
    phase, pace = 0.0, 1.0 / worn.stride_s
    for step in range(steps):
        now, after = step // NOISE_STEPS, step % NOISE_STEPS / NOISE_STEPS
        for channel in range(NOISE):
            rattle[channel] = noise[now, channel] + after * (noise[now + 1, channel] - noise[now, channel])
        for s in range(2):
            at = (phase + 0.5 * s) % 1.0 * phases
            low = int(at)
            share = at - low
            for c in range(COLUMNS.width):
                first = tables[0, s, low, c] + share * (tables[0, s, low + 1, c] - tables[0, s, low, c])
                second = tables[1, s, low, c] + share * (tables[1, s, low + 1, c] - tables[1, s, low, c])
                row[s, c] = first + rattle[WANDER] * (second - first)
            if step == 0:
                psi[s] = row[s, COLUMNS.psi : COLUMNS.turning]
                rate[s] = row[s, COLUMNS.turning : COLUMNS.place] * pace
                activation[s] = row[s, COLUMNS.excitation : COLUMNS.others]
                others[s] = row[s, COLUMNS.others : COLUMNS.side]
                side[s] = row[s, COLUMNS.side : COLUMNS.side + 2]
                side_rate[s] = row[s, COLUMNS.side + 2 : COLUMNS.side + 4] * pace
        ahead = 0.0
        for s in range(2):
            way = row[s, COLUMNS.turning]
            ahead += (psi[s, 0] - row[s, COLUMNS.psi]) * way / (abs(way) + 1.0)
        unsteady = loop.pace_noise[0] * rattle[PACE_NOISE] + loop.pace_noise[1] * rattle[PACE_NOISE + 1]
        pace = (1.0 + unsteady + 0.5 * loop.hurry * ahead) / worn.stride_s
        pelvis_push[:] = 0.0
        for s in range(2):
            base = s * PER_LEG_NOISE
            opening = row[s, COLUMNS.gate]
            joint_rate[0] = rate[s, 0]
            joint_rate[1] = rate[s, 0] - rate[s, 1]
            joint_rate[2] = rate[s, 2] - rate[s, 1]
            moments[:], taken[:] = 0.0, 0.0
            # what differs from the habit, by joint
            for j in range(3):
                want = row[s, COLUMNS.psi + j]
                want_rate = row[s, COLUMNS.turning + j] * pace
                if j == 0:
                    behind, slow_by = want - psi[s, 0], want_rate - rate[s, 0]
                elif j == 1:
                    behind = row[s, COLUMNS.psi] - want - psi[s, 0] + psi[s, 1]
                    slow_by = row[s, COLUMNS.turning] * pace - want_rate - joint_rate[1]
                else:
                    behind = want - row[s, COLUMNS.psi + 1] - psi[s, 2] + psi[s, 1]
                    slow_by = want_rate - row[s, COLUMNS.turning + 1] * pace - joint_rate[2]
                firm = loop.loaded[j] * opening
                moments[j] += (1.0 + firm) * loop.stiffness[j] * behind
                moments[j] += (1.0 + 0.5 * firm) * loop.damping[j] * slow_by
                moments[j] += loop.moment_noise[j] * rattle[base + j]
                reflex[s, j] += (loop.reflex * behind - reflex[s, j]) * STEP_S / loop.reflex_lag_s
            # muscles, and what they leave of the moments
            for muscle in range(MUSCLES_A_LEG):
                u = row[s, COLUMNS.excitation + muscle]
                u *= (
                    1.0
                    + loop.muscle_noise[0] * rattle[base + 5 + muscle]
                    + loop.muscle_noise[1] * rattle[base + SLOW_MUSCLES + muscle]
                )
                for j in range(3):
                    take = strength[s].take_up[muscle, j] if reflex[s, j] > 0 else strength[s].take_down[muscle, j]
                    u += take * reflex[s, j]
                    taken[j] += take * strength[s].reach[muscle, j]
                u = min(MOST, max(LEAST, u))
                excitation[s, muscle] = u
                activation[s, muscle] = activate(u, activation[s, muscle], STEP_S)
            joint[0], joint[1], joint[2] = psi[s, 0], psi[s, 0] - psi[s, 1], psi[s, 2] - psi[s, 1]
            muscle_moments(strength[s], activation[s], joint, joint_rate, moments)
            for j in range(3):
                want = row[s, COLUMNS.others + j] + (1.0 - taken[j]) * reflex[s, j]
                others[s, j] += (want - others[s, j]) * STEP_S / LAG_S
                moments[j] += others[s, j]
                leg_moments[s, j] = moments[j]
            over = psi[s, 2] - psi[s, 1] - worn.engaged
            spring[s] = -worn.stiffness * over if over > 0.0 else 0.0
            # the belt: the habitual force, and what holds the foot on it
            x = leg.thigh_m * np.sin(psi[s, 0]) + leg.shank_m * np.sin(psi[s, 1]) + pelvis[0]
            y = -leg.thigh_m * np.cos(psi[s, 0]) - leg.shank_m * np.cos(psi[s, 1]) + pelvis[1]
            vx = leg.thigh_m * np.cos(psi[s, 0]) * rate[s, 0] + leg.shank_m * np.cos(psi[s, 1]) * rate[s, 1]
            vy = leg.thigh_m * np.sin(psi[s, 0]) * rate[s, 0] + leg.shank_m * np.sin(psi[s, 1]) * rate[s, 1]
            vx += pelvis_rate[0]
            vy += pelvis_rate[1]
            want_x, want_y = row[s, COLUMNS.place], row[s, COLUMNS.place + 1]
            want_vx = row[s, COLUMNS.path] * pace + worn.speed * (pace * worn.stride_s - 1.0)
            want_vy = row[s, COLUMNS.path + 1] * pace
            push_x, push_y, turn[s] = 0.0, 0.0, 0.0
            if opening > 0.0:
                if not standing[s]:
                    standing[s] = True
                    carried[s] = x - want_x
                carried[s] += worn.speed * (pace * worn.stride_s - 1.0) * STEP_S
                push_x = opening * (belt.along * (want_x + carried[s] - x) + belt.along_damping * (want_vx - vx))
                push_y = opening * (belt.up * (want_y - y) + belt.up_damping * (want_vy - vy))
                foot = row[s, COLUMNS.psi + 2] - psi[s, 2]
                foot_rate = row[s, COLUMNS.turning + 2] * pace - rate[s, 2]
                turn[s] = opening * (belt.turn * foot + belt.turn_damping * foot_rate)
            else:
                standing[s] = False
            force[s, 0] = row[s, COLUMNS.force] + push_x
            # a foot that stands a little high still carries part of its load: the other foot is on its way up
            force[s, 1] = max(LEAST_LOAD * row[s, COLUMNS.force + 1], row[s, COLUMNS.force + 1] + push_y)
            arm[0], arm[1] = row[s, COLUMNS.arm], row[s, COLUMNS.arm + 1]
            slip[s] = vx - rate[s, 2] * arm[1] + row[s, COLUMNS.sway] * pace * worn.stride_s
            pelvis_push[0] += force[s, 0] - row[s, COLUMNS.force]
            pelvis_push[1] += force[s, 1] - row[s, COLUMNS.force + 1]
            # equations of motion
            ankle = moments[2] + spring[s]
            q[0], q[1], q[2] = moments[0] + moments[1], -moments[1] - ankle, ankle + turn[s]
            add_ground_force(leg, psi[s], force[s], arm, q)
            hip_x = row[s, COLUMNS.hip] + pelvis_speedup[0]
            hip_y = row[s, COLUMNS.hip + 1] + pelvis_speedup[1]
            inertia(leg, psi[s], m)
            bias(leg, psi[s], rate[s], hip_x, hip_y, b)
            for j in range(3):
                q[j] -= b[j]
            solved(m, q, speedup[s])
            # adduction and rotation of the hip
            for j in range(2):
                want = row[s, COLUMNS.side + j]
                want_rate = row[s, COLUMNS.side + 2 + j] * pace
                effort = loop.side_stiffness[j] * (want - side[s, j]) + loop.side_damping[j] * (
                    want_rate - side_rate[s, j]
                )
                effort += loop.moment_noise[3 + j] * rattle[base + 3 + j]
                if j == 0:
                    effort -= strength[s].abduction * (activation[s, 6] - row[s, COLUMNS.gmed])
                    effort += HIP_LEVER_M * (force[s, 1] - row[s, COLUMNS.force + 1])
                else:
                    knee = (row[s, COLUMNS.turning] - row[s, COLUMNS.turning + 1]) * pace
                    effort += KNEE_TURNS_HIP * (joint_rate[1] - knee)
                habit = row[s, COLUMNS.side + 4 + j] * pace * pace
                side_rate[s, j] += (habit + effort / loop.side_inertia[j]) * STEP_S
                side[s, j] += side_rate[s, j] * STEP_S
        if step % EVERY_MS == 0:
            quick[step // EVERY_MS, 0] = phase
            quick[step // EVERY_MS, 1:] = np.concatenate((force.ravel(), excitation.ravel()))
        if step % EVERY_TEN_MS == 0:
            slow[step // EVERY_TEN_MS, 0] = phase
            slow[step // EVERY_TEN_MS, 1:] = np.concatenate(
                (psi.ravel(), side.ravel(), leg_moments.ravel(), spring, slip, pelvis, speedup.ravel(), turn)
            )
        for s in range(2):
            for j in range(3):
                rate[s, j] += speedup[s, j] * STEP_S
                psi[s, j] += rate[s, j] * STEP_S
                if not abs(psi[s, j]) < TURNED_OVER:
                    return quick, slow, False
        for j in range(2):
            lift = pelvis_push[j] - loop.pelvis[2 * j] * pelvis[j] - loop.pelvis[2 * j + 1] * pelvis_rate[j]
            pelvis_speedup[j] = lift / loop.whole_kg
            pelvis_rate[j] += pelvis_speedup[j] * STEP_S
            pelvis[j] += pelvis_rate[j] * STEP_S
        phase += pace * STEP_S
    return quick, slow, True

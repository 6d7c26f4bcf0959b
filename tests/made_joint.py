"""An ankle whose moment is known: bursts of three muscles, their gains, and what is added to them."""

from dataclasses import replace

import numpy as np

from gaitdisc.processing.joint_record import JointRecord, join_trials
from gaitdisc.processing.muscle_moment import FASTEST, Driven, force_at_speed

RATE_HZ, STRIDE_S = 100.0, 1.1
MUSCLES = ("emg_sol_r", "emg_gas_r", "emg_ta_r")
AT, WIDTH, GAIN = (0.45, 0.38, 0.85), (0.08, 0.07, 0.10), (-110.0, -60.0, 30.0)
DELAY_S, LAG_S = 0.02, 0.03


def made_joint(strides=24, seed=0, spring=0.0, late_s=0.0, strength=1.0):
    """A walk whose strides differ in height of bursts and in angle; the EMG may be recorded late."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(strides * STRIDE_S * RATE_HZ)) / RATE_HZ
    count = time / STRIDE_S
    number, phase = count.astype(int), count % 1.0

    def varied(spread):  # from stride to stride, without steps
        return np.interp(count, np.arange(strides + 1), 1 + spread * rng.normal(size=strides + 1))

    wave = 0.15 * np.sin(2 * np.pi * phase + 0.4) + 0.06 * np.sin(4 * np.pi * phase + 1.0)
    angle = wave * varied(0.1)
    rate, speedup = np.gradient(angle, 1 / RATE_HZ), np.gradient(np.gradient(angle, 1 / RATE_HZ), 1 / RATE_HZ)
    pulses = [np.exp(-((((phase - at + 0.5) % 1 - 0.5) / width) ** 2)) for at, width in zip(AT, WIDTH, strict=True)]
    emg = np.column_stack([0.05 + one * varied(0.15) for one in pulses])
    driven = Driven(emg, np.sign(GAIN), angle, rate, phase, RATE_HZ)
    size = np.array([strength, strength, 1.0]) * GAIN
    force = force_at_speed(-np.sign(GAIN) * rate[:, None] / FASTEST)
    moment = (driven.activation(DELAY_S, LAG_S) * force) @ size - spring * np.maximum(0, angle - 0.05)
    wander = np.convolve(rng.normal(size=len(time)), np.ones(10) / np.sqrt(10), "same")
    seen = angle + 0.003 * rng.normal(size=len(time))
    shift = round(late_s * RATE_HZ)
    emg = emg[np.clip(np.arange(len(emg)) - shift, 0, None)]
    return JointRecord(
        "ankle_angle", "r", "W01", "made", time, seen, angle, rate, speedup, moment + 1.0 * wander, emg, MUSCLES,
        phase, number, np.empty(0),
    )  # fmt: skip


def cut_record(record, rows, first):
    """Part of a record as a trial of its own, whose clock begins at zero; strides before the first are outside."""
    stride = np.where(record.stride[rows] < first, -1, record.stride[rows] - first)
    arrays = {name: getattr(record, name)[rows] for name in ("seen", "angle", "rate", "speedup", "moment", "envelopes")}
    phase = np.where(stride < 0, np.nan, record.phase[rows])
    return replace(record, time=record.time[rows] - record.time[rows][0], phase=phase, stride=stride,
                   per_kg=record.per_kg[rows], **arrays)  # fmt: skip


def short_trials(record, strides=3):
    """The record cut into trials of some strides, the first of each begun before the trial, and joined again."""
    samples = round(strides * STRIDE_S * RATE_HZ)
    starts = range(0, len(record.time) - samples + 1, samples)
    return join_trials(
        [
            cut_record(record, slice(start + 40, start + samples), round(start / RATE_HZ / STRIDE_S) + 1)
            for start in starts
        ]
    )

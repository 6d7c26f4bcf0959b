"""Criteria: every number set by hand that decides what is named; how it is computed stands beside each computation."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Criteria:
    """What the evidence has to reach. `benchmarks/criteria.py` moves each alone; docs/discover.md says what changes.

    Source: Raftery 1995, Sociol. Methodol. 25, 111 (what a difference of the criterion, BIC, is worth).
    """

    # Likelihood
    margin: float = 10.0  # fall of the criterion for one explanation more: very strong evidence
    tie: float = 6.0  # fall of the criterion that distinguishes two explanations: strong evidence
    # of the criterion or the misfit: up to which a rival is weighed on longer runs, and from which on other trials are
    # held out, where those that are say nothing
    support: float = 50.0
    certain: float = 2.5  # standard errors of a number from where it says nothing (p = .006)
    start: float = 5.0  # standard errors of a start from the file's
    widest: float = 2.0  # times the range of a motion, up to which its half width shows

    # What counts as noise
    mere_noise: float = 1.3  # times the variance of the sensors' noise: its own estimate errs
    autocorrelated: float = 1.03  # standard deviation before over after the past is taken off
    agrees: float = 1.5  # times the error that a simulation that lacks nothing may leave
    model_error: float = 0.01  # of a channel's spread: no simulation of hardware is exact
    inexact: float = 0.05  # of a channel's spread: the same of an engine's linear stand-in
    material: float = 0.02  # of what was explained, the least that one explanation more has to explain
    independent: float = 20.0  # samples of what a wrong simulation leaves that say as much as one

    # Share of the gap that a set of explanations closes on what was left out
    plain: float = 0.03  # of the gap, price of a plain explanation
    # of a signal's error, a coupling, a one-sided shape; beside the plain price, of what imitates anything: a delay, a
    # product, a period, a state of its own
    bent: float = 0.05
    matters: float = 0.05  # of the gap, the least that is named, and what a damping that drives costs more
    half: float = 0.5  # of a squared error: what names together, or one name more on whole runs, must take
    each_number: float = 0.004  # of the gap, price of a number of a fitted shape
    reading: float = 0.95  # of what a fitted shape closes, for an expression to stand in its place

    # Runs
    growth: float = 5.0  # of a small change of the start, by which runs are cut
    chaotic: float = 300.0  # of the same, from which on the likelihood has too many maxima
    follows: float = 1.08  # times the noise of shorter runs, up to which a longer run follows the data
    near: float = 0.25  # of a channel's spread, within which a run stays near the data
    lost: float = 2.0  # squared spreads that a run counts as that has left the data
    grown: float = 2.0  # standard deviations of noise and start beyond which a free run shows that something is missing

    # Odd trials
    apart: float = 2.0  # times smaller the error without a trial, or with it changed
    unlike: float = 1.3  # times greater the errors of the others, changed alike


CRITERIA = Criteria()

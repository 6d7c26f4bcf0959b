"""`gaitdisc modalities`: the models without one family of inputs at a time."""

from gaitdisc.commands.options import Cluster, Jobs, Quiet, RunPlace, StudyPlace
from gaitdisc.commands.run_report import vary


def modalities(
    study: StudyPlace, out: RunPlace = None, jobs: Jobs = 1, cluster: Cluster = "", quiet: Quiet = False
) -> None:
    """Leave out one family of inputs at a time and fit the models again, to find the important inputs."""
    vary(study, out, "modalities", jobs, cluster, quiet)

"""`gaitdisc sensitivity`: the models under other cut-offs and training lengths."""

from gaitdisc.commands.options import Cluster, Jobs, Quiet, RunPlace, StudyPlace
from gaitdisc.commands.run_report import vary


def sensitivity(
    study: StudyPlace, out: RunPlace = None, jobs: Jobs = 1, cluster: Cluster = "", quiet: Quiet = False
) -> None:
    """Fit the models with other filter cut-offs and training lengths, to test whether the result depends on them."""
    vary(study, out, "sensitivity", jobs, cluster, quiet)

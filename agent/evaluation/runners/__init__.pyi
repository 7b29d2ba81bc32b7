from .base import Runner
from .experiment_run import make_runner, run_experiment
from .journal import RunJournal
from .local import ProcessRunner, SerialRunner
from .ray import RayRunner

__all__ = [
    "ProcessRunner",
    "RayRunner",
    "RunJournal",
    "Runner",
    "SerialRunner",
    "make_runner",
    "run_experiment",
]

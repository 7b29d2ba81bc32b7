from .base import ProcessRunner, Runner, SerialRunner
from .experiment_run import make_runner, run_experiment
from .journal import RunJournal
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

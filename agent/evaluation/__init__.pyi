# SPDX-License-Identifier: Apache-2.0
from .case import Case, CaseRun, Result
from .experiment import Experiment
from .scenarios import Scenario, load_scenarios

__all__ = ["Case", "CaseRun", "Experiment", "Result", "Scenario", "load_scenarios"]

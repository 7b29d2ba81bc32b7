# SPDX-License-Identifier: Apache-2.0
from .case import Case, CaseResult, CaseRun
from .experiment import Experiment
from .scenarios import LearningScenario, load_scenarios

__all__ = ["Case", "CaseResult", "CaseRun", "Experiment", "LearningScenario", "load_scenarios"]

# SPDX-License-Identifier: Apache-2.0
from .certificate import count_totals, make_certificate
from .finite_cases import TaughtSpace
from .scenario_space import RuleTopic, ScenarioSpace
from .taught_agent import TaughtAgent, TracedDecision
from .weak_orders import WeakOrderBlock

__all__ = [
    "RuleTopic",
    "ScenarioSpace",
    "TaughtAgent",
    "TaughtSpace",
    "TracedDecision",
    "WeakOrderBlock",
    "count_totals",
    "make_certificate",
]

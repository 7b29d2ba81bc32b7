# SPDX-License-Identifier: Apache-2.0
from .comparison import Comparison, compare
from .export import write_report
from .summary import EvaluationReport

__all__ = [
    "Comparison",
    "EvaluationReport",
    "compare",
    "write_report",
]

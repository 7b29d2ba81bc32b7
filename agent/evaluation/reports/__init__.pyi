from .comparison import EvaluationComparison, compare
from .export import write_report
from .summary import EvaluationReport

__all__ = [
    "EvaluationComparison",
    "EvaluationReport",
    "compare",
    "write_report",
]

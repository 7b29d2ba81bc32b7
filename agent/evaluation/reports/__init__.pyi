from .export import write_report
from .summary import EvaluationReport

__all__ = ["EvaluationReport", "write_report"]

from . import console, deduction_svg
from .video import Film

__all__ = ["Film", "console", "deduction_svg"]

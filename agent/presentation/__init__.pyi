from . import console, proof_svg
from .video import Film

__all__ = ["Film", "console", "proof_svg"]

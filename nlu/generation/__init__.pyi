from .realizer import Realizer, load_realizer
from .templates import AnswerTemplates, load_answers

__all__ = ["AnswerTemplates", "Realizer", "load_answers", "load_realizer"]

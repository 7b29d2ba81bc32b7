"""Hilt: affordances of objects, learned from language and acted on by a simulated robot."""

__version__ = "0.2.0"

"""Runners: they run the cases of an experiment, and give the same results wherever they do."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Reports of evaluations: counts, tables, pages and comparisons.

summary     the results of a run, counted
comparison  differences between two runs
html        a page with counts, curves, pictures and explanations; plots has its curves
export      reports as files: HTML, JSON or CSV
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

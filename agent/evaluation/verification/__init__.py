"""Verification of all learning scenarios by finitely many cases.

scenario_space  the space of learning scenarios: cells, levels and codes
taught_agent    an agent with given rules that records which rules it reads
finite_cases    the cases: words, scores and grasps
weak_orders     the cases: choices from every order of the objects in a scene
hypotheses      tests of the hypotheses that make the cases sufficient
certificate     the results of all cases in one document
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Evaluation: experiments, the cases they consist of, and runners for them.

case                a question with a known answer, and its result; plain JSON
experiment          the base class of experiments, which list cases and run any one of them
learning_scenarios  the learning scenarios of the paper (Table 2)
verification        verification of all learning scenarios by finitely many cases
experiments         the experiments by name
runners             run the cases in this process, in several, or on a Ray cluster; keep a journal
reports             the results of a run as counts, tables, pages, or compared with another run
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

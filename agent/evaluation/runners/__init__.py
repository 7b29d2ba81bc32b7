"""Runners: they run the cases of an experiment, and give the same results wherever they do.

base            the protocol of a runner, and running one case in any process
local           in this process, or in a pool of processes
ray             on a Ray cluster
journal         results on disk as they come, so that a run can be resumed
experiment_run  choice of the runner; a run with its journal and progress bar
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

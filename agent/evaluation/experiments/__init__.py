"""Experiments: what is taught and asked, and which answers are right.

registry            the experiments by name
paper               the evaluation of the paper, and its extension to all scenes
grasps              the grasp rules of the paper, executed from random poses
all_scenarios       verification of all learning scenarios
noise_robustness    accuracy under noise; noise_curves has its curves and confidence intervals
custom              experiments defined in a YAML file
command_experiment  base class of experiments that give commands
ground_truth        right choices for a command, and the judgement of what was done
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

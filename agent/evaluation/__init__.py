# SPDX-License-Identifier: Apache-2.0
"""Evaluation: experiments, the cases they consist of, and engines that run them.

experiment  what is measured: it lists its cases and can run any one of them by itself
case        one question with a known answer, with all that asking it needs
result      what came of a case, and whether the ground truth allows it
scenario    what is taught and what is then right (the paper's Table 2)
engine      what runs cases: this process, several processes, or a Ray cluster
journal     the results of a run as they come; what is in it is not run again
report      the results of a run, counted
"""

# SPDX-License-Identifier: Apache-2.0
"""Evaluation: experiments, the cases they consist of, and engines that run them.

experiment  what is measured: it lists its cases and can run any one of them by itself
case        one question with a known answer, with all that asking it needs
result      what came of a case, and whether the ground truth allows it
scenario    what is taught and what is then right (the paper's Table 2)
engine      what runs cases: this process, several processes, or a Ray cluster
journal     the results of a run as they come; what is in it is not run again
report      the results of a run, counted; as a table, a page, or compared with another
cell        what a rule is about, without how sure it is; each can be taught any set of levels
certificate what was found out about all learning scenarios, for others to check
curve       accuracy against one kind of trouble, with a confidence band
"""

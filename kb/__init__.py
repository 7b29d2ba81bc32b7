"""The knowledge base: interval-annotated rules on an RDF graph.

Interval    bounds [lower, upper] of the probability of a statement
atom        one term of a rule: object:knife, part:blade, action:pass
rule        features and contexts imply an affordance, within an interval, as one speaker said
feature     what must be seen for a rule to apply
context     what the robot is doing, or where, for a rule to apply
affordance  the conclusion: what the object is used for, or how the action is done
utterance   one sentence of the history: who said it, when, and which rules it changed
trust       the degree to which what a speaker says is believed
node        an action-tree node, to which the rules that apply there are attached
base        where all of it is kept: in memory, in a folder, or behind a SPARQL endpoint

The sub-packages, lowest first: `rdf` maps rules to RDF, `sparql` handles the text and the results
of queries, `stores` keeps statements, `bulk` imports and exports millions, `formats` are file
formats.

>>> from hilt.kb import Interval, KnowledgeBase, grasping
>>> kb = KnowledgeBase.open("memory:")
>>> rule = grasping("knife", "blade", "pass", interval=Interval(0.95, 1))
>>> text = "To pass a knife grab the knife by the blade"
>>> utterance = kb.believe(text, "implies(...)", "sam", [rule])
>>> kb.rules_at_nodes(["pass.graspObject"])
[<Rule pass, object:knife => graspObject(blade) [0.95, 1.00]>]
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

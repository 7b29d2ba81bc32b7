"""The knowledge base: interval-annotated rules on an RDF graph.

The sub-packages, lowest first: `rdf` maps rules to RDF, `sparql` handles queries and their results,
`stores` keeps statements, `bulk` imports and exports millions, `formats` are file formats.

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

"""The domain model: vocabulary, object types, action trees and settings, as data with readers.

vocabulary          namespaces, prefixes and IRIs of the RDF graph
objects             object types with their parts, properties and materials
geometry            the shapes of parts
actions             action trees: the steps that achieve a goal
confidence          degrees of confidence and their intervals: "often" is [0.75, 1]
evidence_operators  modus ponens, fusion and certainty of belief intervals
yaml_reader         YAML values with positions, for precise error messages
errors              all exceptions of Hilt
disk_cache          the user's cache folder
garbage_collection  a pause of Python's garbage collector

>>> from hilt.ontology import load_objects
>>> sorted(load_objects()["knife"].parts)
['blade', 'handle']
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

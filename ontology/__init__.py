"""The domain model: vocabulary, object types, action trees and settings, as data with readers.

>>> from hilt.ontology import load_objects
>>> sorted(load_objects()["knife"].parts)
['blade', 'handle']
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Models: object types and robots as files that the simulator loads.

`solids` turns the forms of a part into a visual surface and convex collision pieces, both made by
`meshes`; `urdf` writes and assembles URDF files; `object_models` builds the model of an object type
once and keeps it in the cache.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

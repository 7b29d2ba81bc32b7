"""Vision: from camera images to percepts, objects with the point clouds of their parts.

`camera` renders images, `region_of_interest` only the part of them that shows objects.
`mask_detector` finds objects by the simulator's mask; `learned_detector` by the `neural_classifier`
of what `segmentation` separates. `perception_noise` degrades percepts, `vision_backends` chooses
the detector, `point_cloud_operations` has the operations on points.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

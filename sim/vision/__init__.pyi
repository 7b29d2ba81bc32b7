# SPDX-License-Identifier: Apache-2.0
from .camera import Camera, CameraImage
from .detector import MaskDetector
from .learned_detector import LearnedDetector, Recogniser
from .percept import PartPercept, Percept, visible_features
from .perception_noise import NoiseLevels, NoisyVision
from .sensors import CachedVision, VisionSensor, open_vision

__all__ = [
    "CachedVision",
    "Camera",
    "CameraImage",
    "LearnedDetector",
    "MaskDetector",
    "NoiseLevels",
    "NoisyVision",
    "PartPercept",
    "Percept",
    "Recogniser",
    "VisionSensor",
    "open_vision",
    "visible_features",
]

from .camera import Camera, CameraImage
from .learned_detector import LearnedDetector, Recogniser
from .mask_detector import MaskDetector
from .object_detector import ObjectDetector
from .percept import Percept, visible_features
from .perception_noise import NoiseLevels, NoisyDetector
from .vision_backends import open_vision

__all__ = [
    "Camera",
    "CameraImage",
    "LearnedDetector",
    "MaskDetector",
    "NoiseLevels",
    "NoisyDetector",
    "ObjectDetector",
    "Percept",
    "Recogniser",
    "open_vision",
    "visible_features",
]

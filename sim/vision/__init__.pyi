from .camera import Camera, CameraImage
from .learned_detector import LearnedDetector, Recogniser
from .mask_detector import MaskDetector
from .percept import PartPercept, Percept, visible_features
from .perception_noise import NoiseLevels, NoisyDetector
from .vision_backends import CachedVision, VisionSensor, open_vision

__all__ = [
    "CachedVision",
    "Camera",
    "CameraImage",
    "LearnedDetector",
    "MaskDetector",
    "NoiseLevels",
    "NoisyDetector",
    "PartPercept",
    "Percept",
    "Recogniser",
    "VisionSensor",
    "open_vision",
    "visible_features",
]

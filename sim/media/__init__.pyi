from .pictures import GraspMark, save_picture, take_picture
from .recording import WorldRecorder

__all__ = [
    "GraspMark",
    "WorldRecorder",
    "save_picture",
    "take_picture",
]

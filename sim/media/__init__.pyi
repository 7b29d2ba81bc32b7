from .pictures import save_picture, take_picture
from .recording import WorldRecorder

__all__ = ["WorldRecorder", "save_picture", "take_picture"]

from .object_models import ObjectModel, object_model
from .urdf import HandFile, robot_file

__all__ = ["HandFile", "ObjectModel", "object_model", "robot_file"]

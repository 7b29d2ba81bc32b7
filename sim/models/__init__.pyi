# SPDX-License-Identifier: Apache-2.0
from .object_models import ObjectModel, object_model
from .urdf import HandAttachment, robot_file

__all__ = [
    "HandAttachment",
    "ObjectModel",
    "object_model",
    "robot_file",
]

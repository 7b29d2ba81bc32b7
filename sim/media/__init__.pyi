# SPDX-License-Identifier: Apache-2.0
from .pictures import GraspMark, save_picture, take_picture
from .recording import Recorder

__all__ = [
    "GraspMark",
    "Recorder",
    "save_picture",
    "take_picture",
]

# SPDX-License-Identifier: Apache-2.0
from .engine import PhysicsEngine
from .types import Contact, Image, JointInfo, Light

__all__ = [
    "Contact",
    "Image",
    "JointInfo",
    "Light",
    "PhysicsEngine",
]

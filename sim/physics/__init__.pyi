# SPDX-License-Identifier: Apache-2.0
from .contacts import Contact
from .engine import PhysicsEngine
from .rendering import Image, Lighting

__all__ = [
    "Contact",
    "Image",
    "Lighting",
    "PhysicsEngine",
]

from .contacts import Contact
from .engine import PhysicsEngine
from .rendering import Lighting

__all__ = ["Contact", "Lighting", "PhysicsEngine"]

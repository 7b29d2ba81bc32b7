"""Grasp planning: from the percept of an object to the grasp to execute."""

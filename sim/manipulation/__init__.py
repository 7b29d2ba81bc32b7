"""Manipulation: grasping, lifting, handing over, putting back, pointing and striking."""

"""Scenes: what is on the table, where, and the simulated world made of it."""

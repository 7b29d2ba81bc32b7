"""Models: object types and robots as files that the simulator loads."""

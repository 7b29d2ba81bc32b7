"""Physics: the PyBullet simulator, spoken to by the names of bodies, links and joints."""

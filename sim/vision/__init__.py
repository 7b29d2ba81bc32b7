"""Vision: from camera images to percepts, objects with the point clouds of their parts."""

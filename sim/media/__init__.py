"""Media: pictures of a scene for people, and recordings of what happens in it."""

"""Files: what a base is exported to and imported from."""

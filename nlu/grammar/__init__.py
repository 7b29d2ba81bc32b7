"""Combinatory categorial grammar (CCG) with lambda terms, read from the notation of data files."""

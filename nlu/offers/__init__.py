"""Offers: meanings to choose from for an utterance that the grammar does not understand."""

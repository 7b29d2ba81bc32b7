"""Semantics and pragmatics: from the term of a derivation to what an utterance means to Hilt."""

"""Parsing: from the text of an utterance to its readings, or to the clarification it needs."""

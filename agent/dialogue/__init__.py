"""The dialogue manager: what is done with each utterance, and how it is answered."""

"""Generation of text: meanings as sentences that parse back to them, and spoken answers."""

"""Speech: what was said, from what was heard."""

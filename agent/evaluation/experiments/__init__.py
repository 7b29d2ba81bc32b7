"""Experiments: what is taught and asked, and which answers are right."""

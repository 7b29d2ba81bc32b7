"""Runners: they run the cases of an experiment, and give the same results wherever they do."""

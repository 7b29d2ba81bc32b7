"""Evaluation: experiments, the cases they consist of, and runners for them."""

"""The dialogue manager: what is done with each utterance, and how it is answered.

Statements become rules and commands requests (translation), questions are answered
from the knowledge base (questions); every utterance ends in a reply.
"""

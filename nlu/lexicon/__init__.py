"""The words of a language: tokens, entries, inflection, unknown words."""

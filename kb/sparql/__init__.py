"""The text and the results of SPARQL queries, independent of any engine."""

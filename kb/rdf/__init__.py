"""RDF terms, and the mapping of rules and of the household domain to statements."""

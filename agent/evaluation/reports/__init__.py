"""Reports of evaluations: counts, tables and pages."""

"""Verification of all learning scenarios by finitely many cases."""

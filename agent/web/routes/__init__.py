"""The JSON interface below `/api/v1`, by what it is about."""

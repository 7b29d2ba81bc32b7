"""The service over HTTP: talk, watch and query. FastAPI and uvicorn are known here alone."""

"""The command line as a module: `python -m hilt`."""

from .agent.cli import main

main()

"""Makes the helper modules of these tests importable, also in the worker processes they start."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

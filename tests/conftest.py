"""How hypothesis searches: the same examples in every run, so that the gate is repeatable.

`pytest --hypothesis-profile=default` searches at random instead, `--hypothesis-seed` with a seed.
"""

from __future__ import annotations

from hypothesis import HealthCheck, settings

settings.register_profile(
    "repeatable",
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],  # a busy machine is no failure
)
settings.load_profile("repeatable")

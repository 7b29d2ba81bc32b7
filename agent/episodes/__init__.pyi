from .recorder import EpisodeRecorder, episode_from_reply
from .serialization import (
    embodiment_as_json,
    embodiment_from_json,
    request_as_json,
    request_from_json,
)

__all__ = [
    "EpisodeRecorder",
    "embodiment_as_json",
    "embodiment_from_json",
    "episode_from_reply",
    "request_as_json",
    "request_from_json",
]

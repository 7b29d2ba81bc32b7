from .recorder import EpisodeRecorder, episode_from_reply
from .serialization import as_json, embodiment_as_json, embodiment_from_json, from_json

__all__ = [
    "EpisodeRecorder",
    "as_json",
    "embodiment_as_json",
    "embodiment_from_json",
    "episode_from_reply",
    "from_json",
]

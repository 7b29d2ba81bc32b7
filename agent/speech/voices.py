"""Voices: eSpeak NG, whose wheel has all that it needs, and plug-ins."""

import ctypes
import re
from functools import cache
from pathlib import Path
from threading import Event, Lock
from typing import Any

from ...ontology.errors import extra_required
from ...ontology.plugins import call_plugin
from ..protocols import Voice
from .sound import open_stream, write_wav

MOST_CHARACTERS = 200  # of what is said of an answer
_ASIDE = re.compile(r"\s*(\[[^\]]*\]|\([^)]*\d[^)]*\)|\S+[/:]\S*\d\S*)")  # intervals, ids
_SENTENCE = re.compile(r"(?<=[.!?])\s+")
_SPEAKING = Lock()  # the library has one state for all
_CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)


def spoken_form(answer: str) -> str:
    """Return what is said of an answer: its first sentences, without intervals and ids."""
    said, *others = _SENTENCE.split(_ASIDE.sub("", answer).strip())
    for sentence in others:
        if len(said) + len(sentence) >= MOST_CHARACTERS:
            break
        said = f"{said} {sentence}"
    return said


def find_voice(name: str) -> Voice:
    """Return the voice "espeak", or that of a plug-in: NAME, or NAME:REST with what it is told.

    UnknownNameError if there is none; MissingExtraError if it is not installed.
    """
    if name == "espeak":
        return EspeakVoice()
    return call_plugin("hilt.voice", *name.partition(":")[::2], methods=("say", "save"))


def play(rate: int, pcm: bytes, cancelled: Event) -> None:
    """Play mono 16-bit samples until the end, or until it is cancelled; DataError if it cannot."""
    step = rate // 20 * 2  # 50 ms
    with open_stream("RawOutputStream", rate, channels=1, dtype="int16") as stream:
        for at in range(0, len(pcm), step):
            if cancelled.is_set():
                stream.abort()
                return
            stream.write(pcm[at : at + step])


class EspeakVoice:
    """The English voice of eSpeak NG; MissingExtraError if it is not installed."""

    def say(self, text: str, cancelled: Event) -> None:
        """Speak until all is said, or until it is cancelled."""
        play(*_spoken(text), cancelled)

    def save(self, text: str, path: Path) -> None:
        """Write a text as a WAV file; DataError if that fails."""
        write_wav(path, *_spoken(text))


def _spoken(text: str) -> tuple[int, bytes]:
    (library, rate), pieces = _espeak(), list[bytes]()

    @_CALLBACK
    def keep(samples: int | None, count: int, _: object) -> int:
        pieces.append(ctypes.string_at(samples, 2 * count) if samples else b"")
        return 0

    said = text.encode() + b"\0"
    with _SPEAKING:
        library.espeak_SetSynthCallback(keep)
        size = ctypes.c_size_t(len(said))
        library.espeak_Synth(said, size, 0, 1, 0, 1, None, None)  # all characters, in UTF-8
    return rate, b"".join(pieces)


@cache
def _espeak() -> tuple[Any, int]:
    with extra_required("speech", "espeakng-loader"):
        import espeakng_loader  # pyright: ignore[reportMissingImports]

    library: Any = ctypes.CDLL(espeakng_loader.get_library_path())
    data = espeakng_loader.get_data_path().encode()
    rate = library.espeak_Initialize(2, 0, data, 0)  # 2: the callback has all when it returns
    library.espeak_SetVoiceByName(b"en-us")
    return library, rate

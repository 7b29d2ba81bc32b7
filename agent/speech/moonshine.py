"""Moonshine tiny, a neural recogniser of English with its weights (Jeffries et al. 2024).

It writes any sentence, but gives no score: what its text is worth, other recognisers tell.
"""

from __future__ import annotations

from ...nlu.language import Language
from ...ontology.errors import extra_required
from .sound import Sound, Transcript


class MoonshineRecogniser:
    """Moonshine tiny; MissingExtraError if it is not installed."""

    name = "moonshine"

    def __init__(self, language: Language) -> None:
        with extra_required("speech", "moonshine-voice"):
            from moonshine_voice import ModelArch, Transcriber, get_model_path  # pyright: ignore[reportMissingImports]

        options = {"vad_threshold": "0", "return_audio_data": "false"}  # 0: nothing is cut away
        self._transcriber = Transcriber(str(get_model_path()), ModelArch.TINY, options=options)
        self.learn(language)

    def learn(self, language: Language) -> None:
        """Do nothing: it has the words of English."""

    def recognise(self, sound: Sound) -> tuple[Transcript, ...]:
        """Return the only text that it finds, if any."""
        found = self._transcriber.transcribe_without_streaming(sound.samples.tolist())
        text = " ".join(line.text.strip() for line in found.lines if line.text.strip())
        return (Transcript(text, 1.0),) if text else ()

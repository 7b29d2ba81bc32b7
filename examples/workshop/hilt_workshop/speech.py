"""A recogniser and a voice for Hilt, with models of your own: Vosk and Piper."""

from __future__ import annotations

import json
from pathlib import Path
from threading import Event

from hilt.agent.speech.sound import RATE, Sound, Transcript, write_wav
from hilt.agent.speech.voices import play
from hilt.nlu.language import Language
from hilt.ontology.errors import DataError, extra_required


class VoskRecogniser:
    """Vosk with the model in a folder: `--recogniser workshop-vosk:FOLDER`."""

    name = "vosk"

    def __init__(self, folder: str, language: Language) -> None:
        if not Path(folder).is_dir():
            raise DataError("expected the folder of a model of Vosk.", source=folder or self.name)
        with extra_required("speech", "vosk"):
            import vosk

        self._recogniser = vosk.KaldiRecognizer(vosk.Model(folder), RATE)
        self._recogniser.SetMaxAlternatives(5)

    def learn(self, language: Language) -> None:
        """Do nothing: its words are those of its model."""

    def recognise(self, sound: Sound) -> list[Transcript]:
        """Return up to five texts, each with its share of the confidence in all of them."""
        self._recogniser.AcceptWaveform(sound.pcm)
        listed = json.loads(self._recogniser.FinalResult())["alternatives"]
        found = [each for each in listed if each["text"]]
        total = sum(each["confidence"] for each in found) or 1.0
        return [Transcript(each["text"], each["confidence"] / total) for each in found]


class PiperVoice:
    """Piper with the voice in a file: `--voice workshop-piper:FILE.onnx`."""

    def __init__(self, file: str) -> None:
        if not Path(file).is_file():
            raise DataError("expected the file of a voice of Piper.", source=file or "piper")
        with extra_required("speech", "piper-tts"):
            import piper

        self._voice = piper.PiperVoice.load(file)

    def say(self, text: str, cancelled: Event) -> None:
        """Speak until all is said, or until it is cancelled."""
        for chunk in self._voice.synthesize(text):
            play(chunk.sample_rate, chunk.audio_int16_bytes, cancelled)

    def save(self, text: str, path: Path) -> None:
        """Write a text as a WAV file."""
        chunks = list(self._voice.synthesize(text))
        pcm = b"".join(each.audio_int16_bytes for each in chunks)
        write_wav(path, chunks[0].sample_rate if chunks else RATE, pcm)

"""How often speech is understood: three synthetic voices, clean and with pink noise.

    python benchmarks/speech.py out/heard.jsonl --seed 2      # record, listen; 20 minutes
    python benchmarks/speech.py out/fit.jsonl --seed 1 --fit  # the same, and fit the calibration

Sentences of the grammar are drawn by chance, free ones are those of `tests/nlu/data`, and others
are no sentences for Hilt, some of them in another language. It needs the programs espeak-ng, flite
and text2wave (festival with the voice cmu_us_slt_arctic_hts), and the extra "speech".
"""

# ruff: noqa: S311 - no secrets
from __future__ import annotations

import argparse
import json
import random
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hilt.agent.speech.listening import RECOGNISERS, find_recogniser
from hilt.agent.speech.sound import Sound
from hilt.nlu.jsgf import sentences
from hilt.nlu.language import Language

FREE = Path(__file__).parents[1] / "tests" / "nlu" / "data" / "blind_far.jsonl"
VOICES = {
    "espeak": ("espeak-ng", "-v", "en-us", "-f", "{text}", "-w", "{sound}"),
    "flite": ("flite", "-voice", "rms", "-f", "{text}", "-o", "{sound}"),
    "festival": ("text2wave", "-eval", "(voice_cmu_us_slt_arctic_hts)", "-o", "{sound}", "{text}"),
    **{
        name: ("espeak-ng", "-v", name, "-f", "{text}", "-w", "{sound}")
        for name in ("de", "fr", "es")
    },
}
ENGLISH = ("espeak", "flite", "festival")
NOISES_DB = (None, 20, 10)
OTHERS = {
    "the weather is going to be nice tomorrow": ENGLISH,
    "my sister has bought a new car last week": ENGLISH,
    "we should really go to the cinema tonight": ENGLISH,
    "the train was late again this morning": ENGLISH,
    "did you see the game on television yesterday": ENGLISH,
    "two plus two makes four as everybody knows": ENGLISH,
    "Das Wetter wird morgen sicher schön": ("de",),
    "Gib mir bitte das Messer vom Tisch": ("de",),
    "Ich habe gestern einen Hammer gekauft": ("de",),
    "Wo ist denn hier der Bahnhof": ("de",),
    "Donne-moi le couteau s'il te plaît": ("fr",),
    "Il fait très beau aujourd'hui": ("fr",),
    "Je ne sais pas où est le marteau": ("fr",),
    "Nous allons manger dans la cuisine": ("fr",),
    "Pásame el cuchillo por favor": ("es",),
    "Hace mucho calor en la cocina": ("es",),
    "No sé dónde está el martillo": ("es",),
    "Mañana vamos a la playa con los niños": ("es",),
}


def items(language: Language, seed: int) -> list[tuple[str, str, tuple[str, ...]]]:
    """Kind, text and voices of what is said, shuffled."""
    drawn = dict.fromkeys(sentences(language, 200, random.Random(1000 + seed)))
    lines = FREE.read_text(encoding="utf-8").splitlines()
    free = [json.loads(line)["text"] for line in lines]
    random.Random(0).shuffle(free)
    found = [("grammar", text, ENGLISH) for text in list(drawn)[:60]]
    found += [("free", text, ENGLISH) for text in free[seed % 2 :: 2][:40]]
    found += [("other", text, voices) for text, voices in list(OTHERS.items())[seed % 2 :: 2]]
    random.Random(seed).shuffle(found)
    return found


def spoken(text: str, voice: str) -> Sound:
    """A text as a voice says it."""
    with tempfile.TemporaryDirectory() as folder:
        paths = {"text": Path(folder, "text"), "sound": Path(folder, "sound.wav")}
        paths["text"].write_text(text, encoding="utf-8")
        command = [part.format(**paths) for part in VOICES[voice]]
        subprocess.run(command, check=True, capture_output=True)  # noqa: S603
        return Sound.read(paths["sound"])


def with_noise(sound: Sound, ratio_db: float | None, rng: np.random.Generator) -> Sound:
    """A sound with pink noise, so many decibels below it."""
    if ratio_db is None:
        return sound
    size = sound.samples.size
    frequencies = np.fft.rfftfreq(size)
    frequencies[0] = frequencies[1]
    noise = np.fft.irfft(np.fft.rfft(rng.standard_normal(size)) / np.sqrt(frequencies), size)
    level = np.sqrt((sound.samples**2).mean() / (noise**2).mean()) * 10 ** (-ratio_db / 20)
    mixed = sound.samples + level * noise
    return Sound((mixed / max(1, np.abs(mixed).max())).astype(np.float32))


def recordings(language: Language, seed: int) -> Iterator[dict[str, Any]]:
    """What each recogniser makes of each recording, with the processor time."""
    recognisers = [find_recogniser(name, language) for name in RECOGNISERS]
    rng = np.random.default_rng(seed)
    for kind, text, voices in items(language, seed):
        for voice in voices:
            clean = spoken(text, voice)
            for noise in NOISES_DB:
                sound = with_noise(clean, noise, rng)
                about = {"kind": kind, "text": text, "voice": voice, "noise": noise}
                row = {**about, "seconds": sound.duration_s, "ratio": sound.noise_ratio_db}
                start = time.process_time()
                row["found"] = {
                    each.name: [(one.text, one.score) for one in each.recognise(sound)]
                    for each in recognisers
                }
                yield {**row, "cpu": time.process_time() - start}


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("file", type=Path)
    parser.add_argument("--seed", type=int, default=2)
    options = parser.parse_args()
    with options.file.open("w", encoding="utf-8") as lines:
        for row in recordings(Language.load(), options.seed):
            lines.write(json.dumps(row) + "\n")
            lines.flush()

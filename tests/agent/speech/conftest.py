"""Sentences that are spoken in the test by a synthetic voice, with noise where it is wanted."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

SENTENCES = (  # that are spoken, and must be heard
    "pass me the mug",
    "a knife is used for cutting",
    "to pass a knife grab it by the blade",
    "what is a knife used for",
    "point to the hammer",
    "pick up the spoon",
    "a hammer is often used for pounding",
    "pass me something used for cutting",
    "do not pass me the knife",
    "a spoon is never used for cutting",
    "pound the nail with the hammer",
    "grab the knife by the handle",
    "why",
    "stop",
    "put it down",
    "thank you",
)

Say = Callable[[str, Path], Path]


@pytest.fixture(scope="session")
def say() -> Say:
    """Speaks a text into a file with the voice rms of flite."""
    for package in ("moonshine_voice", "pocketsphinx", "scipy"):
        pytest.importorskip(package, reason='the extra "speech" is not installed')
    program = shutil.which("flite")
    if program is None:
        pytest.skip("the program flite is not installed")

    def spoken(text: str, path: Path) -> Path:
        subprocess.run([program, "-voice", "rms", "-t", text, "-o", path], check=True)
        return path

    return spoken


def with_noise(samples: np.ndarray, ratio_db: float, seed: int = 0) -> np.ndarray:
    """Samples with pink noise, so many decibels below them."""
    frequencies = np.fft.rfftfreq(samples.size)
    frequencies[0] = frequencies[1]
    white = np.fft.rfft(np.random.default_rng(seed).standard_normal(samples.size))
    noise = np.fft.irfft(white / np.sqrt(frequencies), samples.size)
    level = np.sqrt((samples**2).mean() / (noise**2).mean()) * 10 ** (-ratio_db / 20)
    mixed = samples + level * noise
    return (mixed / max(1, np.abs(mixed).max())).astype(np.float32)


def chords(seconds: float, rate: int = 16_000) -> np.ndarray:
    """Music: three chords of three tones each."""
    time = np.arange(int(seconds * rate)) / rate
    tones = ((262, 330, 392), (349, 440, 523), (392, 494, 587))
    of = [sum(np.sin(2 * np.pi * each * time) for each in chord) / 6 for chord in tones]
    third = time.size // 3
    return np.concatenate([each[:third] for each in of]).astype(np.float32)

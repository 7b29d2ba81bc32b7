"""Sounds: what is read from files, what is refused, where utterances begin and end."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from hilt.agent.speech.sound import RATE, Sound, Transcript, microphone, utterances, write_wav
from hilt.ontology.errors import DataError, IntervalError

TONE = np.sin(2 * np.pi * 440 * np.arange(48_000) / 48_000)  # one second


def write(path: Path, rate: int, samples: np.ndarray) -> Path:
    """A WAV file."""
    wavfile.write(path, rate, samples)
    return path


@pytest.mark.parametrize("rate", [8_000, 16_000, 22_050, 44_100, 48_000])
@pytest.mark.parametrize("channels", [1, 2])
@pytest.mark.parametrize("kind", ["u1", "i2", "i4", "f4"])
def test_file_of_any_rate_width_and_channels_is_read(
    tmp_path: Path, rate: int, channels: int, kind: str
):
    """It is the same tone of one second, as loud as it was."""
    tone = 0.5 * np.sin(2 * np.pi * 440 * np.arange(rate) / rate)
    scale = {"u1": 127, "i2": 2**15 - 1, "i4": 2**31 - 1, "f4": 1}[kind]
    samples = (tone * scale + (128 if kind == "u1" else 0)).astype(kind)

    read = Sound.read(write(tmp_path / "tone.wav", rate, np.stack([samples] * channels, axis=1)))

    spectrum = np.abs(np.fft.rfft(read.samples))
    assert read.duration_s == pytest.approx(1.0, abs=0.01)
    assert spectrum.argmax() == pytest.approx(440, abs=2)
    assert np.abs(read.samples[2000:-2000]).max() == pytest.approx(0.5, abs=0.02)


def test_what_is_written_is_read_again(tmp_path: Path):
    """A sound survives its file, but for the last bit."""
    sound = Sound((0.3 * TONE[::3]).astype(np.float32))

    write_wav(tmp_path / "made" / "sound.wav", RATE, sound.pcm)

    again = Sound.read(tmp_path / "made" / "sound.wav")
    assert np.abs(again.samples - sound.samples).max() < 1e-4


def test_sound_that_is_no_utterance_is_refused_in_one_line(tmp_path: Path):
    """No file, no WAV, cut off, empty, silent, too long: the file, and what is wrong."""
    whole = write(tmp_path / "whole.wav", RATE, (TONE[::3] * 9000).astype("i2")).read_bytes()
    (tmp_path / "cut.wav").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "head.wav").write_bytes(whole[:30])
    (tmp_path / "text.wav").write_text("this is no sound", encoding="utf-8")
    (tmp_path / "nothing.wav").write_bytes(b"")
    write(tmp_path / "empty.wav", RATE, np.zeros(0, "i2"))
    write(tmp_path / "silent.wav", RATE, np.zeros(RATE, "i2"))
    write(tmp_path / "long.wav", RATE, np.resize((TONE[::3] * 9000).astype("i2"), 31 * RATE))

    found = {}
    for name in ("none", "cut", "head", "text", "nothing", "empty", "silent", "long"):
        with pytest.raises(DataError) as error:
            Sound.read(tmp_path / f"{name}.wav")
        found[name] = error.value.problem

    assert found == {
        "none": "cannot be read: No such file or directory.",
        "cut": "the sound is cut off in the middle.",
        **dict.fromkeys(("head", "text", "nothing"), "expected a sound in WAV format."),
        **dict.fromkeys(("empty", "silent"), "there is only silence in it."),
        "long": "expected at most 30 s of sound, found 31.0 s.",
    }


def test_missing_microphone_is_told():
    """On a machine without one there is one clear line."""
    pytest.importorskip("pocketsphinx", reason='the extra "speech" is not installed')
    try:
        sounddevice = pytest.importorskip("sounddevice")
    except OSError:
        pytest.skip("PortAudio is not installed")
    if sounddevice.query_devices():
        pytest.skip("this machine has a microphone")

    with pytest.raises(DataError, match=r"microphone: there is none to be used"), microphone():
        pass


def test_utterance_ends_at_a_pause(say, tmp_path: Path):
    """Two sentences with a pause between them are two sounds; each beginning is told once."""
    first, second = (
        Sound.read(say(text, tmp_path / f"{n}.wav"))
        for n, text in enumerate(["pass me the mug", "point to the hammer"])
    )
    pause, began = bytes(2 * RATE), []
    stream = pause + first.pcm + pause + second.pcm + pause
    blocks = (stream[at : at + 960] for at in range(0, len(stream) - 960, 960))

    found = list(utterances(blocks, lambda: began.append(1)))

    assert len(found) == len(began) == 2
    assert all(0.5 < each.duration_s < 3 for each in found)


def test_score_is_a_share():
    """No text is surer than certain."""
    with pytest.raises(IntervalError):
        Transcript("stop", 1.5)

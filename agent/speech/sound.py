"""Sounds from a file or a microphone, as recognisers take them, and the texts they may be."""

import warnings
import wave
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...ontology.errors import DataError, IntervalError, MissingExtraError, extra_required

RATE = 16_000  # samples a second
BLOCK = 480  # samples that the voice detection takes: 30 ms
LONGEST_S = 30.0
MICROPHONE = "microphone"
_SILENT = 1e-3  # the root mean square of the loudest tenth of a second: -60 dB


@dataclass(frozen=True)
class Transcript:
    """A text that may have been said, with a score in [0, 1]; IntervalError if it is not."""

    text: str
    score: float

    def __post_init__(self) -> None:
        if not 0 <= self.score <= 1:
            raise IntervalError(self.score, 1.0)

    def as_json(self) -> dict[str, object]:
        """Return the fields as JSON."""
        return {"text": self.text, "score": round(self.score, 4)}


@dataclass(frozen=True, eq=False)
class Sound:
    """One utterance: mono samples in [-1, 1], float32, at 16 kHz, with its file or "microphone".

    DataError if it is empty, silent, or longer than 30 s.
    """

    samples: NDArray[np.float32]
    source: str = MICROPHONE

    def __post_init__(self) -> None:
        if self.duration_s > LONGEST_S:
            problem = f"expected at most {LONGEST_S:.0f} s of sound, found {self.duration_s:.1f} s."
            raise DataError(problem, source=self.source)
        if not self.samples.size or not self._levels(0.1).max() >= _SILENT:
            raise DataError("there is only silence in it.", source=self.source)

    @classmethod
    def read(cls, file: Path | BytesIO) -> "Sound":
        """Read a WAV file of any rate, width and number of channels.

        DataError if there is none, it is cut off, or is no utterance; MissingExtraError.
        """
        with extra_required("speech", "scipy"):
            from scipy.io import wavfile
            from scipy.signal import resample_poly
        source = str(file) if isinstance(file, Path) else MICROPHONE
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", wavfile.WavFileWarning)
                warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
                rate, found = wavfile.read(file)
        except wavfile.WavFileWarning as error:
            raise DataError("the sound is cut off in the middle.", source=source) from error
        except OSError as error:
            raise DataError(f"cannot be read: {error.strerror}.", source=source) from error
        except Exception as error:  # a damaged header fails in many ways
            raise DataError("expected a sound in WAV format.", source=source) from error
        samples = _as_float(found)
        mono = samples.mean(axis=1) if samples.ndim > 1 else samples
        right = resample_poly(mono, RATE, rate) if mono.size else mono
        return cls(np.clip(right, -1, 1).astype(np.float32), source)

    def varied(self) -> "Iterator[Sound]":
        """Yield it a tenth faster, and with less of its low tones: such are often understood."""
        from scipy.signal import resample_poly

        sharper = 2 * self.samples - np.roll(self.samples, 1)
        for samples in (resample_poly(self.samples, 10, 11), sharper):
            yield replace(self, samples=np.clip(samples, -1, 1).astype(np.float32))

    @property
    def duration_s(self) -> float:
        """How long it lasts."""
        return self.samples.size / RATE

    @property
    def pcm(self) -> bytes:
        """The samples as 16-bit integers."""
        return (self.samples * 32767).astype("<i2").tobytes()

    @property
    def speech_to_noise_db(self) -> float:
        """How much louder its words are than what is between them, in [0, 60] dB."""
        low, high = np.quantile(self._levels(0.02), (0.1, 0.9)) + 1e-9
        return float(np.clip(20 * np.log10(high / low), 0, 60))

    def _levels(self, seconds: float) -> NDArray[np.float32]:
        size = min(self.samples.size, int(seconds * RATE))
        frames = self.samples[: self.samples.size // size * size].reshape(-1, size)
        return np.sqrt((frames**2).mean(axis=1))


def _as_float(found: NDArray[Any]) -> NDArray[np.float64]:
    if found.dtype.kind == "f":
        return found.astype(float)
    middle = 128.0 if found.dtype.kind == "u" else 0.0  # 8-bit samples have no sign
    return (found - middle) / 2.0 ** (8 * found.dtype.itemsize - 1)


def write_wav(path: Path, rate: int, pcm: bytes) -> None:
    """Write mono 16-bit samples to a WAV file, whose folder is made; DataError if that fails."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with wave.open(str(path), "wb") as file:
            file.setparams((1, 2, rate, 0, "NONE", ""))
            file.writeframes(pcm)
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}.", source=str(path)) from error


def utterances(blocks: Iterable[bytes], began: Callable[[], object]) -> Iterator[Sound]:
    """Yield what is said in blocks of 30 ms, 16 bit at 16 kHz; `began` is called at a beginning.

    The voice detection is that of WebRTC. An utterance ends at a pause, or after 30 s.
    """
    with extra_required("speech", "pocketsphinx"):
        from pocketsphinx import Endpointer  # pyright: ignore[reportMissingImports]

    # Its window is also what it keeps of the time before the first word.
    endpointer, spoken = Endpointer(window=0.6, sample_rate=RATE), bytearray()
    for block in blocks:
        if (voiced := endpointer.process(block)) and not spoken:
            began()
        spoken += voiced or b""
        is_full = len(spoken) + len(block) > LONGEST_S * RATE * 2
        if spoken and (is_full or not endpointer.in_speech):
            with suppress(DataError):  # too faint
                yield Sound((np.frombuffer(bytes(spoken), "<i2") / 32768).astype(np.float32))
            spoken.clear()


@contextmanager
def microphone(began: Callable[[], object] = lambda: None) -> Generator[Iterator[Sound]]:
    """The utterances that are spoken during the block; DataError if there is no microphone."""
    blocks: SimpleQueue[bytes] = SimpleQueue()

    def take(data: Any, *_: object) -> None:
        blocks.put(bytes(data))

    format = {"channels": 1, "dtype": "int16", "blocksize": BLOCK}
    with open_stream("RawInputStream", RATE, callback=take, **format):
        yield utterances(iter(blocks.get, None), began)


def open_stream(kind: str, rate: int, **options: Any) -> Any:
    """Open a stream of the sound card; DataError if there is none, MissingExtraError."""
    try:
        with extra_required("speech", "sounddevice"):
            import sounddevice  # pyright: ignore[reportMissingImports]

        return getattr(sounddevice, kind)(rate, **options)
    except MissingExtraError:
        raise
    except Exception as error:  # of PortAudio, which is missing or finds no such device
        device = MICROPHONE if kind == "RawInputStream" else "loudspeaker"
        raise DataError(f"there is none to be used ({error}).", source=device) from error

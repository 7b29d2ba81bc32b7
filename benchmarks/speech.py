"""How often speech is understood: three synthetic voices, clean and with pink noise.

    python benchmarks/speech.py listen out/1.jsonl --seed 1     # 20 minutes; so is seed 2
    python benchmarks/speech.py fit out/1.jsonl out/2.jsonl     # the calibration; error on the 2nd
    python benchmarks/speech.py table out/2.jsonl

Sentences of the grammar are drawn by chance, free ones are those of `tests/nlu/data`, and others
are no sentences for Hilt, some of them in another language. It needs the programs espeak-ng, flite
and text2wave (festival with the voice cmu_us_slt_arctic_hts), and the extra "speech".
"""

# ruff: noqa: S311 - no secrets
from __future__ import annotations

import argparse
import json
import random
import re
import subprocess
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import yaml

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.speech import listening
from hilt.agent.speech.listening import FEATURES, RECOGNISERS, Listener
from hilt.agent.speech.sound import Sound, Transcript
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
HARMLESS = {"question", "acknowledgement"}  # kinds of what neither acts nor is believed
OUTCOMES = ("at once", "after a question", "asked", "answered", "wrong")
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
    listener = Listener.open((), language)
    rng = np.random.default_rng(seed)
    for kind, text, voices in items(language, seed):
        for voice in voices:
            clean = spoken(text, voice)
            for noise in NOISES_DB:
                sound = with_noise(clean, noise, rng)
                about = {"kind": kind, "text": text, "voice": voice, "noise": noise}
                row = {**about, "seconds": sound.duration_s, "ratio": sound.speech_to_noise_db}
                start = time.process_time()
                row["found"] = {
                    name: [(one.text, one.score) for one in each]
                    for name, each in listener.found(sound).items()
                }
                yield {**row, "cpu": time.process_time() - start}


Row = dict[str, Any]
LANGUAGE = Language.load()
LANGUAGE_SEEN = SimpleNamespace(understand=cache(lambda text, discourse: LANGUAGE.understand(text)))


def read(path: Path) -> list[Row]:
    """The recordings in a file, but for sentences that Hilt does not understand as they stand."""
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return [row for row in rows if row["kind"] == "other" or meaning(row["text"])]


def meaning(text: str) -> str:
    """What a text means, without what was said before."""
    return listening.meaning_key(LANGUAGE_SEEN.understand(text, None))


def found(row: Row) -> dict[str, tuple[Transcript, ...]]:
    """What each recogniser found in a recording."""
    return {name: tuple(Transcript(*each) for each in row["found"][name]) for name in RECOGNISERS}


def examples(rows: Iterable[Row]) -> tuple[np.ndarray, np.ndarray]:
    """The features of each meaning that was heard, and whether it is right."""
    listener, features, right = Listener((), LANGUAGE_SEEN), [], []
    for row in rows:
        for each in listener.meanings(found(row), row["ratio"]):
            features.append([each.features[name] for name in FEATURES])
            right.append(row["kind"] != "other" and meaning(each.text) == meaning(row["text"]))
    return np.array(features), np.array(right, float)


def fitted(features: np.ndarray, right: np.ndarray, penalty: float = 0.5) -> np.ndarray:
    """The weights of a logistic regression, with a quadratic penalty on all but the bias."""
    from scipy.optimize import minimize

    kept = np.array([0.0, *[penalty] * (len(FEATURES) - 1)])

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        total = features @ weights
        error = 1 / (1 + np.exp(-total)) - right
        value = np.logaddexp(0, total).sum() - right @ total + kept @ weights**2 / 2
        return value, features.T @ error + kept * weights

    return minimize(loss, np.zeros(len(FEATURES)), jac=True).x


def calibration_error(share: np.ndarray, right: np.ndarray) -> float:
    """The mean distance between certainty and share of right ones in ten bins (Naeini 2015)."""
    bins = np.minimum((share * 10).astype(int), 9)
    return sum(abs((share - right)[bins == each].sum()) for each in range(10)) / len(right)


def fit(path: Path, held_out: Path) -> None:
    """Write the calibration, fitted to one file, with its error on another."""
    weights = fitted(*examples(read(path)))
    features, right = examples(read(held_out))
    error = calibration_error(1 / (1 + np.exp(-features @ weights)), right)
    document = {
        "source": f"benchmarks/speech.py: {len(read(path))} recordings of three synthetic voices, "
        "of seed 1; the error is that of others, of seed 2",
        "error": round(float(error), 3),
        "weights": {
            name: round(float(each), 2) for name, each in zip(FEATURES, weights, strict=True)
        },
    }
    file = Path(__file__).parents[1] / "agent" / "speech" / "calibration.yaml"
    file.write_text(yaml.safe_dump(document, sort_keys=False, width=100), encoding="utf-8")
    print(file.read_text(encoding="utf-8"))


def outcome(row: Row) -> str:
    """What becomes of a recording that is said to a new agent.

    It is right "at once" or "after a question" that has what was meant as a choice, or "asked"
    about; or something else is "answered" that changes nothing, or done or believed, which is
    "wrong".
    """
    heard_before = [
        SimpleNamespace(name=name, recognise=lambda _, name=name: found(row)[name])
        for name in RECOGNISERS
    ]
    listener = Listener(tuple(heard_before), LANGUAGE_SEEN)
    heard = listener.hear(SimpleNamespace(speech_to_noise_db=row["ratio"], varied=tuple))
    if not heard.text:
        return "asked"
    agent = Agent.open("memory:", AgentConfig(simulate=False, scene="all"))
    alternatives = [(each.text, each.score) for each in heard.alternatives]
    reply = agent.hear(heard.text, heard=heard.heard, alternatives=alternatives)
    question = agent.dialogue.conversation.open_question
    agent.close()
    wanted = meaning(row["text"]) if row["kind"] != "other" else "nothing"
    if reply.understanding.kind in {"error", "ask_back"}:
        choices = [
            each for each in (question.meanings if question else ()) if hasattr(each, "as_json")
        ]
        offered = [json.dumps(each.as_json(), sort_keys=True) for each in choices]
        return "after a question" if wanted in offered else "asked"
    if meaning(reply.understanding.text) == wanted:
        return "at once"
    return "answered" if reply.understanding.kind in HARMLESS else "wrong"


def words_of(text: str) -> str:
    """A text without marks and capitals."""
    return " ".join(re.findall(r"[a-z']+", text.lower()))


def modelled() -> set[str]:
    """The sentences from which the language model of PocketSphinx is made, as it draws them."""
    drawn = sentences(LANGUAGE, 20_000, random.Random(0))
    return {words_of(text) for text in (*drawn, *LANGUAGE.examples)}


def table(path: Path) -> None:
    """Print how often each outcome is, as shares.

    Sentences from which the language model was made, word for word, are counted apart.
    """
    counts, rows = defaultdict[tuple[str, str], Counter[str]](Counter), read(path)
    known = modelled()
    for row in rows:
        kind = row["kind"] + ", modelled" * (words_of(row["text"]) in known)
        noise = "clean" if row["noise"] is None else f"{row['noise']} dB"
        counts[kind, noise][outcome(row)] += 1
    print(f"| sentences | noise | n | {' | '.join(OUTCOMES)} |\n|" + "---|" * 8)
    for (kind, noise), counted in sorted(counts.items(), key=str):
        n = counted.total()
        shares = (f"{counted[each] / n:.2f}" for each in OUTCOMES)
        print(f"| {kind} | {noise} | {n} | {' | '.join(shares)} |")
    cpu, seconds = (sum(row[name] for row in rows) for name in ("cpu", "seconds"))
    print(f"processor time per second of sound, both recognisers: {cpu / seconds:.2f}")


def listen(path: Path, seed: int) -> None:
    """Write what is heard in all recordings of a seed."""
    with path.open("w", encoding="utf-8") as lines:
        for row in recordings(LANGUAGE, seed):
            lines.write(json.dumps(row) + "\n")
            lines.flush()


def main(arguments: Sequence[str] | None = None) -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", choices=("listen", "fit", "table"))
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--seed", type=int, default=2)
    given = parser.parse_args(arguments)
    if given.task == "listen":
        listen(given.files[0], given.seed)
    else:
        {"fit": fit, "table": table}[given.task](*given.files)


if __name__ == "__main__":
    main()

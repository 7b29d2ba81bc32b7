"""The recognisers that Hilt brings with their models, and those of plug-ins.

Moonshine tiny (Jeffries et al. 2024) is a neural recogniser of English: it writes any sentence, but
gives no score; what its text is worth, others tell. PocketSphinx (Huggins-Daines et al. 2006) has
the word triples of Hilt's own grammar, made anew when words are learned and kept in the cache. Of
what the grammar has it hears more; of anything else it makes such a sentence, too.
"""

import random
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from ...nlu.jsgf import grammar_of, sentences
from ...nlu.language import Language
from ...ontology.disk_cache import cache_folder, cached, content_key
from ...ontology.errors import extra_required
from ...ontology.plugins import call_plugin
from ...ontology.yaml_reader import read_text
from ..protocols import SpeechRecogniser
from .sound import RATE, Sound, Transcript

ALTERNATIVES = 10
_SENTENCES = 20_000  # of the grammar, by chance
_REPEATED = 20  # how often an example of the language is among them
_SEARCHED = 200  # of the best paths, most of which differ in their times only
_SILENCE = np.zeros(int(0.3 * RATE), "<i2").tobytes()
_ENDINGS = {"ing": "IH NG", "er": "ER", "ed": "D", "ly": "L IY", "y": "IY", "s": "Z"}


class MoonshineRecogniser:
    """Moonshine tiny; MissingExtraError if it is not installed."""

    name = "moonshine"

    def __init__(self, language: Language) -> None:
        with extra_required("speech", "moonshine-voice"):
            from moonshine_voice import ModelArch, Transcriber, get_model_path  # pyright: ignore[reportMissingImports]

        options = {"vad_threshold": "0", "return_audio_data": "false"}  # 0: nothing is cut away
        self._transcriber = Transcriber(str(get_model_path()), ModelArch.TINY, options=options)

    def learn(self, language: Language) -> None:
        """Do nothing: it has the words of English."""

    def recognise(self, sound: Sound) -> tuple[Transcript, ...]:
        """Return the only text that it finds, if any."""
        found = self._transcriber.transcribe_without_streaming(sound.samples.tolist())
        text = " ".join(line.text.strip() for line in found.lines if line.text.strip())
        return (Transcript(text, 1.0),) if text else ()


class PocketSphinxRecogniser:
    """PocketSphinx for what a language has now; MissingExtraError if it is not installed."""

    name = "pocketsphinx"

    def __init__(self, language: Language) -> None:
        self._model = Path()
        self.learn(language)

    def learn(self, language: Language) -> None:
        """Take the words of a language that are known now."""
        with extra_required("speech", "pocketsphinx"):
            from pocketsphinx import Decoder  # pyright: ignore[reportMissingImports]

        examples = [" ".join(re.findall(r"[a-z']+", each.lower())) for each in language.examples]
        key = content_key(grammar_of(language).encode(), "\n".join(examples).encode())
        folder = cache_folder() / "speech" / key
        model = cached(folder, lambda draft: _write_model(draft, language, examples))
        if model != self._model:
            files = {"lm": str(model / "model.arpa"), "dict": str(model / "words.dict")}
            self._decoder, self._model = Decoder(**files, loglevel="FATAL"), model

    def recognise(self, sound: Sound) -> tuple[Transcript, ...]:
        """Return up to ten texts, each with its share of the likelihood of all of them."""
        decoder = self._decoder
        decoder.start_utt()
        decoder.process_raw(_SILENCE + sound.pcm + _SILENCE, full_utt=True)
        decoder.end_utt()
        best = decoder.hyp()
        found = {best.hypstr: best.score} if best and best.hypstr else {}
        for each in filter(None, islice(decoder.nbest(), _SEARCHED) if found else ()):
            found.setdefault(each.hypstr, min(each.score, best.score))
        first = [each for each in found.items() if each[0]][:ALTERNATIVES]
        total = sum(score for _, score in first)
        return tuple(Transcript(text, score / total) for text, score in first)


# The one that spells best is first.
RECOGNISERS = {each.name: each for each in (MoonshineRecogniser, PocketSphinxRecogniser)}


def find_recogniser(name: str, language: Language) -> SpeechRecogniser:
    """Return a recogniser of Hilt or of a plug-in, NAME or NAME:REST with what it is told.

    UnknownNameError if there is no such recogniser; MissingExtraError if it is not installed.
    """
    own, (plugin, _, rest) = RECOGNISERS.get(name), name.partition(":")
    if own:
        return own(language)
    needs = ("name", "recognise", "learn")
    return call_plugin("hilt.recogniser", plugin, rest, language, methods=needs)


def _write_model(folder: Path, language: Language, examples: list[str]) -> None:
    from pocketsphinx.lm import ArpaBoLM  # pyright: ignore[reportMissingImports]

    rng = random.Random(0)  # noqa: S311 - no secret
    said = [*sentences(language, _SENTENCES, rng), *examples * _REPEATED]
    known = pronunciations()
    spelt = {word: spell(word, known) for word in sorted(set(" ".join(said).split()))}
    lines = [
        f"{word}({n}) {phones}\n" if n > 1 else f"{word} {phones}\n"
        for word, ways in spelt.items()
        for n, phones in enumerate(ways, start=1)
    ]
    folder.mkdir()
    (folder / "words.dict").write_text("".join(lines), encoding="utf-8")
    speakable = [text for text in said if all(spelt[word] for word in text.split())]
    model = ArpaBoLM(text="\n".join(speakable), add_start=True)
    model.compute()
    model.write_file(str(folder / "model.arpa"))


def pronunciations() -> Mapping[str, Sequence[str]]:
    """Return the CMU Pronouncing Dictionary: the ways to say a word, each its phones with spaces.

    MissingExtraError if PocketSphinx, which brings it, is not installed.
    """
    with extra_required("speech", "pocketsphinx"):
        from pocketsphinx import get_model_path  # pyright: ignore[reportMissingImports]

    known = defaultdict[str, list[str]](list)
    for line in read_text(Path(get_model_path("en-us/cmudict-en-us.dict"))).splitlines():
        word, _, phones = line.partition(" ")
        known[word.partition("(")[0]].append(phones)  # "a(2)" is another way to say "a"
    return known


def spell(word: str, known: Mapping[str, Sequence[str]]) -> Sequence[str]:
    """Return how a word is said, in phones: a known one, or one of two parts ("tea spoon")."""
    if word in known:
        return known[word]
    for at in range(len(word) - 1, 2, -1):
        first, last = word[:at], word[at:]
        rest = known[last][0] if len(last) > 2 and last in known else _ENDINGS.get(last)
        if first in known and rest:
            return [f"{known[first][0]} {rest}"]
    return []

"""What several recognisers heard together: a text for each meaning, with its certainty.

A recogniser's own score is no probability. How often a meaning is right is a logistic function of
who else means it, how alike the texts are, the length and the noise, with weights that are fitted
to recordings (`calibration.yaml`, by `benchmarks/speech.py`).
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from functools import cache
from pathlib import Path

from ...nlu.language import Language
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics.discourse import Discourse
from ...ontology.yaml_reader import read_yaml
from ..protocols import SpeechRecogniser
from .recognisers import RECOGNISERS, find_recogniser
from .sound import Sound, Transcript

MOST_ALONE = 0.89  # the most that is certain of what not all recognisers mean
FEATURES = ("bias", "first", "agreeing", "against", "likeness", "words", "noise", "new_words")
_CALIBRATION = Path(__file__).with_name("calibration.yaml")
Found = Mapping[str, Sequence[Transcript]]  # by the name of the recogniser, best first


@dataclass(frozen=True)
class Heard:
    """What was heard."""

    text: str  #: the likeliest text; empty if there are no words in the sound
    heard: float  #: the share of such hearings that are right, in [0, 1]; 0 if it is not understood
    #: a text for each meaning, then texts without one, best first; their scores are such shares
    #: too, at most 1 in all
    alternatives: tuple[Transcript, ...]
    recognisers: tuple[str, ...]  #: the names of those that found words
    agreed: bool  #: whether there are several, and the best text of each means this

    def as_json(self) -> dict[str, object]:
        """Return the fields as JSON."""
        listed = {"alternatives": [each.as_json() for each in self.alternatives]}
        return {**vars(self), "heard": round(self.heard, 4), **listed}


@dataclass(frozen=True)
class Listener:
    """Hears with recognisers what a language understands."""

    recognisers: tuple[SpeechRecogniser, ...]
    language: Language

    @classmethod
    def open(cls, names: Sequence[str], language: Language) -> "Listener":
        """Return a listener with recognisers of Hilt or of plug-ins; without names, with Hilt's.

        UnknownNameError if there is no such recogniser; MissingExtraError if it is not installed.
        """
        opened = (find_recogniser(name, language) for name in names or RECOGNISERS)
        return cls(tuple(opened), language)

    def learned(self, language: Language) -> "Listener":
        """Return this listener with the words that are known now, which its recognisers take."""
        if language is not self.language:
            for each in self.recognisers:
                each.learn(language)
        return replace(self, language=language)

    def hear(self, sound: Sound, discourse: Discourse | None = None) -> Heard:
        """Return what was said, at this point of a conversation."""
        found = self.found(sound, discourse)
        meanings = self.meanings(found, sound.speech_to_noise_db, discourse)
        ranked = sorted(meanings, key=lambda each: -each.certainty)
        shares, rest = dict[str, float](), 1.0
        for each in ranked:
            shares[each.text] = min(each.certainty, rest)
            rest = max(0.0, rest - shares[each.text])
        for text in (each[0].text for each in found.values() if each):
            if not meaning_key(self.language.understand(text, discourse=discourse)):
                shares[text] = 0.0
        listed = tuple(Transcript(*each) for each in shares.items())
        first = listed[0] if listed else Transcript("", 0.0)
        names = tuple(name for name, each in found.items() if each)
        return Heard(first.text, first.score, listed, names, bool(ranked and ranked[0].is_agreed))

    def found(self, sound: Sound, discourse: Discourse | None = None) -> Found:
        """Return what each recogniser finds; the first one hears again what is not understood."""
        found = {each.name: tuple(each.recognise(sound)) for each in self.recognisers}
        first = self.recognisers[0]
        for again in sound.varied() if found[first.name] else ():
            texts = (each.text for each in found[first.name])
            heard = (self.language.understand(text, discourse=discourse) for text in texts)
            if any(meaning_key(each) and not each.unknown for each in heard):
                break
            found[first.name] += tuple(first.recognise(again))
        return found

    def meanings(
        self, found: Found, speech_to_noise_db: float, discourse: Discourse | None = None
    ) -> "list[HeardMeaning]":
        """Return the meanings that may have been said, those of the first recogniser first."""
        texts = dict.fromkeys(each.text for listed in found.values() for each in listed)
        understood = {text: self.language.understand(text, discourse=discourse) for text in texts}
        best = [each[0].text if each else "" for each in found.values()]
        means = {text: meaning_key(each) for text, each in understood.items()} | {"": "nothing"}
        first = {means[text]: text for text in reversed(texts) if means[text]}
        heard: list[HeardMeaning] = []
        for meaning, text in first.items():
            voting = [means[each] for each in best]
            others, for_it = max(1, len(best) - 1), voting.count(meaning)
            signs = {
                "bias": 1.0,
                "first": float(for_it > 0),
                "agreeing": max(0, for_it - 1) / others,
                "against": sum(each not in ("", meaning) for each in voting) / others,
                "likeness": _likeness(text, best),
                "words": len(text.split()) / 10,
                "noise": min(1.0, speech_to_noise_db / 30),
                "new_words": float(bool(understood[text].unknown)),
            }
            heard.append(HeardMeaning(text, 1 < len(best) == for_it, signs))
        return heard


@dataclass(frozen=True)
class HeardMeaning:
    """A meaning that may have been said: its first text, and what speaks for it, by `FEATURES`."""

    text: str
    is_agreed: bool
    features: Mapping[str, float]

    @property
    def certainty(self) -> float:
        """The share of such meanings that are right; below 0.9 unless all recognisers agree."""
        total = sum(weight * self.features[name] for name, weight in _weights().items())
        share = 1 / (1 + math.exp(-total))
        return share if self.is_agreed else min(share, MOST_ALONE)


def _likeness(text: str, best: Iterable[str]) -> float:
    letters = [[each for each in one.lower() if each.isalnum()] for one in (text, *best)]
    alike = sorted(SequenceMatcher(None, letters[0], other).ratio() for other in letters[1:])
    return sum(alike[:-1]) / max(1, len(alike) - 1)  # without its own


def meaning_key(understood: Understanding) -> str:
    """Return what texts that mean the same have in common; empty for what is not clear."""
    is_clear = understood.kind not in {"error", "ask_back"}
    return json.dumps(understood.meaning.as_json(), sort_keys=True) if is_clear else ""


@cache
def _weights() -> Mapping[str, float]:
    nodes = read_yaml(_CALIBRATION).entries(required=("weights",))["weights"]
    return {name: e.number() for name, e in nodes.entries(required=FEATURES, optional=()).items()}

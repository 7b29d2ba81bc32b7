"""What several recognisers heard together: a text for each meaning, with its certainty.

A recogniser's own score is no probability. How often a meaning is right is a logistic function of
who else means it, how alike the texts are, the margin, the length and the noise; its weights are
fitted to recordings (`calibration.yaml`, by `benchmarks/speech.py`).
"""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import cache
from pathlib import Path

from ...nlu.language import Language
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics.discourse import Discourse
from ...ontology.plugins import call_plugin
from ...ontology.yaml_reader import read_yaml
from ..protocols import SpeechRecogniser
from .sound import Sound, Transcript

RECOGNISERS = ("moonshine", "pocketsphinx")  # the one that spells best is first
SURE = 0.9  # the least certainty of what all recognisers mean; that of others is below
FEATURES = (
    *("bias", "first", "agreeing", "meeting", "against", "likeness"),
    *("margin", "words", "noise", "new_words"),
)
_CALIBRATION = Path(__file__).with_name("calibration.yaml")


@dataclass(frozen=True)
class Heard:
    """What was heard.

    Attributes:
        text: the likeliest text; empty if there are no words in the sound.
        heard: the share of such hearings that are right, in [0, 1]; 0 if it is not understood.
        alternatives: a text for each meaning, then texts without one, best first; their scores are
            such shares too, at most 1 in all.
        recognisers: the names of those that found words.
        agreed: whether there are several, and the best text of each means this.
    """

    text: str
    heard: float
    alternatives: tuple[Transcript, ...]
    recognisers: tuple[str, ...]
    agreed: bool

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
    def open(cls, names: Sequence[str], language: Language) -> Listener:
        """Return a listener with recognisers of Hilt or of plug-ins; without names, with Hilt's.

        UnknownNameError if there is no such recogniser; MissingExtraError if it is not installed.
        """
        opened = (find_recogniser(name, language) for name in names or RECOGNISERS)
        return cls(tuple(opened), language)

    def learned(self, language: Language) -> Listener:
        """Return this listener with the words that are known now, which its recognisers take."""
        if language is self.language:
            return self
        for each in self.recognisers:
            each.learn(language)
        return Listener(self.recognisers, language)

    def hear(self, sound: Sound, discourse: Discourse | None = None) -> Heard:
        """Return what was said, at this point of a conversation."""
        found = {each.name: tuple(each.recognise(sound)) for each in self.recognisers}
        return self.weigh(found, sound.speech_to_noise_db, discourse)

    def weigh(
        self,
        found: Mapping[str, Sequence[Transcript]],
        speech_to_noise_db: float,
        discourse: Discourse | None = None,
    ) -> Heard:
        """Return what was said if this is what the recognisers found, by their names."""
        candidates = self.candidates(found, speech_to_noise_db, discourse)
        ranked = sorted(candidates, key=HeardMeaning.certainty, reverse=True)
        shares, rest = dict[str, float](), 1.0
        for each in ranked:
            shares[each.text] = min(each.certainty(), rest)
            rest -= shares[each.text]
        understood = {text for each in ranked for text in each.texts}
        for best in (transcripts[0].text for transcripts in found.values() if transcripts):
            if best not in understood:
                shares[best] = 0.0
        listed = tuple(Transcript(*each) for each in shares.items())
        first = listed[0] if listed else Transcript("", 0.0)
        names = tuple(name for name, each in found.items() if each)
        return Heard(first.text, first.score, listed, names, bool(ranked and ranked[0].is_agreed))

    def candidates(
        self,
        found: Mapping[str, Sequence[Transcript]],
        speech_to_noise_db: float,
        discourse: Discourse | None = None,
    ) -> list[HeardMeaning]:
        """Return the meanings that may have been said, those of the first recogniser first."""
        texts = dict.fromkeys(each.text for transcripts in found.values() for each in transcripts)
        understood = {text: self.language.understand(text, discourse=discourse) for text in texts}
        meanings = {text: _key(each) for text, each in understood.items()}
        opinions = [_Opinion.of(each, meanings) for each in found.values()]
        by_meaning: dict[str, list[str]] = {}
        for text, meaning in meanings.items():
            if meaning:
                by_meaning.setdefault(meaning, []).append(text)
        return [
            HeardMeaning(
                tuple(said),
                len(opinions) > 1 and all(each.best == meaning for each in opinions),
                _votes(meaning, said[0], opinions)
                | {
                    "bias": 1.0,
                    "words": len(said[0].split()) / 10,
                    "noise": speech_to_noise_db / 60,
                }
                | {"new_words": float(bool(understood[said[0]].unknown))},
            )
            for meaning, said in by_meaning.items()
        ]


@dataclass(frozen=True)
class HeardMeaning:
    """A meaning that may have been said: its texts, and what speaks for it, by `FEATURES`."""

    texts: tuple[str, ...]
    is_agreed: bool
    features: Mapping[str, float]

    @property
    def text(self) -> str:
        """The text of the recogniser that spells best."""
        return self.texts[0]

    def certainty(self) -> float:
        """Return the share of such candidates that are right, below 0.9 unless all agree."""
        total = sum(weight * self.features[name] for name, weight in weights().items())
        share = 1 / (1 + math.exp(-total))
        return share if self.is_agreed else min(share, SURE - 0.01)


@dataclass(frozen=True)
class _Opinion:
    text: str  # the best one
    best: str  # its meaning; empty if it has none
    shares: Mapping[str, float]  # of each meaning

    @classmethod
    def of(cls, found: Sequence[Transcript], meanings: Mapping[str, str]) -> _Opinion:
        shares: dict[str, float] = defaultdict(float)
        for each in found:
            shares[meanings[each.text]] += each.score
        best = found[0].text if found else ""
        return cls(best, meanings.get(best, "nothing"), shares)

    def margin(self, meaning: str) -> float:
        others = (share for each, share in self.shares.items() if each != meaning)
        return self.shares[meaning] - max(others, default=0.0)


def _votes(meaning: str, text: str, opinions: Sequence[_Opinion]) -> dict[str, float]:
    voters = [each for each in opinions if each.best == meaning]
    holders = [each for each in opinions if meaning in each.shares]
    against = [each for each in opinions if each.best not in ("", meaning)]
    others, alike = max(1, len(opinions) - 1), [_likeness(text, each.text) for each in opinions]
    return {
        "first": float(bool(voters)),
        "agreeing": max(0, len(voters) - 1) / others,
        "meeting": (len(holders) - max(1, len(voters))) / others,
        "against": len(against) / others,
        "likeness": (sum(alike) - max(alike)) / others,
        "margin": min(each.margin(meaning) for each in holders),
    }


def _likeness(*texts: str) -> float:
    first, second = ([each for each in text.lower() if each.isalnum()] for text in texts)
    return SequenceMatcher(None, first, second, autojunk=False).ratio()


def _key(understood: Understanding) -> str:
    if understood.kind in {"error", "ask_back"}:
        return ""
    return json.dumps(understood.meaning.as_json(), sort_keys=True)


@cache
def weights() -> Mapping[str, float]:
    """Return the weight of each feature; DataError if the calibration is damaged."""
    nodes = read_yaml(_CALIBRATION).entries(required=("weights",))["weights"]
    return {name: each.number() for name, each in nodes.entries(required=FEATURES).items()}


def find_recogniser(name: str, language: Language) -> SpeechRecogniser:
    """Return a recogniser of Hilt or of a plug-in; errors as of `Listener.open`."""
    if name == "moonshine":
        from .moonshine import MoonshineRecogniser as Own
    elif name == "pocketsphinx":
        from .pocketsphinx import PocketSphinxRecogniser as Own
    else:
        needs, (plugin, _, rest) = ("name", "recognise", "learn"), name.partition(":")
        return call_plugin("hilt.recogniser", plugin, rest, language, methods=needs)
    return Own(language)

"""What recognisers hear together: how often it is right, and that it is not sure alone."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.agent.speech.listening import Heard, Listener, find_recogniser, meaning_key
from hilt.agent.speech.recognisers import spell
from hilt.agent.speech.sound import RATE, Sound, Transcript
from hilt.nlu.language import Language
from hilt.ontology.errors import UnknownNameError

from .conftest import SENTENCES, Say, chords, with_noise

TONE = Sound(np.sin(np.arange(RATE) / 6).astype(np.float32))


@dataclass
class Scripted:
    """A recogniser that finds what it was told."""

    name: str
    found: Sequence[Transcript]

    def recognise(self, sound: Sound) -> Sequence[Transcript]:
        """What it was told."""
        return self.found

    def learn(self, language: Language) -> None:
        """Nothing."""


@pytest.fixture(scope="module")
def language() -> Language:
    """English with the household vocabulary."""
    return Language.load()


@pytest.fixture(scope="module")
def listener(language: Language, say: Say) -> Listener:
    """Both recognisers of Hilt."""
    return Listener.open((), language)


def scripted(language: Language, *found: Sequence[Transcript]) -> Heard:
    """What is heard if the recognisers find this."""
    return Listener(tuple(Scripted(f"{n}", each) for n, each in enumerate(found)), language).hear(
        TONE
    )


def test_what_is_not_understood_is_heard_again(language: Language):
    """The first recogniser hears it faster, then with less of the low tones, until it is clear."""
    texts = [["pars of the nigh"], ["pass me the knife"], ["stop"]]

    class Retrying(Scripted):
        def recognise(self, sound: Sound) -> Sequence[Transcript]:
            lengths.append(sound.samples.size)
            return [Transcript(text, 1.0) for text in texts[len(lengths) - 1]]

    lengths: list[int] = []
    other = Scripted("other", [Transcript("pass me the night", 1.0)])
    heard = Listener((Retrying("first", ()), other), language).hear(TONE)

    assert "pass me the knife" in [each.text for each in heard.alternatives]
    assert lengths == [RATE, -(-RATE * 10 // 11)]
    assert heard.heard < 0.9


def test_spoken_sentences_are_understood_or_asked_about(
    listener: Listener, say: Say, tmp_path: Path
):
    """Half is sure at once, three quarters are offered; what is sure is right, with noise too."""
    sure, offered, wrong = {None: 0, 10.0: 0}, 0, []
    for text in SENTENCES:
        clear = Sound.read(say(text, tmp_path / "said.wav"))
        for noise in sure:
            sound = clear if noise is None else Sound(with_noise(clear.samples, noise))
            heard = listener.hear(sound)
            choices = [meaning(listener, each.text) for each in heard.alternatives[:3]]
            offered += noise is None and meaning(listener, text) in choices
            if heard.heard >= 0.9:
                sure[noise] += 1
                is_right = meaning(listener, heard.text) == meaning(listener, text)
                wrong += [] if is_right else [(text, heard.text, noise)]

    assert sure[None] >= 0.5 * len(SENTENCES)
    assert offered >= 0.75 * len(SENTENCES)
    assert wrong == []


def meaning(listener: Listener, text: str) -> str:
    """What a text means."""
    return meaning_key(listener.language.understand(text))


@pytest.mark.parametrize("voice", ["de", "fr"])
def test_other_language_and_music_are_never_sure(listener: Listener, voice: str, tmp_path: Path):
    """Nothing may be believed or done because of them."""
    program = shutil.which("espeak-ng")
    if program is None:
        pytest.skip("the program espeak-ng is not installed")
    texts = {"de": "Das Wetter wird morgen wieder schön", "fr": "Il fait très beau aujourd'hui"}
    command = [program, "-v", voice, "-w", tmp_path / "other.wav", texts[voice]]
    subprocess.run(command, check=True)

    found = [listener.hear(Sound.read(tmp_path / "other.wav")), listener.hear(Sound(chords(3)))]

    assert all(each.heard < 0.9 for each in found)


def test_only_what_all_mean_is_sure(language: Language):
    """Two recognisers that mean the same are sure; one alone, or two that differ, are not."""
    mug, knife = Transcript("Pass me the mug.", 1.0), Transcript("pass me the knife", 1.0)
    same = Transcript("give me the mug", 1.0)

    agreed, alone = scripted(language, [mug], [same]), scripted(language, [mug])
    apart, deaf = scripted(language, [mug], [knife]), scripted(language, [mug], [])

    assert (agreed.text, agreed.agreed, len(agreed.alternatives)) == (mug.text, True, 1)
    assert agreed.heard >= 0.9
    assert all(each.heard < 0.9 and not each.agreed for each in (alone, apart, deaf))
    assert {each.text for each in apart.alternatives} == {mug.text, knife.text}


def test_what_is_not_understood_has_no_certainty(language: Language):
    """Its text is there, for a repair."""
    heard = scripted(language, [Transcript("grab your tightened blade", 1.0)], [])

    assert (heard.text, heard.heard) == ("grab your tightened blade", 0.0)
    assert scripted(language, [], []).text == ""


def test_what_one_does_not_understand_stays_beside_what_another_does(language: Language):
    """It may be the better text, but for a word that a repair replaces."""
    written = Transcript("I take back what I said about mubs being for pounding", 1.0)
    heard = scripted(language, [written], [Transcript("what is used for pounding", 1.0)])

    assert [each.text for each in heard.alternatives][1:] == [written.text]
    assert heard.alternatives[1].score == 0.0


found_texts = st.lists(
    st.builds(
        Transcript,
        st.sampled_from([*SENTENCES, "pass the by by", "a meet is used for cutting", "weather"]),
        st.floats(0, 1),
    ),
    max_size=5,
)


@given(first=found_texts, second=found_texts)
def test_certainties_are_shares(language: Language, first: list, second: list):
    """They are in [0, 1], at most 1 in all, best first; nothing is sure but what is agreed."""
    heard = scripted(language, first, second)

    scores = [each.score for each in heard.alternatives]
    assert all(0 <= each <= 1 for each in scores)
    assert sum(scores) <= 1 + 1e-9
    assert scores == sorted(scores, reverse=True)
    assert heard.agreed or heard.heard < 0.9


def test_learned_words_are_heard(say: Say, tmp_path: Path):
    """The grammar of the recogniser is made anew when a word is taught."""
    language = Language.load()
    recogniser = find_recogniser("pocketsphinx", language)
    sound = Sound.read(say("pass me the compass", tmp_path / "said.wav"))
    before = recogniser.recognise(sound)
    understood = language.understand("a compass is used for pointing")

    recogniser.learn(language.with_words(understood.new_words))

    assert "compass" not in before[0].text
    assert recogniser.recognise(sound)[0].text == "pass me the compass"


def test_words_are_spelt_from_their_parts():
    """A word that the dictionary lacks is said as two words of it, or as one with an ending."""
    known = {"tea": ["T IY"], "spoon": ["S P UW N"], "clasp": ["K L AE S P"], "a": ["AH", "EY"]}

    assert spell("a", known) == ["AH", "EY"]
    assert spell("teaspoon", known) == ["T IY S P UW N"]
    assert spell("clasping", known) == ["K L AE S P IH NG"]
    assert spell("spork", known) == []


def test_unknown_recogniser_is_told(language: Language):
    """Its name, and those of the plug-ins there are."""
    with pytest.raises(UnknownNameError, match=r'no plug-in of hilt\.recogniser "ears"'):
        find_recogniser("ears", language)

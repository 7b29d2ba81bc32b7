"""Voices: what is said of an answer, and that it is heard again."""

from pathlib import Path

import pytest

from hilt.agent.speech.listening import Listener
from hilt.agent.speech.sound import Sound
from hilt.agent.speech.voices import MOST_CHARACTERS, find_voice, spoken_form
from hilt.nlu.language import Language
from hilt.ontology.errors import UnknownNameError


def test_answers_are_short_when_spoken():
    """The first sentences, without intervals and the ids of rules."""
    assert spoken_form("Here is the knife. I'm holding it by the blade.").endswith("blade.")
    assert spoken_form("It is for cutting [0.95, 1.00] (rule/3f9c).") == "It is for cutting."
    assert len(spoken_form("I was told so by Sam. " * 40)) <= MOST_CHARACTERS
    assert spoken_form("") == ""


def test_own_voice_writes_a_file(tmp_path: Path):
    """It lasts as long as a sentence does."""
    pytest.importorskip("espeakng_loader", reason='the extra "speech" is not installed')

    find_voice("espeak").save("Here is the knife.", tmp_path / "said.wav")

    assert 0.5 < Sound.read(tmp_path / "said.wav").duration_s < 4


def test_what_one_voice_says_is_heard_or_asked_about(say, tmp_path: Path):
    """What comes back from the own voice is sure only if it is what was said."""
    pytest.importorskip("espeakng_loader", reason='the extra "speech" is not installed')
    language, voice = Language.load(), find_voice("espeak")
    listener = Listener.open((), language)

    for text in ("pass me the knife", "point to the mug", "a spoon is used for lifting"):
        voice.save(text, tmp_path / "said.wav")
        heard = listener.hear(Sound.read(tmp_path / "said.wav"))
        same = language.understand(heard.text).meaning == language.understand(text).meaning
        assert same or heard.heard < 0.9


def test_unknown_voice_is_told():
    """Its name, and those of the plug-ins there are."""
    with pytest.raises(UnknownNameError, match=r'no plug-in of hilt\.voice "nobody"'):
        find_voice("nobody")

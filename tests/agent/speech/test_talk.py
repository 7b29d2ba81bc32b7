"""A conversation by voice: sounds in, answers out, and a "stop" at any time."""

from __future__ import annotations

import json
import time
from io import StringIO
from pathlib import Path
from threading import Event

import numpy as np
from rich.console import Console

from hilt.agent import Agent
from hilt.agent.chat import Chat, run
from hilt.agent.speech.listening import Listener
from hilt.agent.speech.sound import RATE, Sound, Transcript
from hilt.agent.speech.talk import Talk
from hilt.sim.robot.interruption import Interruption

from .test_listening import Scripted


class Listed:
    """A voice that keeps what it says."""

    def __init__(self) -> None:
        self.said: list[str] = []

    def say(self, text: str, cancelled: Event) -> None:
        """Keep it, unless it is interrupted."""
        if not cancelled.is_set():
            self.said.append(text)

    def save(self, text: str, path: Path) -> None:
        """Write it as it is."""
        path.write_text(text, encoding="utf-8")


TONE = Sound(np.sin(np.arange(RATE) / 6).astype(np.float32))


class Prompted(Scripted):
    """A recogniser that finds the next of some texts in each sound."""

    def recognise(self, sound: Sound) -> list[Transcript]:
        """The next text, and what else it may be."""
        return self.found.pop(0) if self.found else []


def talk_of(agent: Agent, *texts: list[str], sounds=None, kept_in: Path | None = None) -> Talk:
    """A talk in which two recognisers find these texts, in turn, with these scores."""
    found = [[Transcript(text, 1 / len(each)) for text in each] for each in texts]
    ears = (Prompted("one", list(found)), Prompted("two", list(found)))
    listener = Listener(ears, agent.dialogue.conversation.language)
    heard = sounds if sounds is not None else [TONE] * len(texts)
    return Talk(listener, heard, Listed(), kept_in, Event())


def test_what_is_said_is_answered_by_voice(agent: Agent, tmp_path: Path):
    """It is taught, asked and commanded; other sounds are told in a line and do nothing."""
    (tmp_path / "no.wav").write_text("no sound", encoding="utf-8")
    talk = talk_of(
        agent,
        ["A knife is used for cutting."],
        ["What is a knife used for?"],
        ["Pass me the knife."],
        [],
        sounds=[TONE, tmp_path / "no.wav", TONE, TONE, TONE],
        kept_in=tmp_path / "kept",
    )
    shown = StringIO()

    run(agent, Console(file=shown, width=200), StringIO(), "sam", talk)

    assert "no.wav: expected a sound in WAV format." in shown.getvalue()
    assert "there are no words in it." in shown.getvalue()
    assert len(talk.voice.said) == 3
    assert "cutting" in talk.voice.said[1]
    assert len(agent.base.rules()) == 1
    kept = json.loads((tmp_path / "kept" / "1.json").read_text(encoding="utf-8"))
    assert kept["text"] == "A knife is used for cutting."
    assert Sound.read(tmp_path / "kept" / "1.wav").duration_s == 1


def test_sound_is_kept_with_consent_only(agent: Agent, tmp_path: Path, monkeypatch):
    """Without a folder to keep them in, nothing is written."""
    monkeypatch.chdir(tmp_path)

    run(agent, Console(file=StringIO()), StringIO(), "sam", talk_of(agent, ["Thank you."]))

    assert list(tmp_path.iterdir()) == []


def test_words_that_are_learned_are_passed_on(agent: Agent):
    """The listener has the language of the conversation."""
    talk = talk_of(agent, ["A knife is used for cutting."], ["Thank you."])
    agent.hear("a compass is used for pointing")

    run(agent, Console(file=StringIO()), StringIO(), "sam", talk)

    assert talk.listener.language is agent.dialogue.conversation.language


def test_stop_among_the_alternatives_ends_what_is_done(agent: Agent):
    """It need not be the likeliest text, nor sure."""
    shown = StringIO()
    talk = talk_of(agent, ["Pass me the knife."], ["The shop is closed.", "point to it", "stop"])
    chat = Chat(agent, Console(file=shown, width=200), "sam", is_interactive=True, talk=talk)
    agent.goals.watchers.append(lambda _: wait_for(agent.interruption))

    chat.listen(talk)

    assert "Hilt: I stopped." in shown.getvalue()


def wait_for(interruption: Interruption) -> None:
    """Return when somebody has asked to stop."""
    while not interruption.is_stopped:
        time.sleep(0.001)


def test_talking_stops_when_somebody_speaks(agent: Agent):
    """The voice is told so while it speaks."""
    talk, heard = talk_of(agent), list[bool]()

    def say(_: str, cancelled: Event) -> None:
        talk.is_interrupted.set()  # as the microphone does
        heard.append(cancelled.is_set())

    talk.voice.say = say

    talk.say("Here is the knife.")

    assert heard == [True]


def test_spoken_lesson_is_acted_on(agent: Agent, say, tmp_path: Path):
    """The running example by voice alone: what is taught and asked for is understood."""
    texts = (
        "A knife is used for cutting",
        "To pass a knife, grab it by the blade",
        "pass me something used for cutting",
    )
    files = [say(text, tmp_path / f"{n}.wav") for n, text in enumerate(texts)]
    listener = Listener.open((), agent.dialogue.conversation.language)
    voice = Listed()

    run(
        agent,
        Console(file=StringIO()),
        StringIO(),
        "sam",
        Talk(listener, files, voice, None, Event()),
    )

    assert voice.said[-1] == "I would pass the knife by the blade."

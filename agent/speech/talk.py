"""A talk: utterances that are heard one after the other, and answers that are spoken."""

import json
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from threading import Event

from ...nlu.language import Language
from ...nlu.semantics.discourse import Discourse
from ...ontology.errors import HiltError
from ..protocols import Voice
from .listening import Heard, Listener
from .sound import RATE, Sound, microphone, write_wav
from .voices import find_voice, spoken_form


@dataclass
class Talk:
    """A talk."""

    listener: Listener
    sounds: Iterable[Sound | Path]  #: what is listened to: sounds, or files of them
    voice: Voice | None
    #: the folder where sounds are kept, each with what was heard; None to keep none
    kept_in: Path | None
    is_interrupted: Event  #: set when a person begins to speak, which ends what is being said

    @property
    def is_live(self) -> bool:
        """Whether somebody speaks now, who may say "stop" while a command is carried out."""
        return not isinstance(self.sounds, Sequence)

    def heard(
        self, state: Callable[[], tuple[Language, Discourse]], report: Callable[[str], object]
    ) -> Iterator[Heard]:
        """Yield what is heard, at the state of the conversation; other sounds are reported."""
        for each in self.sounds:
            try:
                sound = each if isinstance(each, Sound) else Sound.read(each)
                language, discourse = state()
                self.listener = self.listener.learned(language)
                heard = self.listener.hear(sound, discourse)
                if self.kept_in:
                    keep(sound, heard, self.kept_in)
            except HiltError as error:
                report(str(error))
                continue
            if heard.text:
                yield heard
            else:
                report(f"{sound.source}: there are no words in it.")

    def say(self, answer: str) -> None:
        """Speak the short form of an answer, until it is interrupted."""
        if self.voice:
            self.is_interrupted.clear()
            self.voice.say(spoken_form(answer), self.is_interrupted)


def keep(sound: Sound, heard: Heard, folder: Path) -> None:
    """Write a sound as the next `N.wav` of a folder, and what was heard as `N.json`."""
    path = next(file for n in count(1) if not (file := folder / f"{n}.wav").exists())
    write_wav(path, RATE, sound.pcm)
    path.with_suffix(".json").write_text(json.dumps(heard.as_json()), encoding="utf-8")


@contextmanager
def open_talk(
    files: Sequence[Path],
    recognisers: Sequence[str],
    language: Language,
    *,
    voice: str = "",
    kept_in: Path | None = None,
) -> Generator[Talk]:
    """A talk of sounds in files, or without any of the microphone; errors as of its parts."""
    is_interrupted, speaker = Event(), find_voice(voice) if voice else None
    if speaker:
        speaker.say("", is_interrupted)  # whether there is a loudspeaker
    listener = Listener.open(recognisers, language)
    with nullcontext(files) if files else microphone(is_interrupted.set) as sounds:
        yield Talk(listener, sounds, speaker, kept_in, is_interrupted)

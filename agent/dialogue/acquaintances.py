"""Acquaintances: who the speakers of a conversation say they are.

"I'm Anna" makes Anna the speaker if she is known. A name that nobody knows changes no trust: what
is said then counts as the word of the speaker who was heard before. Nobody who is not trusted
becomes somebody who is by saying so: others have to vouch for them.
"""

from ...kb.history import IMPORT
from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Rule
from ..execution.outcome import AnswerContent


class Acquaintances:
    """Who speaks, by the name under which they are heard."""

    def __init__(self, base: KnowledgeBase) -> None:
        self._base = base
        self._speakers: dict[str, str] = {}
        self._called: dict[str, str] = {}

    def speaker(self, heard: str) -> str:
        """Return the known person who is heard under a name."""
        return self._speakers.get(heard, heard)

    def leave(self, heard: str) -> None:
        """Forget who was introduced under a name: its bearer speaks again."""
        self._speakers.pop(heard, None)

    def called(self, speaker: str) -> str:
        """Return the name that a speaker goes by."""
        return self._called.get(speaker, speaker)

    def trusts(self, speaker: str) -> bool:
        """Return whether what a speaker says counts at all."""
        trust = self._base.trust(speaker)
        return trust is not None and trust.upper > 0

    def trust_in(self, speaker: str) -> float:
        """Return the lower bound of the trust in a speaker, 0 where nobody has set it."""
        return trust.lower if (trust := self._base.trust(speaker)) else 0.0

    def reporter_of(self, rule: Rule) -> str:
        """Return who told Hilt a rule: its speaker, or who reported what its speaker said."""
        if rule.utterance is None:
            return rule.speaker
        said = self._base.utterance(rule.utterance)
        return rule.speaker if said.kind == IMPORT else said.speaker

    def may_end(self, speaker: str, rule: Rule) -> bool:
        """Return whether a speaker said or reported a rule, or of a norm is trusted more."""
        is_trusted_more = self.trust_in(speaker) > self.trust_in(rule.speaker)
        is_own = speaker in {rule.speaker, self.reporter_of(rule)}
        return is_own or (rule.kind == "norm" and is_trusted_more)

    @property
    def owner(self) -> str | None:
        """Who was heard first of those who are trusted; None before anybody was."""
        return next(filter(self.trusts, (said.speaker for said in self._base.history())), None)

    def may_vouch(self, speaker: str, person: str) -> bool:
        """Return whether a speaker may say how far to trust a person.

        The owner may for everybody else. Others who are trusted may not for the owner, nor for
        somebody who is trusted more than they are.
        """
        if not self.trusts(speaker) or speaker == person:
            return False
        is_below, owner = self.trust_in(person) <= self.trust_in(speaker), self.owner
        return speaker == owner or (is_below and person != owner)

    def meet(self, speaker: str, name: str) -> AnswerContent:
        """Note the name by which a speaker is introduced, and return the greeting."""
        person = self._base.match_speaker(name)
        is_known = person in self._base.trust_by_speaker()
        if is_known and (self.trusts(speaker) or not self.trusts(person)):
            heard = [each for each, known in self._speakers.items() if known == speaker]
            self._speakers |= dict.fromkeys(heard or [speaker], person)
            self._called.pop(person, None)
            return AnswerContent("hello", {"speaker": person})
        if not self.trusts(speaker):
            return AnswerContent("hello_stranger", {"speaker": person})
        self._called[speaker] = person
        return AnswerContent("hello_guest", {"speaker": person, "host": speaker})

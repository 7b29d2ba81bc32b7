"""Courtesies: what in an utterance that is not understood only greets, thanks or praises.

"Good morning, I'm your first pupil" is a greeting although nobody taught the word *pupil*. A part
between pauses is a courtesy or chatter only where it names nothing that a rule or a command is
about, denies nothing and asks nothing. Whom to trust is found here, too.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise, takewhile

from ..grammar.word_patterns import Phrase, WordLists
from ..lexicon.tokenizer import Token, Tokens
from ..lexicon.unknown_words import KnownWords
from ..semantics.clause_features import FeatureReader
from ..semantics.discourse import Discourse
from ..semantics.interpretation import GOALS
from ..semantics.meaning import TrustStatement
from .mentions import find_mentions

_JUDGING = frozenset({"praise", "blame"})
_VALUED = _JUDGING | {"thanks"}
_LONGEST_ADDRESS = 3  # words of "my little helper"
_LONGEST_COMPLEMENT = 6  # words of "for all your help this morning"
_FORMAL = frozenset({"greeting", "thanks", "farewell"})
_PEOPLE = ("RN", "HN")
_HERE = frozenset({"addressee", "generic"})  # the agents of what Hilt may be to do
_OTHERS = frozenset({"other"})
_OVER = frozenset({"past", "perfect"})

_REPLIES = {"thanks": "welcome", "praise": "praised", "apology": "no_problem", "blame": "regrets"}
"""The answers to acknowledgements that are not called like them."""


def answer_to(acknowledgement: str) -> str:
    """Return the key of the answer to an acknowledgement of this kind."""
    return _REPLIES.get(acknowledgement, acknowledgement)


@dataclass(frozen=True)
class Courtesy:
    """What is said by the way in an utterance, and what else it says."""

    #: `farewell`, `greeting`, `thanks`, `apology`, `blame` or `praise`; empty for chatter
    kind: str
    #: the text of all else, from the first to the last part of it; empty when there is none
    rest: str
    is_formal: bool  #: whether only greetings, thanks and goodbyes are said by the way
    name: str = ""  #: how its speaker introduces himself or herself, empty when nobody does


@dataclass(frozen=True)
class CourtesyPhrases:
    """The phrases by which courtesies are found (`courtesies.yaml`), and the words that are known.

    Of several courtesies in an utterance that counts whose phrases come first.
    """

    words: WordLists
    known: KnownWords
    features: FeatureReader

    def find(self, tokens: Tokens) -> Courtesy | None:
        """Return the courtesy in an utterance; None where there is none."""
        found: set[str] = set()
        kept: list[tuple[int, int]] = []
        name, introduced = "", (0, 0)
        for start, end in tokens.parts:
            part = tokens.part(start, end)
            has_content = part.asks or self.has_content(part)
            kind = None if has_content else self._kind(part)
            if not has_content and not name and (name := self._introduced(part)):
                kind, introduced = "greeting", (start, end)
            elif not has_content and start == introduced[1] > 0:  # "I'm Kim, your new neighbour"
                kind, introduced = "greeting", (introduced[0], end)
            if kind is None:
                kept.append((start, end))
            else:
                found.add(kind)
        addressed = tokens.items[1 : kept[0][0]] if kept and not name else ()
        others = (each for each in addressed if not self.words.has("chatter", each.word))
        if not found or any(map(self.is_person, others)):
            return None
        kind = next((each for each in self.words.names("courtesies") if each in found), "")
        text, starts = tokens.text, [*(each.start for each in tokens.items), len(tokens.text)]
        rest = text[starts[kept[0][0]] : starts[kept[-1][1]]].strip(" ,:-–—") if kept else ""
        is_within = kept and kept[0][0] < introduced[0] < kept[-1][0]
        return Courtesy(kind, rest, found <= _FORMAL, "" if is_within else name)

    def is_by_the_way(self, tokens: Tokens, is_nothing: Callable[[Tokens], bool]) -> bool:
        """Whether an utterance reports something, is of the past, or names nothing to learn or do.

        It asks nothing, and is not understood; `is_nothing` says whether it hardly means anything.
        """
        words, lists = tokens.words, self.words
        features, listed = self.features, self.features.words
        if tokens.asks or len(words) < 2:
            return False
        is_asked = words[0] in listed["interrogative"] and words[1] in listed["asking"]
        unknown = tuple(self.known.unknown(tokens))
        is_new = tokens.items[0] in unknown and words[1] in listed["determiners"]
        if is_asked or is_new or 2 * len(unknown) > len(words):  # "glorb the cup", "glorb snarf"
            return False
        said = features.of_words(words)
        first = features.of_words(tokens.part(*tokens.parts[0]).words).get("agent", frozenset())
        is_others = first == _OTHERS or (words[0] in listed["owners"] and _HERE.isdisjoint(first))
        if is_others or "source" in said or not _OVER.isdisjoint(said.get("tense", ())):
            return True
        teaching, parts = lists.words("teaching"), [tokens.part(*span) for span in tokens.parts]
        uses = (other for one, other in pairwise(words) if one in teaching)  # "for cutting"
        is_taught = any(each.endswith("ing") for each in (*(p.words[0] for p in parts), *uses))
        is_urged = any(lists.end("urging", words, place) > place for place in range(len(words)))
        if is_taught or is_urged or any(map(self.has_content, parts)):
            return False
        is_chatter = teaching.isdisjoint(words) or any(lists.end("chatter", p.words) for p in parts)
        return is_chatter or is_nothing(tokens)

    def introduction(self, tokens: Tokens) -> Courtesy | None:
        """Return the courtesy in which a speaker introduces himself or herself, None without."""
        capital = any(token.capital for token in tokens.items[2:])
        if not (capital and any(self._introduced(tokens.part(*span)) for span in tokens.parts)):
            return None
        found = self.find(tokens)
        return found if found and found.name else None

    def trust(self, tokens: Tokens, start: int) -> TrustStatement | None:
        """Return whom an utterance says to trust, or not to, from a place on; None for nobody."""
        found = () if tokens.asks else self.words.wholes("trust", tokens.words, start)
        for kind, slots in found:
            links, people = self.words.words("linking"), list[list[Token]]([[]])
            for place in range(*slots["NAME"]):
                token = tokens.items[place]
                if place in tokens.pauses or token.word in links:
                    people.append([])
                if token.word not in links:
                    people[-1].append(token)
            people = [name for name in people if name]
            if people and all(self.is_person(token) for name in people for token in name):
                names = (tokens.text[name[0].start : name[-1].end] for name in people)
                return TrustStatement(tuple(names), kind == "distrusted")
        return None

    def _introduced(self, part: Tokens) -> str:
        words = part.words
        for start in range(min(len(words), _LONGEST_ADDRESS)):
            first = self.words.end("introducing", words, start)
            name = [*takewhile(self.is_person, part.items[first:])]
            if first > start and name and self._ends_with(words, first + len(name)):
                return " ".join(token.word for token in name)
        return ""

    def _ends_with(self, words: Phrase, start: int) -> bool:
        verbs = self.words.words("stating") | self.words.words("verbs")
        return len(words) - start <= _LONGEST_COMPLEMENT and verbs.isdisjoint(words[start:])

    def _kind(self, part: Tokens) -> str | None:
        words, lists = part.words, self.words
        is_denied = not lists.words("denying").isdisjoint(words)
        is_stated = not lists.words("stating").isdisjoint(words)
        is_of_hilt = lists.end("openers", words) > 0
        for kind in lists.names("courtesies"):
            is_bare = kind in _JUDGING and not is_of_hilt
            places = range(1 if is_bare else len(words))
            if (is_bare and is_stated) or not any(self._is_all(kind, words, at) for at in places):
                continue
            return None if is_denied and kind in _VALUED else kind
        unknown = self.known.unknown(part)
        is_limiting = lists.has("limiting", words[0])
        is_address = len(words) <= _LONGEST_ADDRESS and unknown and not is_limiting
        uses = {two for one, two in pairwise(("", *words)) if one not in {"am", "are"}}  # new ones
        is_denied |= any(token.word.endswith("ing") and token.word in uses for token in unknown)
        return "" if not is_denied and (is_address or lists.end("chatter", words) > 0) else None

    def _is_all(self, kind: str, words: Phrase, start: int) -> bool:
        found = self.words.of_group("courtesies", words, start)
        ends = [end for name, end, _ in found if name == kind]
        is_led = self.words.words("before").issuperset(words[:start]) or (
            kind in _JUDGING and self.words.end("openers", words) > 0
        )
        return bool(ends) and is_led and self._ends_with(words, max(ends))

    def has_content(self, part: Tokens) -> bool:
        """Whether a part names something that a rule or a command is about."""
        found = find_mentions(part, self.known, {}, Discourse())
        is_act = any(each.role == "act" and each.name in GOALS for each in found.names)
        is_on_it = not self.words.words("pronouns").isdisjoint(part.words)
        is_act |= any(self.words.end("wishing", part.words, n) > n for n in range(len(part.words)))
        return bool(found.required) or (is_act and is_on_it)

    def is_person(self, token: Token) -> bool:
        """Whether a token may be somebody's name."""
        is_known = self.known.lexicon.is_name(token.word, _PEOPLE)
        return token.capital and (is_known or not self.known.has(token.word))

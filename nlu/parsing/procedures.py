"""Procedures: several steps in order, as a plan or as an action that is taught.

"To serve a mug, first pick it up, then put it down" has a head, the action that is taught, and a
body of clauses. A clause ends at a pause, a full stop or a word of order, and is a command to the
grammar; so are the steps of "pick up the mug and point to it", which has no head. A clause may
also say what must be so before ("only if it is empty"), or what to do after a failure ("if it
slips, try again"). A clause can refer to what the clauses before it mentioned.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain, pairwise, product

from ..grammar.word_patterns import WordLists
from ..lexicon.discourse_markers import ControlPhrases
from ..lexicon.misspelling import slips
from ..lexicon.tokenizer import BREAK, Token, Tokens
from ..lexicon.unknown_words import NOUNS, KnownWords, is_word
from ..lexicon.vocabulary import NewWord
from ..semantics import meaning as meanings
from ..semantics.coreference import noun_of
from ..semantics.discourse import Discourse
from ..semantics.interpretation import GOALS, kind_and_properties
from ..semantics.meaning import Act, ActionCondition, Command, FailureReaction, ObjectReference
from ..semantics.predicates import PredicateForm, UninterpretableError
from .parser import SentenceParser
from .understanding import Understanding, UtteranceContext

MAX_CLAUSE_WORDS = 20

_EMPTYING = ("putDown", "putBack", "release")  # controls that are steps, too
_TAKING = ("pickUp", "grasp", "use")
_USING = ("grasp", "use")  # "take the knife, cut the bread with it" is one command
_TIMES = {"twice": 2, "two": 2, "three": 3, "four": 4, "five": 5}
_ACTS = ("CP", "(CP", "((CP", "C/", "B/", "(B", "UV", "CG", "K")  # how those of acts begin
_ANYTHING = "anythingNamed"  # the object of an action that is taught for any
_TOOL = "tool"  # the kind of whatever has a use
_OPENING = ("order", "only_if", "unless", "if")  # what a clause begins with
_NOBODY = UtteranceContext("speaker", "self", Discourse())

Clause = Act | ActionCondition | FailureReaction
Sentence = Callable[[Tokens, UtteranceContext], Understanding]


@dataclass(frozen=True)
class ClauseState:
    """The discourse state after a clause, and what is in the hand then."""

    discourse: Discourse
    held: ObjectReference | None = None


@dataclass(frozen=True)
class ActionHead:
    """The action that a procedure teaches."""

    name: str  # its verb, with its particle
    things: tuple[ObjectReference, ...]  # the objects that it is about
    links: tuple[str, ...]  # the words between the objects
    new_words: tuple[NewWord, ...]  # the verb, and the objects that were not known

    @property
    def parameters(self) -> tuple[str, ...]:
        """The kinds of the objects."""
        return tuple(each.object or meanings.ANY_OBJECT for each in self.things)

    @property
    def discourse(self) -> Discourse:
        """The discourse state of the body: "it" is the object of the action."""
        kinds = (_ANYTHING if kind == meanings.ANY_OBJECT else kind for kind in self.parameters)
        named = [PredicateForm.named(kind) for kind in kinds]
        return Discourse().naming(*named) if named else Discourse()


@dataclass(frozen=True, repr=False)
class ProcedureReader:
    """Finds the procedure that an utterance is; the `frames` are those of `Language`."""

    words: WordLists
    parser: SentenceParser
    known: KnownWords
    controls: ControlPhrases
    frames: Mapping[str, tuple[str, ...]]

    def definition(
        self, tokens: Tokens, context: UtteranceContext, sentence: Sentence
    ) -> Understanding | None:
        """Return the action that an utterance teaches, or None; `sentence` understands a clause."""
        for head, body in () if tokens.asks else self._heads(tokens):
            clauses = _Clauses(self, context, sentence)
            meaning = self._definition(head, body, clauses)
            if meaning:
                new = chain(head.new_words, clauses.new_words(meaning.steps))
                words = {(word.role, word.word): word for word in new}
                whole = Understanding.of(tokens, context, meaning)
                return replace(whole, new_words=tuple(words.values()), discourse=head.discourse)
        return None

    def plan(
        self, tokens: Tokens, context: UtteranceContext, sentence: Sentence
    ) -> Understanding | None:
        """Return the plan, or the command of a taught action, that an utterance is; else None."""
        if "?" in tokens.text.rstrip("?!. "):
            return None  # "so you need to pass a knife? hold the blade"
        state = ClauseState(context.discourse)
        clauses = _Clauses(self, context, sentence)
        bare = tokens.part(self.controls.after_polite(tokens.words), len(tokens.items))
        found = clauses.read(replace(bare, asks=False), state) or []
        steps = tuple(each for each, _ in found if isinstance(each, Act))
        is_said_again = any(_is_of_same(one, other) for one, other in pairwise(steps))
        new = clauses.new_words(steps)
        unknown = [each.goal for each in steps if not self.is_act(each.goal)]
        if is_said_again or len(steps) < len(found) or any(word.role != "object" for word in new):
            return None
        if len(steps) == 1 and isinstance(steps[0], meanings.ActionCommand):
            return Understanding.of(tokens, context, steps[0])
        if len(steps) == len(unknown) == 1 and isinstance(steps[0], Command):
            act = meanings.ActionCommand(unknown[0], (steps[0].target,))
            asked = Understanding.of(tokens, context, meanings.AskBack(choices=(act,)))
            return asked if self._is_new(act.goal) else None
        is_odd = len(unknown) == len(steps) or any(map(self._is_known_verb, unknown))
        whole = Understanding.of(tokens, context, meanings.Plan(steps))
        is_plan = len(steps) > 1 and not is_odd
        return replace(whole, discourse=found[-1][1].discourse) if is_plan else None

    def _is_new(self, verb: str, thing: str | None = None) -> bool:
        names = self.known.lexicon.name_categories
        is_other = self.known.has(verb) or any(map(self._is_other, slips(verb)))
        is_told = (thing is None or names(thing)) and NOUNS.isdisjoint(names(verb))
        return bool(is_told and not is_other)

    def _definition(
        self, head: ActionHead, body: Tokens, clauses: "_Clauses"
    ) -> meanings.ActionDefinition | None:
        found = [each for each, _ in clauses.read(body, ClauseState(head.discourse)) or ()]
        steps = tuple(each for each in found if isinstance(each, Act))
        only = steps[0] if len(steps) == 1 and head.parameters else None
        is_of_other = isinstance(only, Command) and only.target.object not in head.parameters
        if is_of_other or not any(self.is_act(each.goal) for each in steps):
            return None
        things = zip(head.parameters, head.things, strict=True)
        wanted = [ActionCondition("is", kind, prop) for kind, each in things for prop in each.props]
        wanted += [each for each in found if isinstance(each, ActionCondition)]
        reactions = tuple(each for each in found if isinstance(each, FailureReaction))
        links = head.links if {*head.links} - {"and"} else ()
        return meanings.ActionDefinition(
            head.name, head.parameters, steps, tuple(wanted), reactions, links
        )

    def about(self, tokens: Tokens, context: UtteranceContext) -> Understanding | None:
        """Return the question about a learned action, or its retraction, that an utterance is."""
        for key in ("how", "able", "forget"):
            for name, things in ((head.name, head.things) for _, head in self._named(key, tokens)):
                is_learned = self._is_learned(name)
                thing = None if is_learned or not things else things[0].object
                asked = meanings.Question("how", thing, context=name)
                meant = meanings.Retraction(action=name) if key == "forget" else asked
                is_new = self._is_new(name, thing)
                if (is_learned and key != "able") or (key != "forget" and is_new):
                    return Understanding.of(tokens, context, meant)
        return None

    def _heads(self, tokens: Tokens) -> Iterator[tuple[ActionHead, Tokens]]:
        for key in ("heads", "asked"):
            for end, head in self._named(key, tokens, is_whole=False):
                is_new = key == "heads" or not self._is_known_verb(head.name)
                # In "to introduce a mug to Anna" the objects belong to the head.
                is_cut = self.known.builder.is_determiner(tokens.words[end])
                if is_new and (end in tokens.edges or not is_cut):
                    yield head, tokens.part(end, len(tokens.items))
        for start in _starts(self.words, tokens)[:-1]:
            for _, head in self._named("tails", tokens, start + (tokens.words[start] == BREAK)):
                yield head, tokens.part(0, start)

    def _named(
        self, key: str, tokens: Tokens, start: int = 0, *, is_whole: bool = True
    ) -> Iterator[tuple[int, ActionHead]]:
        for _, end, slots in self.words.of_group(key, tokens.words, start):
            for slot, place in slots.items() if (end == len(tokens.items)) == is_whole else ():
                head = self._head(tokens.part(*place), is_gerund=slot == "HEADING")
                if head:
                    yield end, head

    def _is_known_verb(self, name: str) -> bool:
        return not self._is_learned(name) and self.known.has(name.partition(" ")[0])

    def _is_learned(self, name: str) -> bool:
        return ("context", name) in self.known.lexicon.learned

    def _head(self, tokens: Tokens, *, is_gerund: bool) -> ActionHead | None:
        bare = self.bare(tokens) if is_gerund else tokens
        if bare is None or bare.pauses or not is_word(bare.words[0]):
            return None
        for length in (2, 1):
            name = " ".join(bare.words[:length])
            has_particle = self.words.has("particles", *bare.words[1:2])
            if (length == 2 and not has_particle) or self._is_other(name):
                continue
            found = self.things(bare.part(length, len(bare.items)), may_be_new=True)
            if found:
                things, links, words = found
                new = NewWord(name, "context", bare.span(0, length))
                return ActionHead(name, things, links, (new, *words))
        return None

    def is_act(self, name: str) -> bool:
        """Whether an act of this name is one that Hilt knows, taught or not."""
        own = self.parser.interpreter
        return any(name in known for known in (GOALS, own.acts, own.tool_acts, self.frames))

    def _is_other(self, name: str) -> bool:
        if self._is_learned(name):
            return False
        kinds = self.known.lexicon.name_categories(name)
        return name in self.known.builder.closed or any(each.startswith(_ACTS) for each in kinds)

    def bare(self, tokens: Tokens) -> Tokens | None:
        """Return some words with the gerund that they begin with as a bare verb; else None."""
        first, *rest = tokens.items
        if not self.known.origins(first.word, "ing"):
            return None
        word = self.known.builder.bare_verb(first.word)
        return replace(tokens, items=(Token(word, first.start, first.end), *rest))

    def things(
        self, tokens: Tokens, *, may_be_new: bool = False
    ) -> tuple[tuple[ObjectReference, ...], tuple[str, ...], tuple[NewWord, ...]] | None:
        """Return the objects that some words list, the words between them, and the new words."""
        if not tokens.items:
            return (), (), ()
        first = self._thing(tokens, may_be_new=may_be_new)
        if first:
            return (first[0],), (), first[1]
        count = len(tokens.items)
        for start, length in product(range(1, count - 1), (3, 2, 1)):
            end = start + length
            if end >= count or not self.words.has("links", *tokens.words[start:end]):
                continue
            one = self._thing(tokens.part(0, start), may_be_new=may_be_new)
            others = one and self.things(tokens.part(end, count), may_be_new=may_be_new)
            if one and others and others[0]:
                link = " ".join(tokens.words[start:end])
                return (one[0], *others[0]), (link, *others[1]), (*one[1], *others[2])
        return None

    def _thing(
        self, tokens: Tokens, *, may_be_new: bool
    ) -> tuple[ObjectReference, tuple[NewWord, ...]] | None:
        found = self.parser.topic(self.parser.chart(tokens, {}), _NOBODY)
        if found is not None:
            try:
                kind, props = kind_and_properties(found[0])
                return ObjectReference(kind, props=props), ()
            except UninterpretableError:
                return None
        builder, (first, *names) = self.known.builder, tokens.words or (BREAK,)
        is_named = may_be_new and builder.is_determiner(first) and 0 < len(names) < 3
        if not is_named or any(map(builder.is_of_grammar, names)):
            return None
        last = next(iter(self.known.origins(names[-1], "plural")), names[-1])
        name = " ".join((*names[:-1], last))
        return ObjectReference(name), (NewWord(name, "object", " ".join(names)),)


class _Clauses:
    """The clauses of one utterance; what is tried again is read once."""

    def __init__(self, reader: ProcedureReader, context: UtteranceContext, parse: Sentence) -> None:
        self._reader, self._words = reader, reader.words
        self._context, self._sentence = context, parse
        self.read = cache(self._read)
        self._new_words: dict[Act, tuple[NewWord, ...]] = {}

    def new_words(self, steps: Sequence[Act]) -> Iterator[NewWord]:
        return chain.from_iterable(self._new_words.get(each, ()) for each in steps)

    def _read(self, tokens: Tokens, state: ClauseState) -> list[tuple[Clause, ClauseState]] | None:
        start, count = 0, len(tokens.items)
        while start < count:
            end = self._words.end("order", tokens.words, start)
            if end == start and tokens.words[start] != BREAK:
                break
            start = max(end, start + 1)
        if start == count:
            return [] if all(word == BREAK for word in tokens.words) else None
        for end in _starts(self._words, tokens):
            # "And the knife" is a clause only with the word before it.
            for begin in dict.fromkeys((start, 0)) if end > start else ():
                found = self._clause(tokens.part(begin, end), state)
                rest = self.read(tokens.part(end, count), found[1]) if found else None
                if found and rest is not None:
                    return [found, *rest]
        return None

    def _clause(self, tokens: Tokens, state: ClauseState) -> tuple[Clause, ClauseState] | None:
        count = len(tokens.items)
        if not 0 < count <= MAX_CLAUSE_WORDS or self._words.end("corrected", tokens.words):
            return None
        aside = self._condition(tokens, state) or self._reaction(tokens, state)
        if aside:
            return aside, state
        is_all = self._words.is_all  # also without words of order: "pick it up first"
        ended = (tokens.part(0, n) for n in range(1, count) if is_all("behind", tokens.words, n))
        variants = [(each, self._reader.bare(each)) for each in (tokens, *ended)]
        for each, bare in variants:
            found = self._act(each, state) or (self._act(bare, state) if bare else None)
            if found:
                return found
        unknown = (self._unknown_act(bare or each, state) for each, bare in variants)
        return next(((found, state) for found in unknown if found), None)

    def _act(self, tokens: Tokens, state: ClauseState) -> tuple[Act, ClauseState] | None:
        control = self._control_of(tokens)
        if control:
            pieces = (tokens.part(*span) for span in pairwise(sorted(tokens.edges)))
            is_one = sum(map(bool, map(self._control_of, pieces))) < 2  # not "wait, put it down"
            return self._control(*control, state) if is_one else None
        taught = self._taught(tokens)
        if taught:
            return taught, state
        found = self._sentence(tokens, replace(self._context, discourse=state.discourse))
        act = found.meaning
        # An action with a frame is done with several objects, or with none.
        frames = self._reader.frames
        if not isinstance(act, meanings.SimpleCommand) or act.negated or act.goal in frames:
            return None
        if isinstance(act, Command) and act.target.object == _ANYTHING:
            act = replace(act, target=replace(act.target, object=meanings.ANY_OBJECT))
        if found.reading:
            self._new_words[act] = found.reading.new_words
        held = state.held
        if isinstance(act, meanings.ToolCommand) or act.goal in _TAKING:
            held = act.tool if isinstance(act, meanings.ToolCommand) else act.target
        return act, ClauseState(found.discourse, held)

    def _control_of(self, tokens: Tokens) -> tuple[str, str | None] | None:
        return self._reader.controls.match(tokens, self._reader.parser.named_object)

    def _control(
        self, control: str, name: str | None, state: ClauseState
    ) -> tuple[Act, ClauseState] | None:
        if control not in _EMPTYING or not (name or state.held or state.discourse.object):
            return None
        target = ObjectReference(name) if name else state.held or self._last(state)
        discourse = state.discourse.about(name) if name else state.discourse
        return Command(control, target), ClauseState(discourse)

    def _last(self, state: ClauseState) -> ObjectReference:
        last = state.discourse.object or PredicateForm("something")
        kind, props = kind_and_properties(noun_of(last) if last.name.endswith("For") else last)
        return ObjectReference(meanings.ANY_OBJECT if kind == _ANYTHING else kind, props=props)

    def _taught(self, tokens: Tokens) -> meanings.ActionCommand | None:
        polite = self._reader.controls.after_polite
        tokens = tokens.part(polite(tokens.words), len(tokens.items))
        count = len(tokens.items)
        ends = (end for end in range(1, count) if polite(tokens.words[end:]) == count - end)
        tokens = tokens.part(0, next(ends, count))
        for name, links in self._reader.frames.items():
            length = name.count(" ") + 1
            if tokens.words[:length] != tuple(name.split()):
                continue
            found = self._reader.things(tokens.part(length, len(tokens.items)))
            if found and found[1] == links and len(found[0]) != 1:
                return meanings.ActionCommand(name, found[0])
        return None

    def _unknown_act(self, tokens: Tokens, state: ClauseState) -> Act | None:
        reader, (verb, *rest) = self._reader, tokens.words
        is_other = reader.is_act(verb) or reader.known.builder.is_of_grammar(verb)
        if not rest or is_other or not is_word(verb):
            return None
        if reader.controls.is_pronoun((*rest,)):
            return Command(verb, self._last(state)) if state.discourse.object else None
        found = reader.things(tokens.part(1, len(tokens.items)))
        is_one = found and len(found[0]) == 1 and reader.known.builder.is_determiner(rest[0])
        return Command(verb, found[0][0]) if found and is_one else None

    def _named(self, tokens: Tokens, state: ClauseState) -> str | None:
        if self._reader.controls.is_pronoun(tokens.words):
            return self._last(state).object if state.discourse.object else None
        return self._reader.parser.named_object(tokens)

    def _condition(self, tokens: Tokens, state: ClauseState) -> ActionCondition | None:
        for key in ("only_if", "unless"):
            for _, slots in self._words.wholes(key, tokens.words):
                said = tokens.part(*slots["STATE"])
                for name, places in self._words.wholes("states", said.words):
                    thing = self._named(said.part(*places["THING"]), state)
                    word = said.words[places["WORD"][0]] if "WORD" in places else None
                    if thing:
                        negated = (key == "unless") != (name == "not")
                        kind = "is" if name == "not" else name
                        return ActionCondition(kind, thing, word, negated)
        return None

    def _reaction(self, tokens: Tokens, state: ClauseState) -> FailureReaction | None:
        count = len(tokens.items)
        for start in range(count):
            found = self._words.of_group("if", tokens.words, start)
            failures = ((end, tokens.part(*slots["FAILURE"])) for _, end, slots in found)
            ends = ((end, self._causes(failure, state)) for end, failure in failures)
            # The longest one: "if you can't reach it" and not "if you can't".
            end, causes = max((each for each in ends if each[1]), default=(start, ()))
            # "Put it down. Stop if it fails": the condition is one of the last sentence.
            if causes and (end == count) == (start > 0) and BREAK not in tokens.words[:start]:
                rest = tokens.part(0, start) if start else tokens.part(end, count)
                return self._response(rest, causes, state)
        return None

    def _causes(self, tokens: Tokens, state: ClauseState) -> tuple[str, ...]:
        for names, places in self._words.wholes("failures", tokens.words):
            thing = places.get("THING")
            if thing is None or self._named(tokens.part(*thing), state):
                return tuple(names.split())
        return ()

    def _response(
        self, tokens: Tokens, causes: tuple[str, ...], state: ClauseState
    ) -> FailureReaction | None:
        count = len(tokens.items)
        for _, end, _ in self._words.of_group("again", tokens.words):
            if end == count or self._words.is_all("times", tokens.words, end):
                number = next((_TIMES[word] for word in tokens.words[end:] if word in _TIMES), 1)
                return FailureReaction(causes, again=number)
        if self._words.is_all("another", tokens.words):
            return FailureReaction(causes, other=True)
        if self._words.is_all("stopping", tokens.words):
            return FailureReaction(causes, stop=True)
        bare = replace(tokens, items=tokens.items[: count - (tokens.words[-1] == "instead")])
        found = self.read(bare, state)
        steps = tuple(each for each, _ in found or () if isinstance(each, Act))
        return FailureReaction(causes, steps=steps) if len(steps) == len(found or "-") else None


def _starts(words: WordLists, tokens: Tokens) -> list[int]:
    count = len(tokens.items)
    breaks = {place for place in tokens.edges if tokens.words[place - 1 : place] != (BREAK,)}
    opening = {
        place
        for place in range(1, count)
        for key in _OPENING
        if words.end(key, tokens.words, place) > place
    }
    return sorted((breaks | opening | {count}) - {0})


def _is_of_same(one: Act, other: Act) -> bool:
    # "Hold the mug, by the barrel" says more of one command.
    if isinstance(one, Command) and isinstance(other, meanings.ToolCommand) and one.goal in _USING:
        return other.tool.object == one.target.object
    if isinstance(one, Command) and isinstance(other, Command):
        first, second = one.target, other.target
        about = [(each.object, each.used_for, each.not_used_for) for each in (first, second)]
        is_described = bool(first.used_for) and second.object == _TOOL
        return one.goal == other.goal and (is_described or about[0] == about[1])
    return one.goal == other.goal and not isinstance(one, meanings.ActionCommand)

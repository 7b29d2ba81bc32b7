"""Which spellings of the English word files the utterances of the repository use, and how often.

The count is over the derivations of all utterances that come out right: those of the test data,
sentences that Hilt generates, and those of documents and tests, each of which counts twice. It
prints for each file how many spellings there are, how many nothing uses, and how many one use.

With `--write` it deletes what is used less than `--least` times: spellings with their lines of
`is`, and choices within a spelling. A spelling that is used very often keeps all its choices: it is
a word class, of which nobody uses all members. Words without choices of at most two words are kept,
too: they are closed class. Run it as

    python benchmarks/lexicon_usage.py [--least SPELLING CHOICE WHOLE] [--unused] [--write]
"""

from __future__ import annotations

import argparse
import itertools
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias
from unittest.mock import patch

import yaml
from rich.progress import track
from utterances import NEAR, Utterance, data_sets, dialogues, documented, generated

from hilt.nlu import Language, Reading, Session
from hilt.nlu import language as loader
from hilt.nlu.grammar.grammar import UnaryRule
from hilt.nlu.grammar.word_patterns import variants
from hilt.nlu.language import LANGUAGES_FOLDER
from hilt.nlu.lexicon.discourse_markers import DiscourseMarkers
from hilt.nlu.lexicon.lexicon import Entry
from hilt.nlu.lexicon.loader import LexiconBuilder
from hilt.nlu.parsing import strategies
from hilt.nlu.parsing.chart import subderivations
from hilt.ontology.yaml_reader import YamlNode

LISTS = ("lexicon.yaml", "constructions.yaml", "requests.yaml")
"""The files that may be pruned; what is in all others is structure."""
FILES = (*LISTS, "clauses.yaml", "conversation.yaml")
KEPT = frozenset(
    {
        *NEAR,
        "constructions",
        "kinds",
        "materials",
        "new_words",
        "attitudes",
        "said",
        "paradigm",
        "generated",
        "dialogues",
        "documented",
    }
)
"""What must stay: one use of a spelling in these sets is enough."""

_CLOSED = (
    "is are", "was were", "has have", "does do", "i we", "me us", "my our", "you one people folks",
    "that which", "this these", "it them", "a an", "if when whenever", "can could", "will would",
    "someone somebody", "anyone anybody", "everyone everybody", "nobody no", "he she", "him her",
    "thing tool object", "part end side", "hold grab grasp grip", "may might", "should must",
)  # fmt: skip
_CLASSES = {word: group.split()[0] for group in _CLOSED for word in group.split()}
_UNCOUNTED = frozenset({"request_tags", "doubts", "stand_ins"})
"""Discourse markers that refuse something; what they are needed for is not seen in a count."""
_PIECE = re.compile(r"[()\[\]|]|[^\s()\[\]|]+")

Place: TypeAlias = tuple[int, ...]
"""The way from a spelling to one of its choices: index of the bracket, index of the choice, ..."""
Use: TypeAlias = tuple[str, int, int, Place]
"""A file, the line and column of a spelling, and the choice in it."""


class Bracket(NamedTuple):
    """A bracket of a pattern: its choices, and whether it may be left out."""

    choices: tuple[Pattern, ...]
    optional: bool


Pattern: TypeAlias = "tuple[str | Bracket, ...]"


def parsed(text: str) -> Pattern:
    """The brackets and words of a pattern."""
    choices = _choices(iter(_PIECE.findall(text)))
    return choices[0] if len(choices) == 1 else (Bracket(choices, optional=False),)


def _choices(pieces: Iterator[str]) -> tuple[Pattern, ...]:
    found: list[list[str | Bracket]] = [[]]
    for piece in pieces:
        if piece in ")]":
            break
        if piece in "([":
            found[-1].append(Bracket(_choices(pieces), piece == "["))
        elif piece == "|":
            found.append([])
        else:
            found[-1].append(piece)
    return tuple(map(tuple, found))


def shown(pattern: Pattern) -> str:
    """A pattern as text."""
    return " ".join(_shown(each) for each in pattern)


def _shown(piece: str | Bracket) -> str:
    if isinstance(piece, str):
        return piece
    inner = "|".join(map(shown, piece.choices))
    if piece.optional:
        return f"[{inner}]" if len(piece.choices) == 1 else f"[({inner})]"
    return inner if len(piece.choices) == 1 else f"({inner})"


def matches(
    pattern: Pattern, words: Sequence[str], start: int, path: Place = ()
) -> Iterator[tuple[int, tuple[Place, ...]]]:
    """Where a pattern that begins at a place may end, with the choices that this takes."""
    if not pattern:
        yield start, ()
        return
    first, at = pattern[0], path[-1] if path else 0
    rest = (*path[:-1], at + 1) if path else (1,)
    here = path or (0,)
    if isinstance(first, str):
        if start < len(words) and first in (words[start], "*"):
            yield from matches(pattern[1:], words, start + 1, rest)
        return
    for number, choice in enumerate(first.choices):
        inside = (*here, number)
        for middle, used in matches(choice, words, start, (*inside, 0)):
            for end, more in matches(pattern[1:], words, middle, rest):
                yield end, (inside, *used, *more)
    if first.optional:
        yield from matches(pattern[1:], words, start, rest)


def pruned(pattern: Pattern, used: Counter[Place], least: int, path: Place = (0,)) -> Pattern:
    """A pattern without the choices that are used less than so many times.

    Choices that differ only within a closed class, like "is" and "are", are used together. Of a
    bracket that may not be left out the choice that is used most is always kept.
    """
    kept: list[str | Bracket] = []
    for number, piece in enumerate(pattern):
        here = (*path[:-1], path[-1] + number)
        if isinstance(piece, str):
            kept.append(piece)
            continue
        together: Counter[str] = Counter()
        for n, choice in enumerate(piece.choices):
            together[_class_of(choice)] += used[(*here, n)]
        enough = least if piece.optional else min(least, max(together.values()))
        choices = [
            pruned(choice, used, least, (*here, n, 0))
            for n, choice in enumerate(piece.choices)
            if together[_class_of(choice)] >= enough
        ]
        choices = list(dict.fromkeys(filter(None, choices)))
        if len(choices) == 1 and not piece.optional:
            kept += choices[0]
        elif len(choices) == 1 and len(choices[0]) == 1 and isinstance(choices[0][0], Bracket):
            kept.append(Bracket(choices[0][0].choices, optional=True))
        elif choices:
            kept.append(Bracket(tuple(choices), piece.optional))
    return tuple(kept)


def _class_of(choice: Pattern) -> str:
    """A choice with each word of a closed class, and each verb, in one form for all."""
    return " ".join(_CLASSES.get(word, word.removesuffix("s")) for word in shown(choice).split())


class Least(NamedTuple):
    """How many uses keep a spelling, a choice within it, and all its choices."""

    spelling: int
    choice: int
    whole: int


class Spelling(NamedTuple):
    """A spelling in a file, and where it stands."""

    file: str
    field: YamlNode

    @property
    def key(self) -> tuple[str, int, int]:
        """The file, line and column."""
        return self.file, self.field.line, self.field.column


class Usage:
    """How often each spelling, choice and line of the word files is used."""

    def __init__(self) -> None:
        self.spellings: dict[tuple[str, int, int], Spelling] = {}
        self.lines: dict[tuple[str, int, int], YamlNode] = {}
        self.uses: Counter[Use] = Counter()
        self.line_uses: Counter[tuple[str, int, int]] = Counter()
        self._of_entry: dict[object, list[tuple[Spelling, tuple[str, int, int], Any]]] = (
            defaultdict(list)
        )
        self._markers: dict[str, list[Spelling]] = defaultdict(list)

    def add_spelling(
        self, field: YamlNode, line: YamlNode | None, key: object, pieces: Any
    ) -> None:
        """Know that an entry comes from a spelling and a line of `is`."""
        spelling = Spelling(Path(field.source).name, field)
        self.spellings[spelling.key] = spelling
        place = spelling.key
        if line is not None:
            place = (spelling.file, line.line, line.column)
            self.lines[place] = line
        self._of_entry[key].append((spelling, place, pieces))

    def add_marker(self, kind: str, field: YamlNode) -> None:
        """Know a discourse marker of a kind."""
        spelling = Spelling(Path(field.source).name, field)
        self.spellings[spelling.key] = spelling
        self._markers[kind].append(spelling)

    def count_reading(self, reading: Reading, words: Sequence[str], weight: int) -> None:
        """Count the spellings that a derivation uses."""
        runs: dict[str, list[tuple[str, ...]]] = defaultdict(list)
        found: list[tuple[object, tuple[str, ...]]] = []
        for part in subderivations(reading.derivation):
            said = tuple(words[part.start : part.end])
            if isinstance(part.rule, Entry):
                runs[str(part.rule.category)].append(said)
                found.append(((part.rule.says, part.rule.category, part.rule.term), said))
            elif isinstance(part.rule, UnaryRule):
                found.append(((part.rule.source, part.rule.target, part.rule.term), ()))
        for key, said in found:
            for spelling, line, pieces in self._of_entry.get(key, ())[:1]:
                self.line_uses[line] += weight
                self._count_choices(spelling, _spelt(pieces, said, runs), weight)

    def count_marker(self, kind: str, phrase: Sequence[str], weight: int) -> None:
        """Count the discourse marker that a phrase is."""
        for spelling in self._markers[kind]:
            if self._count_choices(spelling, [tuple(phrase)], weight):
                return

    def _count_choices(
        self, spelling: Spelling, said: Iterable[Sequence[str]], weight: int
    ) -> bool:
        pattern = parsed(spelling.field.text())
        for words in said:
            for end, used in matches(pattern, words, 0):
                if end == len(words):
                    self.uses[(*spelling.key, ())] += weight
                    for place in used:
                        self.uses[(*spelling.key, place)] += weight
                    return True
        return False


def _spelt(
    pieces: Any, said: tuple[str, ...], runs: dict[str, list[tuple[str, ...]]]
) -> Iterator[tuple[str, ...]]:
    """The words and gaps of a construction, with each of the runs that its derivation has."""
    if pieces is None:
        yield said
        return
    pieces, anchor = pieces
    choices: list[list[tuple[str, ...]]] = []
    for number, piece in enumerate(pieces):
        if piece.category.is_words:
            choices.append([said] if number == anchor else runs.get(str(piece.category), []))
        else:
            name = f"{piece.name}:" if piece.name else ""
            choices.append([(f"{{{name}{piece.category}}}",)])
    for each in itertools.product(*choices):
        yield tuple(itertools.chain.from_iterable(each))


class Recorder:
    """Loads a language whose entries are traced, and records what understanding uses."""

    def __init__(self) -> None:
        self.usage = Usage()
        self._used: list[tuple[Any, list[Any]]] = []
        self._last: list[Any] = []
        self._removed: list[tuple[str, tuple[str, ...]]] = []
        self._trace_loading()
        with patch.object(loader, "kept", lambda _, __, read: read()):  # not from the disk cache
            self.language = Language.load()
        self._trace_understanding()

    def count(self, utterance: Utterance, session: Session) -> str:
        """Understand an utterance and count what it uses; returns the outcome."""
        self._removed.clear()
        self._used.clear()
        understood = utterance.hear(session)
        outcome = utterance.outcome(understood)
        if outcome == "right" and understood.reading is not None:
            weight = 2 if utterance.source in KEPT else 1
            found = next(
                (parts for whole, parts in self._used if whole is understood),
                [(understood.reading, understood.words)],
            )
            for reading, words in found:
                self.usage.count_reading(reading, words, weight)
            for kind, phrase in dict.fromkeys(self._removed):
                self.usage.count_marker(kind, phrase, weight)
        return outcome

    def _trace_loading(self) -> None:
        usage, builder = self.usage, LexiconBuilder
        read_word, add_head = builder._read_word, builder._read_construction

        def word(self: LexiconBuilder, field: YamlNode) -> None:
            before = len(self.lexicon._senses)
            read_word(self, field)
            parts = field.entries(required=("says",), optional=("is", "like"))
            lines = list(parts["is"].listed()) if "is" in parts else []
            senses = iter(self.lexicon._senses[before:])
            per = (len(self.lexicon._senses) - before) // len(parts["says"].listed())
            for says in parts["says"].listed():
                for number, sense in enumerate(itertools.islice(senses, per)):
                    line = lines[number] if number < len(lines) else None
                    entry = sense.entry()
                    usage.add_spelling(says, line, (entry.says, entry.category, entry.term), None)

        def construction(self: LexiconBuilder, field: YamlNode) -> None:
            add_head(self, field)
            from hilt.nlu.grammar.constructions import Construction, pieces_of
            from hilt.nlu.grammar.notation import read_entry

            parts = field.entries(required=("says", "is"), optional=())
            for line in parts["is"].listed():
                category, term, _ = read_entry(line)
                for says in parts["says"].listed():
                    for variant in variants(says):
                        made = Construction(pieces_of(variant, says), category, term)
                        head = made.head
                        key: object = (head.category, made.category, made.functor())
                        if head.category.is_words:
                            key = (head.category.words, made.category, made.functor())
                        usage.add_spelling(says, line, key, (made.pieces, made.anchor))

        def phrases(self: DiscourseMarkers, kind: str, field: YamlNode) -> DiscourseMarkers:
            for each in field.items():
                usage.add_marker(kind, each)
            return with_phrases(self, kind, field)

        with_phrases = DiscourseMarkers.with_phrases
        builder._read_word, builder._read_construction = word, construction
        DiscourseMarkers.with_phrases = phrases

    def _trace_understanding(self) -> None:
        recorder, attempt, markers = self, strategies._Attempt, DiscourseMarkers
        segments, by_segments = attempt._segments, attempt._by_segments
        end_of, tag = markers._end, markers._tag

        def all_segments(self: Any, *given: Any, **options: Any) -> Any:
            recorder._last = segments(self, *given, **options)
            return recorder._last

        def combined(self: Any, *given: Any, **options: Any) -> Any:
            found = by_segments(self, *given, **options)
            if found is not None:
                parts = [(each.reading, each.words) for each in recorder._last if each.reading]
                recorder._used.append((found, parts))
            return found

        def end(self: Any, words: Any, start: int, *given: Any, **options: Any) -> int:
            found = end_of(self, words, start, *given, **options)
            for kind in ("anywhere", "apart", "clauses") if found > start else ():
                recorder._removed.append((kind, words[start:found]))
            return found

        def tag_of(self: Any, tokens: Any, tags: Any) -> Any:
            place = tag(self, tokens, tags)
            for kind in ("question_tags", "statement_tags") if place is not None else ():
                recorder._removed.append((kind, tokens.words[place:]))
            return place

        attempt._segments, attempt._by_segments = all_segments, combined
        markers._end, markers._tag = end, tag_of


def written(path: Path, usage: Usage, least: Least) -> str:
    """The text of a file without what is used less than so many times."""
    text = path.read_text(encoding="utf-8")
    edits: list[tuple[int, int, str]] = []
    for key, value in yaml.compose(text).value:
        if key.value in {"words", "constructions"}:
            for item in value.value:
                edits += _edit_item(text, path.name, item, usage, least)
        elif key.value == "discourse_markers":
            for kind, phrases in value.value:
                if kind.value in _UNCOUNTED:
                    continue
                kept = [_kept(text, path.name, node, usage, least) for node in phrases.value]
                if any(kept):
                    for node, left in zip(phrases.value, kept, strict=True):
                        edits += _edit_marker(text, node, left)
                else:
                    edits.append((phrases.start_mark.index, _end_of(phrases), "[]"))
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return re.sub(r"\n{3,}", "\n\n", text)


def _edit_item(
    text: str, file: str, item: Any, usage: Usage, least: Least
) -> Iterator[tuple[int, int, str]]:
    parts = {key.value: value for key, value in item.value}
    says = _as_list(parts["says"])
    kept = [new for node in says if (new := _kept(text, file, node, usage, least)) is not None]
    kept = list(dict.fromkeys(kept))
    lines = _as_list(parts["is"]) if "is" in parts else []
    closed = any(_is_closed(node.value) for node in says)
    used = [node for node in lines if closed or usage.line_uses[_key(file, node)] >= least.spelling]
    if not kept or (lines and not used):
        start = text.rfind("\n", 0, item.start_mark.index) + 1
        yield start, text.find("\n", _end_of(item)) + 1, ""
        return
    if kept != [text[node.start_mark.index : node.end_mark.index] for node in says]:
        yield _list_edit(parts["says"], kept)
    if len(used) < len(lines):
        texts = [text[node.start_mark.index : node.end_mark.index] for node in used]
        yield _list_edit(parts["is"], texts)


def _list_edit(node: Any, items: Sequence[str]) -> tuple[int, int, str]:
    if not isinstance(node.value, list):
        return node.start_mark.index, _end_of(node), ", ".join(items)
    if not node.flow_style:
        return node.start_mark.index, _end_of(node), f"[{', '.join(items)}]"
    end = node.end_mark.index
    lines, width = [""], 0
    for number, item in enumerate(items):
        comma = ", " if number else ""
        if width + len(item) > 120 and number:
            lines[-1] += ","
            lines.append("    " + item)
            width = len(item) + 4
        else:
            lines[-1] += comma + item
            width += len(item) + 2
    return node.start_mark.index, end, "[" + "\n".join(lines) + "]"


def _edit_marker(text: str, node: Any, kept: str | None) -> Iterator[tuple[int, int, str]]:
    if kept is None:
        start = text.rfind("\n", 0, node.start_mark.index) + 1
        yield start, text.find("\n", node.end_mark.index) + 1, ""
    else:
        yield node.start_mark.index, node.end_mark.index, kept


def _end_of(node: Any) -> int:
    """Where a value ends, without the comments after it."""
    within = node.value[-1] if isinstance(node.value, list) and not node.flow_style else None
    within = within[1] if isinstance(within, tuple) else within
    return node.end_mark.index if within is None else _end_of(within)


def _kept(text: str, file: str, node: Any, usage: Usage, least: Least) -> str | None:
    """The text of a spelling that is left, None for nothing."""
    raw = text[node.start_mark.index : node.end_mark.index]
    if _is_closed(node.value):
        return raw
    key = _key(file, node)
    times = usage.uses[(*key, ())]
    if times < least.spelling:
        return None
    if times >= least.whole:
        return raw
    counts = Counter({use[3]: n for use, n in usage.uses.items() if use[:3] == key})
    pattern = pruned(parsed(node.value), counts, least.choice)
    left = shown(pattern)
    return raw if left == shown(parsed(node.value)) or not left else f'"{left}"'


def _is_closed(text: str) -> bool:
    return not set(text) & set("()[]{}|") and len(text.split()) <= 2


def _key(file: str, node: Any) -> tuple[str, int, int]:
    return file, node.start_mark.line + 1, node.start_mark.column + 1


def _as_list(node: Any) -> list[Any]:
    return node.value if isinstance(node.value, list) else [node]


def main() -> None:
    """Count, print the table, and write the pruned files if asked to."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--least",
        type=int,
        nargs=3,
        default=(1, 1, 20),
        metavar=("SPELLING", "CHOICE", "WHOLE"),
        help="how many uses keep a spelling, a choice within it, and all its choices",
    )
    parser.add_argument("--unused", action="store_true", help="list what is used less")
    parser.add_argument("--write", action="store_true", help="delete what is used less")
    options = parser.parse_args()
    recorder = Recorder()
    session = Session(recorder.language)
    corpus = list(itertools.chain.from_iterable(data_sets().values()))
    corpus += [*generated(recorder.language), *dialogues(), *documented()]
    outcomes: dict[str, Counter[str]] = defaultdict(Counter)
    for each in track(corpus, "utterances", disable=not sys.stderr.isatty()):
        outcomes[each.source][recorder.count(each, session)] += 1
    for source, counts in outcomes.items():
        print(f"{source:16} {dict(counts)}")
    usage = recorder.usage
    print(f"{'file':20} {'kB':>6} {'spellings':>10} {'unused':>7} {'once':>6}")
    for name in FILES:
        path = LANGUAGES_FOLDER / "english" / name
        keys = [key for key in usage.spellings if key[0] == name]
        times = [usage.uses[(*key, ())] for key in keys]
        size = path.stat().st_size / 1000
        print(f"{name:20} {size:6.1f} {len(keys):10} {times.count(0):7} {times.count(1):6}")
        for key, count in zip(keys, times, strict=True) if options.unused else ():
            if count < options.least[0]:
                print(f"  {count} line {key[1]}: {usage.spellings[key].field.text()[:120]}")
    if options.write:
        for name in LISTS:
            path = LANGUAGES_FOLDER / "english" / name
            path.write_text(written(path, usage, Least(*options.least)), encoding="utf-8")


if __name__ == "__main__":
    main()

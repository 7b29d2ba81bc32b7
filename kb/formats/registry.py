"""The file formats, by name and extension, and what each of them carries."""

from dataclasses import dataclass
from pathlib import Path

from ...ontology.errors import DataError

STREAM = "-"  # standard input or output
PACKED = ".gz"


@dataclass(frozen=True)
class FileFormat:
    """A file format."""

    name: str  #: the value of `--format`
    suffixes: tuple[str, ...]  #: the extensions of its files; the first is the usual one
    whole: bool = False  #: whether it has named graphs, and so holds a whole base
    #: what it cannot hold, as half a sentence
    leaves_out: str = "history that no rule comes from, words, episodes and the domain"
    most: int | None = None  #: bytes that are read of it; None where it streams, however long
    is_xml: bool = False  #: whether it is XML, so that document types are refused


_MB = 2**20
_ONLY_RULES = "all but the rules: which utterance told them, history, words, episodes, domain"
_KNOWN = (
    FileFormat("turtle", (".ttl",)),
    FileFormat("turtle12", (".ttl12",)),
    FileFormat("ntriples", (".nt",)),
    FileFormat("rdfxml", (".rdf", ".xml", ".owl"), most=256 * _MB, is_xml=True),
    FileFormat("trig", (".trig",), whole=True, leaves_out=""),
    FileFormat("nquads", (".nq",), whole=True, leaves_out=""),
    FileFormat("jsonld", (".jsonld", ".json"), whole=True, leaves_out="", most=64 * _MB),
    FileFormat("sheet", (".yaml", ".yml"), leaves_out=_ONLY_RULES, most=8 * _MB),
    FileFormat("csv", (".csv",), leaves_out=_ONLY_RULES),
    FileFormat("graphml", (".graphml",), leaves_out=_ONLY_RULES, most=32 * _MB, is_xml=True),
)
FORMATS = {one.name: one for one in _KNOWN}
SUFFIXES = {suffix: one for one in _KNOWN for suffix in one.suffixes}
RULE_FORMATS = frozenset({"sheet", "csv", "graphml"})  # they hold rules as values, no statements


def format_of(file: str, given: str | None, default: str) -> FileFormat:
    """Return the format that is given, or that of a file's extension, not counting ".gz".

    `default` is that of standard input and output. DataError if there is no such format.
    """
    if given is not None:
        if given not in FORMATS:
            known = ", ".join(sorted(FORMATS))
            raise DataError(f'unknown format "{given}"; known: {known}.', source=file)
        return FORMATS[given]
    if file == STREAM:
        return FORMATS[default]
    if (suffix := Path(file.lower().removesuffix(PACKED)).suffix) not in SUFFIXES:
        raise DataError(
            f'the extension "{suffix}" names no format; expected {", ".join(SUFFIXES)}, or name '
            "the format.",
            source=file,
        )
    return SUFFIXES[suffix]

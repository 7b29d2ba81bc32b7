"""Claims about which statements about a rule an import takes, whatever was read before."""

from __future__ import annotations

import io
from collections.abc import Sequence
from decimal import Decimal

import pytest

from hilt.kb.bulk.importer import import_statements
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.rule_mapping import ATTRIBUTED_TO, BELIEFS, FUNCTOR, LOWER, PART, STATUS, UPPER
from hilt.kb.rdf.terms import Quad, Term
from hilt.kb.rule import Atom, Rule
from hilt.kb.stores.rdf_text import read_groups, write_rdf
from hilt.ontology.errors import ValidationError
from hilt.ontology.vocabulary import Iri, iri, term

from ..conftest import BLADE, CUTTING

Pair = tuple[Iri, Term]
OTHER_KNIFE = Iri("https://w3id.org/hilt/object/%6Bnife")  # it is object:knife
GOOD = [*rule_mapping.property_quads(CUTTING)]
BLADE_PAIRS = [quad[1:3] for quad in rule_mapping.property_quads(BLADE)]


def imported(base: KnowledgeBase, pairs: Sequence[Pair]) -> list[Rule]:
    """The rules of a base after it has read a rule, and one with these properties."""
    quads = [Quad(rule_mapping.rule_iri(BLADE.id), *pair, BELIEFS) for pair in pairs]
    stream = io.BytesIO(b"".join(write_rdf([one], format="nquads") for one in [*GOOD, *quads]))
    read = read_groups(stream, format="nquads", source="x", default=BELIEFS)
    import_statements(base, read, source="x")
    return [rule for rule in base.rules(status=None) if rule.id != CUTTING.id]


def changed(key: Iri, value: Term) -> list[Pair]:
    """The properties of a rule with another value."""
    return [(one, value if one == key else old) for one, old in BLADE_PAIRS]


@pytest.mark.parametrize(
    ("more", "problem"),
    [
        ((rule_mapping.FEATURE, OTHER_KNIFE), "hilt:feature is no part of a rule"),
        ((rule_mapping.TYPE, term("FunctionalRule")), "rdf:type is no part of a rule"),
        ((rule_mapping.ARGUMENT, iri("place", "table")), "hilt:argument is no part of a rule"),
        ((rule_mapping.LABEL, "a blade"), "rdfs:label is no part of a rule"),
        ((term("unknown"), 1), "hilt:unknown is no part of a rule"),
        ((rule_mapping.LOWER, Decimal("0.5")), "hilt:lower stands there 2 times"),
        ((rule_mapping.STATUS, term("retracted")), "hilt:status stands there 2 times"),
        ((rule_mapping.DERIVED_FROM, iri("utterance", "first")), "malformed"),
    ],
)
def test_rule_that_says_more_is_refused(kb: KnowledgeBase, more: Pair, problem: str):
    """Of what a rule is made, nothing is there twice, and there is nothing else."""
    with pytest.raises(ValidationError, match=f"{BLADE.id.replace('/', ':')}: .*{problem}"):
        imported(kb, [*BLADE_PAIRS, more])

    assert kb.rules() == []


@pytest.mark.parametrize("lost", [LOWER, UPPER, STATUS, FUNCTOR, PART, ATTRIBUTED_TO])
def test_incomplete_rule_is_refused(kb: KnowledgeBase, lost: Iri):
    """The message says what is missing."""
    with pytest.raises(ValidationError, match=r"A rule has no|graspObject needs a part"):
        imported(kb, [pair for pair in BLADE_PAIRS if pair[0] != lost])


@pytest.mark.parametrize(
    ("key", "value"),
    [
        (LOWER, Decimal("1.5")),
        (UPPER, Decimal("0.1")),
        (STATUS, term("forgotten")),
        (ATTRIBUTED_TO, Iri("http://x/eve")),
        (FUNCTOR, term("usedFor")),
        (PART, iri("place", "table")),
    ],
)
def test_wrong_value_is_refused(kb: KnowledgeBase, key: Iri, value: Term):
    """It is no interval, no status, no speaker, or nothing that the functor takes."""
    with pytest.raises(ValidationError):
        imported(kb, changed(key, value))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        (rule_mapping.TYPE, term("FunctionalRule")),
        (LOWER, Decimal("0.9500001")),
        (LOWER, 0.95),
        (UPPER, True),
        (rule_mapping.FEATURE, OTHER_KNIFE),
    ],
)
def test_rule_in_another_form_is_the_same_rule(kb: KnowledgeBase, key: Iri, value: Term):
    """It has a value that is rounded, of another type, or spelled otherwise."""
    assert [rule.id for rule in imported(kb, changed(key, value))] == [BLADE.id]


def test_statement_may_be_repeated(kb: KnowledgeBase):
    """Where there may be several of its kind."""
    again = [pair for pair in BLADE_PAIRS if pair[0] in {rule_mapping.FEATURE, rule_mapping.TYPE}]

    assert [rule.id for rule in imported(kb, [*BLADE_PAIRS, *again])] == [BLADE.id]


def test_name_of_a_rule_is_that_of_its_content(kb: KnowledgeBase):
    """Whatever its name in the file is."""
    mug = (rule_mapping.FEATURE, iri("object", "mug"))

    (rule,) = imported(kb, [*BLADE_PAIRS, mug])

    assert rule.features == {Atom("object", "knife"), Atom("object", "mug")}
    assert rule.id != BLADE.id

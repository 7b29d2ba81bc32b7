"""A rule about a kind holds for its subkinds, unless a more specific rule exists."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.inference.affordance import Affordances
from hilt.inference.settings import Settings
from hilt.inference.taxonomy import FLAT, Taxonomy
from hilt.inference.types import Goal, Observation, Target
from hilt.kb.formats.ontology import import_ontology
from hilt.kb.interval import CERTAIN, Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Atom, Rule, functional, grasping, kind_rule
from hilt.ontology.errors import DataError

from .rule_sources import Told

G, C = Interval(0.95, 1.0), Interval(0.25, 1.0)
BREAD_KNIFE, KNIFE, TOOL = (Atom("object", n) for n in ("bread knife", "knife", "tool"))
SERVE, PASS = Atom("action", "serve"), Atom("action", "pass")
KINDS = Taxonomy([(BREAD_KNIFE, KNIFE), (KNIFE, TOOL), (SERVE, PASS)])
CUTTING = Goal("pass", Target(used_for="cutting"))
SEEN = Observation("bread knife", "bread knife", {BREAD_KNIFE: CERTAIN})


def test_distances_count_steps_upwards():
    """A kind has distance 0 to itself."""
    assert dict(KINDS.above(BREAD_KNIFE)) == {BREAD_KNIFE: 0, KNIFE: 1, TOOL: 2}
    assert KINDS.below(TOOL) == (TOOL, KNIFE, BREAD_KNIFE)


def test_nothing_can_be_a_kind_of_itself():
    """A taxonomy with a cycle is refused."""
    with pytest.raises(DataError, match="would be a kind of itself"):
        Taxonomy([(KNIFE, TOOL), (TOOL, KNIFE)])


def test_bread_knife_inherits_the_rules_about_knives():
    """The conclusion has the distance to the kind of its rule."""
    affordances = Affordances(Told(functional("knife", "cutting", interval=G)), taxonomy=KINDS)

    best = affordances.infer("pass/findObject", CUTTING, [SEEN]).best

    assert best is not None
    assert (best.interval, best.inherited) == (G, 1)
    assert "which is a kind of knife" in "\n".join(best.proof.lines())


def test_specific_rule_overrules_an_inherited_one():
    """With a rule about bread knives, those about knives do not apply."""
    rules = (
        functional("knife", "cutting", interval=G),
        functional("bread knife", "cutting", interval=C),
    )

    best = Affordances(Told(*rules), taxonomy=KINDS).infer("pass/findObject", CUTTING, [SEEN]).best

    assert best is not None
    assert (best.interval, best.inherited) == (C, 0)


def test_search_includes_the_subkinds_of_a_rules_object():
    """A search for knives includes bread knives."""
    affordances = Affordances(Told(functional("knife", "cutting", interval=G)), taxonomy=KINDS)

    assert affordances.features("pass/findObject", CUTTING) == (BREAD_KNIFE, KNIFE)


def test_grasp_is_inherited_along_objects_and_contexts():
    """A rule about passing knives applies to serving a bread knife."""
    affordances = Affordances(Told(grasping("knife", "blade", "pass", interval=G)), taxonomy=KINDS)
    goal = Goal("serve", Target(object="bread knife"))

    best = affordances.infer("serve/graspObject", goal, [SEEN]).best

    assert best is not None
    assert best.argument == Atom("part", "blade")


def test_rule_about_a_subkind_does_not_hold_for_its_kind():
    """A rule about bread knives does not apply to knives."""
    affordances = Affordances(
        Told(functional("bread knife", "cutting", interval=G)), taxonomy=KINDS
    )
    knife = Observation("knife", "knife", {KNIFE: CERTAIN})

    assert affordances.infer("pass/findObject", CUTTING, [knife]).best is None


HAFT, HANDLE = Atom("part", "haft"), Atom("part", "handle")
GALLEY, KITCHEN = Atom("place", "galley"), Atom("place", "kitchen")
CHILD, PERSON = Atom("role", "child"), Atom("role", "person")
WHOLE = Taxonomy([(HAFT, HANDLE), (GALLEY, KITCHEN), (CHILD, PERSON), (BREAD_KNIFE, KNIFE)])


def test_parts_are_inherited():
    """A rule about objects with a handle applies to an object with a haft, a kind of handle."""
    grips = Rule(frozenset({HANDLE}), frozenset(), "usedFor", Atom("affordance", "cutting"), G)
    affordances = Affordances(Told(grips), taxonomy=WHOLE)
    axe = Observation("axe", "axe", {HAFT: Interval(0.9, 1.0)})

    best = affordances.infer("pass/findObject", CUTTING, [axe]).best

    assert affordances.features("pass/findObject", CUTTING) == (HAFT, HANDLE)
    assert best is not None
    assert (best.interval.lower, best.inherited) == (pytest.approx(0.855), 1)


@pytest.mark.parametrize(("told", "here"), [(KITCHEN, GALLEY), (PERSON, CHILD)])
def test_places_and_roles_are_inherited(told: Atom, here: Atom):
    """A galley is a kitchen and a child a person, with the interval of the given context."""
    rule = Rule(frozenset({KNIFE}), frozenset({told}), "usedFor", Atom("affordance", "cutting"), G)
    goal = Goal("pass", Target(used_for="cutting"), {here: Interval(0.5, 1.0)})
    knife = Observation("knife", "knife", {KNIFE: CERTAIN})

    best = Affordances(Told(rule), taxonomy=WHOLE).infer("pass/findObject", goal, [knife]).best

    assert best is not None
    assert best.interval.lower == pytest.approx(0.475)
    assert f"{here}, which is a kind of {told.name}" in {each.label for each in best.proof}


def test_rule_about_a_kind_of_place_does_not_hold_for_the_place():
    """A rule for a galley does not apply in a kitchen."""
    rule = Rule(
        frozenset({KNIFE}), frozenset({GALLEY}), "usedFor", Atom("affordance", "cutting"), G
    )
    goal = Goal("pass", Target(used_for="cutting"), {KITCHEN: CERTAIN})
    knife = Observation("knife", "knife", {KNIFE: CERTAIN})

    assert (
        Affordances(Told(rule), taxonomy=WHOLE).infer("pass/findObject", goal, [knife]).best is None
    )


def test_explanation_names_the_overruled_rule():
    """The inherited rule does not count and is listed as overruled."""
    far, near = (functional(name, "cutting", interval=G) for name in ("knife", "bread knife"))

    best = (
        Affordances(Told(far, near), taxonomy=KINDS).infer("pass/findObject", CUTTING, [SEEN]).best
    )

    assert best is not None
    assert (best.rules, best.overruled) == ((near,), (far,))
    assert repr(far) in best.reason


@pytest.mark.parametrize(
    ("holding", "threshold"), [({}, 0.1), ({GALLEY: CERTAIN}, 0.9), ({PERSON: CERTAIN}, 0.1)]
)
def test_threshold_of_a_place_only_raises_the_threshold(
    holding: dict[Atom, Interval], threshold: float
):
    """Thresholds of passing and kitchen apply to serving in a galley, a lower one does not."""
    settings = Settings(thresholds={"pass": 0.1, "place:kitchen": 0.9, "role:person": 0.01})
    kinds = Taxonomy([(SERVE, PASS), (GALLEY, KITCHEN)])
    goal = Goal("serve", Target(used_for="cutting"), holding)

    inference = Affordances(Told(), settings, kinds).infer("serve/findObject", goal, [SEEN])

    assert inference.threshold == threshold


PAIRS = st.lists(st.tuples(st.sampled_from("abcde"), st.sampled_from("abcde")), max_size=12)


@given(PAIRS)
def test_what_is_told_never_closes_a_cycle(pairs: list[tuple[str, str]]):
    """Whatever is told, no object is above itself through others; the later is left out."""
    rules = [kind_rule(one, other, interval=G) for one, other in pairs]

    taxonomy = Taxonomy().with_rules(rules)

    for name in "abcde":
        above = [kind.name for kind, steps in taxonomy.above(Atom("object", name)) if steps]
        assert name not in above
        assert not any(name in taxonomy.names_above("object", each) for each in above)


def test_kinds_that_are_told_are_read_again_after_a_change():
    """Rules on kinds are inherited along as soon as they are told, and no longer when forgotten."""
    knives = functional("knife", "cutting", interval=G)
    source = Told(knives, kind_rule("bread knife", "knife", interval=G))
    affordances = Affordances(source)

    told = affordances.infer("pass/findObject", CUTTING, [SEEN]).best
    source.rules, source.sequence = (knives,), 1
    forgotten = affordances.infer("pass/findObject", CUTTING, [SEEN]).best

    assert told is not None
    assert (told.interval, told.inherited, forgotten) == (G, 1, None)


AWL, BODKIN, CHISEL = (Atom("object", name) for name in ("awl", "bodkin", "chisel"))


def test_what_is_not_likely_or_about_no_object_is_no_kind():
    """Where nothing of the kind is told, the taxonomy stays itself."""
    doubtful = kind_rule("awl", "bodkin", interval=Interval(0, 1))
    anything = Rule(frozenset({Atom("property", "red")}), frozenset(), "kindOf", BODKIN, G)

    for rules in ([], [doubtful], [anything]):
        assert FLAT.with_rules(rules) is FLAT


@pytest.mark.parametrize("order", [1, -1])
def test_kinds_that_were_told_last_come_first(order: int):
    """What is not stored yet was told before all that is."""
    unstored = kind_rule("awl", "bodkin", interval=G)
    stored = replace(kind_rule("awl", "chisel", interval=G), utterance=1)

    assert FLAT.with_rules([unstored, stored][::order]).above(AWL) == (
        (AWL, 0),
        (CHISEL, 1),
        (BODKIN, 1),
    )


def test_kinds_of_others_do_not_turn_those_of_the_household_round():
    """Two synonyms of theirs may each be a kind of the other."""
    found = Taxonomy([(AWL, BODKIN)], foreign=[(BODKIN, AWL), (BODKIN, CHISEL), (CHISEL, BODKIN)])

    assert found.above(BODKIN) == ((BODKIN, 0), (CHISEL, 1))
    assert found.above(AWL) == ((AWL, 0), (BODKIN, 1), (CHISEL, 2))
    assert found.above(CHISEL) == ((CHISEL, 0), (BODKIN, 1))


ONTOLOGY = """@prefix : <http://x.org/tools#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
:HandSaw rdfs:subClassOf :Saw , [ a owl:Restriction ; owl:onProperty :hasPart ] .
:Saw rdfs:subClassOf :T ; rdfs:label "saw" , "scie"@fr , "wood saw"@en-GB .
:Fretsaw owl:equivalentClass :Saw .
"""


def test_names_of_an_ontology_are_those_in_english(tmp_path: Path):
    """Of a class, the end of its address and its labels; classes without a name have none."""
    file = tmp_path / "tools.ttl"
    file.write_text(ONTOLOGY)
    with KnowledgeBase.open("memory:") as base:
        import_ontology(base, str(file))
        base.taxonomies = ("tools",)
        kinds = Taxonomy.declared(base)

    saws = {"saw", "wood saw", "fretsaw"}
    assert kinds.names_above("object", "hand saw") == {"hand saw", "t"} | saws
    assert kinds.names_above("object", "scie") == {"scie"}
    assert kinds.names_above("object", "saw") == {"saw", "t", "fretsaw", "wood saw"}
    assert kinds.names_above("object", "fretsaw") == {"t"} | saws
    assert {atom.name for atom in kinds.below(Atom("object", "t"))} == {"t", "hand saw"} | saws

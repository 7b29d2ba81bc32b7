"""The vocabulary and its SHACL shapes: they are complete, and each constraint can be violated."""

from __future__ import annotations

import pytest
from pyshacl import validate
from rdflib import OWL, RDF, RDFS, SH, Graph, URIRef

from hilt.ontology.vocabulary import HILT, PREFIXES, SHAPES_FILE, VOCABULARY_FILE

VOCABULARY = Graph().parse(VOCABULARY_FILE)
SHAPES = Graph().parse(SHAPES_FILE)
CLASSES = [node for node in VOCABULARY.subjects(RDF.type, OWL.Class) if isinstance(node, URIRef)]
PROPERTIES = [
    node
    for kind in (OWL.ObjectProperty, OWL.DatatypeProperty)
    for node in VOCABULARY.subjects(RDF.type, kind)
]
HEAD = "".join(f"@prefix {prefix}: <{namespace}> .\n" for prefix, namespace in PREFIXES.items())

RULE = """rule:0123456789abcdef a hilt:ActionRule ; hilt:feature object:knife ;
    hilt:context action:pass ; hilt:functor hilt:graspObject ; hilt:part part:blade ;
    hilt:lower 0.95 ; hilt:upper 1.0 ; hilt:status hilt:active ;
    prov:wasAttributedTo speaker:sam ; prov:wasDerivedFrom utterance:1 ;
    prov:generatedAtTime "2026-11-21T09:00:00Z"^^xsd:dateTime ."""
USE = """rule:0123456789abcdef a hilt:FunctionalRule ; hilt:feature object:knife ;
    hilt:functor hilt:usedFor ; hilt:affordance affordance:cutting ; hilt:lower 0.95 ;
    hilt:upper 1.0 ; hilt:status hilt:active ; prov:wasAttributedTo speaker:sam ."""
NORM = """rule:0123456789abcdef a hilt:Norm ; hilt:feature object:knife ;
    hilt:context action:pass , role:child ; hilt:functor functor:obliged ;
    hilt:argument action:pointTo ; hilt:lower 0.95 ; hilt:upper 1.0 ; hilt:status hilt:active ;
    prov:wasAttributedTo speaker:sam ."""
SAID = """utterance:1 a hilt:Utterance ; hilt:sequence 1 ; hilt:text "Hello." ;
    hilt:kind "statement" ; hilt:accepted true ; hilt:predicate "x" ; hilt:answer "y" ;
    hilt:asserts rule:0123456789abcdef ; prov:wasAttributedTo speaker:sam ;
    prov:generatedAtTime "2026-11-21T09:00:00Z"^^xsd:dateTime ."""
DONE = """episode:1 a hilt:Episode ; hilt:goal "g" ; hilt:text "t" ; hilt:answer "a" ;
    hilt:outcome "done" ; hilt:seed 7 ; hilt:document "{}" ;
    hilt:trajectory "{}" ; hilt:about utterance:1 ;
    hilt:step step:1.0 ; hilt:chosenObject object:knife ; prov:used rule:0123456789abcdef ;
    hilt:trial trial:1.0 ; hilt:touched part:blade ; hilt:lifted 0.15 ; hilt:handedOver true ;
    prov:wasAttributedTo speaker:sam ;
    prov:generatedAtTime "2026-11-21T09:00:00Z"^^xsd:dateTime ."""
STEP = 'step:1.0 a hilt:Step ; hilt:index 0 ; hilt:path "pass" ; hilt:lower 0.9 ; hilt:upper 1.0 .'
TRIAL = """trial:1.0 a hilt:GraspTrial ; hilt:index 0 ; hilt:chosenObject object:knife ;
    hilt:part part:blade ; hilt:context action:pass ; hilt:outcome "slipped" ; hilt:robot "panda" ;
    hilt:forgottenBy utterance:3 ."""
PART = """part:knife.blade a hilt:Part ; rdfs:label "blade of knife" ; hilt:isA part:blade ;
    hilt:partOf object:knife ; hilt:whole object:knife ; hilt:role role:edge ;
    hilt:property property:sharp ; hilt:mass 0.1 ."""
RELATION = """relation:graspedBy.action-pass a hilt:Relation ;
    rdfs:subPropertyOf hilt:graspedBy ; hilt:context action:pass ."""
NODE = """node:pass.graspObject a hilt:Node ; rdfs:label "pass.graspObject" ;
    hilt:rule rule:0123456789abcdef ; hilt:does action:graspObject ; hilt:under node:pass ;
    hilt:heeds node:graspObject ."""
OBJECT = 'object:knife a hilt:Object ; rdfs:label "knife" ; hilt:isA object:cutlery .'
TRUST = """speaker:sam a hilt:Speaker ; rdfs:label "sam" ; hilt:trustLower 0.9 ;
    hilt:trustUpper 1.0 ."""
WORD = """word:ladle a hilt:Word ; rdfs:label "ladle" ; hilt:denotes object:ladle ;
    hilt:look "{}" ; prov:wasAttributedTo speaker:sam ."""
PHRASE = """phrase:0123abcd a hilt:Phrase ; hilt:pattern "you cut with a ?object" ;
    hilt:meaning "{}" ; prov:wasAttributedTo speaker:sam ."""
TAUGHT = """taught:0123abcd a hilt:TaughtAction ; hilt:denotes action:serve ;
    hilt:meaning "{}" ; prov:wasAttributedTo speaker:sam ."""
BASE = """<https://w3id.org/hilt/base> a hilt:Base ; hilt:formatVersion 1 ; hilt:sequence 3 ;
    hilt:derivation 1 ; hilt:domainHash "x" ."""
EXAMPLES = {
    "Rule": RULE.replace("ActionRule", "Rule"),
    "ActionRule": RULE,
    "FunctionalRule": USE,
    "Norm": NORM,
    "Utterance": SAID,
    "Episode": DONE,
    "Step": STEP,
    "GraspTrial": TRIAL,
    "Part": PART,
    "Relation": RELATION,
    "Node": NODE,
    "Object": OBJECT,
    "Speaker": TRUST,
    "Word": WORD,
    "Phrase": PHRASE,
    "TaughtAction": TAUGHT,
    "Base": BASE,
    "Status": "hilt:active a hilt:Status .",
    "Functor": 'functor:moveTo a hilt:Functor ; rdfs:label "moveTo" .',
} | {
    name: f'{name.lower()}:x a hilt:{name} ; rdfs:label "x" .'
    for name in ("Property", "Action", "Place", "Role", "Affordance", "Material")
}

# (valid text, what stands in it, what is put instead, what the message says)
BREAKS = [
    (RULE, "rule:0123456789abcdef a", "rule:x a", "A rule is a node rule:ID"),
    (RULE, "hilt:feature object:knife", "hilt:feature speaker:sam", "hilt:feature leads to"),
    (RULE, "hilt:context action:pass", "hilt:context node:pass", "hilt:context leads to"),
    (USE, "hilt:feature object:knife ;", "", "at least one hilt:feature or hilt:context"),
    (RULE, "hilt:functor hilt:graspObject ;", "", "one hilt:functor"),
    (RULE, "hilt:lower 0.95 ;", "", "A rule has one hilt:lower"),
    (RULE, "hilt:upper 1.0 ;", "", "A rule has one hilt:upper"),
    (RULE, "0.95", "-0.1", "hilt:lower is one decimal in"),
    (RULE, "0.95", "0.1 , 0.2", "hilt:lower is one decimal in"),
    (RULE, "0.95", "0.1234567", "hilt:lower is one decimal in"),
    (RULE, "0.95", '"high"', "hilt:lower is one decimal in"),
    (RULE, "0.95", "9.5e-1", "hilt:lower is one decimal in"),
    (RULE, "hilt:upper 1.0", "hilt:upper 0.5", "hilt:lower is one decimal in"),
    (RULE, "hilt:upper 1.0", "hilt:upper 1.3", "hilt:upper is one decimal in"),
    (RULE, "part:blade ;", "part:blade , part:handle ;", "at most one hilt:part"),
    (RULE, "part:blade ;", "object:mug ;", "hilt:part leads to a part"),
    (RULE, "hilt:active", "hilt:maybe", "one hilt:status"),
    (RULE, "utterance:1", "utterance:x", "prov:wasDerivedFrom of a rule"),
    (RULE, "2026-11-21T09:00:00Z", "yesterday", "prov:generatedAtTime of a rule"),
    (RULE, "speaker:sam", "object:sam", "one speaker:NAME"),
    (RULE, "hilt:functor hilt:graspObject", "hilt:functor hilt:usedFor", "of an action rule"),
    (RULE, "hilt:part part:blade ;", "", "An action rule has one hilt:part"),
    (RULE, "hilt:part part:blade", "hilt:argument speaker:sam", "hilt:argument leads to"),
    (USE, "hilt:functor hilt:usedFor", "hilt:functor hilt:graspObject", "a functional rule is"),
    (USE, "hilt:affordance affordance:cutting ;", "", "has one hilt:affordance"),
    (USE, "affordance:cutting", "object:cutting", "hilt:affordance leads to"),
    (NORM, "functor:obliged", "functor:advised", "of a norm is functor:forbidden"),
    (NORM, "action:pass ,", "action:pass , action:use ,", "A norm has one action"),
    (NORM, "hilt:argument action:", "hilt:argument object:", "hilt:argument of a norm"),
    (NORM, "hilt:argument action:", "hilt:affordance affordance:", "A norm has a hilt:part"),
    (SAID, "utterance:1", "utterance:first", "An utterance is a node"),
    (SAID, "hilt:sequence 1", "hilt:sequence 0", "one hilt:sequence"),
    (SAID, 'hilt:text "Hello." ;', "", "one hilt:text"),
    (SAID, 'hilt:predicate "x"', "hilt:predicate 1", "at most one hilt:predicate"),
    (SAID, 'hilt:answer "y"', "hilt:answer 1", "at most one hilt:answer"),
    (SAID, 'hilt:answer "y"', "hilt:heard 1.5", "at most one hilt:heard"),
    (SAID, 'hilt:kind "statement" ;', "", "one hilt:kind"),
    (SAID, "hilt:accepted true", 'hilt:accepted "yes"', "one hilt:accepted"),
    (SAID, "rule:0123456789abcdef", "object:x", "lead to a rule"),
    (SAID, "2026-11-21T09:00:00Z", "x", "An utterance has one prov:generatedAtTime"),
    (DONE, 'hilt:goal "g" ;', "", "one hilt:goal"),
    (DONE, 'hilt:text "t" ;', "", "one hilt:text"),
    (DONE, 'hilt:answer "a" ;', "", "one hilt:answer"),
    (DONE, '"done"', '"finished"', "one hilt:outcome"),
    (DONE, "hilt:seed 7", 'hilt:seed "7"', "one hilt:seed"),
    (DONE, 'hilt:document "{}" ;', "", "one hilt:document"),
    (DONE, 'hilt:trajectory "{}"', "hilt:trajectory 1", "at most one hilt:trajectory"),
    (DONE, "utterance:1", "rule:1", "hilt:about leads to"),
    (DONE, "step:1.0", "node:x", "hilt:step leads to"),
    (DONE, "trial:1.0", "step:1.0", "hilt:trial leads to"),
    (DONE, "object:knife", "part:knife", "hilt:chosenObject leads to"),
    (DONE, "part:blade", "object:blade", "hilt:touched leads to"),
    (DONE, "hilt:lifted 0.15", 'hilt:lifted "high"', "at most one hilt:lifted"),
    (DONE, "hilt:handedOver true", "hilt:handedOver 1", "at most one hilt:handedOver"),
    (DONE, "rule:0123456789abcdef", "rule:x", "prov:used leads to"),
    (DONE, "episode:1 a", "step:1 a", "An episode is a node"),
    (DONE, "2026-11-21T09:00:00Z", "x", "An episode has one prov:generatedAtTime"),
    (TRIAL, "trial:1.0 a", "step:x a", "A trial is a node"),
    (TRIAL, "hilt:chosenObject object:knife ;", "", "A trial has one hilt:chosenObject"),
    (TRIAL, "part:blade", "object:blade", "A trial has one hilt:part"),
    (TRIAL, "action:pass", "node:pass", "A trial has one hilt:context"),
    (TRIAL, '"slipped"', '"lost"', "A trial has one hilt:outcome"),
    (TRIAL, '"panda"', "7", "A trial has one hilt:robot"),
    (TRIAL, "utterance:3", "rule:3", "hilt:forgottenBy leads to"),
    (STEP, "hilt:index 0", "hilt:index -1", "one hilt:index"),
    (STEP, 'hilt:path "pass" ;', "", "one hilt:path"),
    (STEP, "step:1.0 a", "node:x a", "A step is a node"),
    (PART, "part:knife.blade a", "object:blade a", "A part is a node"),
    (PART, "hilt:isA part:blade", "hilt:isA object:blade", "hilt:isA of a part"),
    (PART, "hilt:partOf object:knife", "hilt:partOf part:knife", "hilt:partOf leads to"),
    (PART, "hilt:whole object:knife", "hilt:whole object:a , object:b", "hilt:whole leads to"),
    (PART, "role:edge", "property:edge", "hilt:role leads to"),
    (PART, "property:sharp", "role:sharp", "hilt:property leads to"),
    (PART, "hilt:mass 0.1", "hilt:mass -0.1", "hilt:mass is one decimal"),
    (RELATION, "relation:graspedBy.action-pass a", "node:x a", "relation is a node relation:NAME"),
    (NODE, "node:pass.graspObject a", "step:x a", "An action node is a node"),
    (NODE, "rule:0123456789abcdef", "rule:x", "hilt:rule leads to"),
    (NODE, "action:graspObject", "node:x", "hilt:does leads to"),
    (NODE, "hilt:under node:pass", "hilt:under action:pass", "hilt:under leads to"),
    (NODE, "hilt:heeds node:graspObject", "hilt:heeds action:x", "hilt:heeds leads to"),
    (OBJECT, "object:knife a", "part:knife a", "An object is a node"),
    (OBJECT, 'rdfs:label "knife" ;', "", "has an rdfs:label"),
    (OBJECT, "object:cutlery", "part:x", "hilt:isA of an object"),
    (TRUST, "speaker:sam a", "object:sam a", "A speaker is a node"),
    (TRUST, "hilt:trustLower 0.9", "hilt:trustLower 1.5", "hilt:trustLower is one decimal"),
    (TRUST, "hilt:trustUpper 1.0", "hilt:trustUpper 1.5", "hilt:trustUpper is one decimal"),
    (WORD, "word:ladle a", "object:ladle a", "A word is a node"),
    (WORD, "object:ladle", "speaker:ladle", "hilt:denotes leads to"),
    (PHRASE, "phrase:0123abcd a", "phrase:x a", "A phrase is a node"),
    (WORD, 'hilt:look "{}"', 'hilt:look "{}", "[]"', "A word has at most one hilt:look"),
    (PHRASE, 'hilt:pattern "you cut with a ?object" ;', "", "A phrase has one hilt:pattern"),
    (PHRASE, 'hilt:meaning "{}" ;', "", "A phrase has one hilt:meaning"),
    (TAUGHT, "taught:0123abcd a", "taught:x a", "A taught action is a node"),
    (TAUGHT, "hilt:denotes action:serve ;", "", "A taught action has one hilt:denotes"),
    (TAUGHT, 'hilt:meaning "{}" ;', "", "A taught action has one hilt:meaning"),
    (BASE, "hilt:formatVersion 1 ;", "", "one hilt:formatVersion"),
    (BASE, "hilt:sequence 3", 'hilt:sequence "3"', "at most one hilt:sequence"),
    (BASE, "hilt:derivation 1", 'hilt:derivation "1"', "at most one hilt:derivation"),
    (BASE, 'hilt:domainHash "x"', "hilt:domainHash 1", "at most one hilt:domainHash"),
    ("hilt:active a hilt:Status .", "hilt:active a", "hilt:maybe a", "A status is"),
    (EXAMPLES["Functor"], "functor:moveTo a", "functor:Move a", "A functor is"),
    *(
        (EXAMPLES[name], f"{name.lower()}:x a", "node:x a", f"is a node {name.lower()}:NAME")
        for name in ("Property", "Action", "Place", "Role", "Affordance", "Material")
    ),
]


def findings(text: str) -> list[str]:
    """Return the validation messages about a text."""
    _, report, _ = validate(Graph().parse(data=HEAD + text, format="turtle"), shacl_graph=SHAPES)
    return [str(message) for message in report.objects(None, SH.resultMessage)]


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_example_of_each_class_is_valid(name: str):
    """The RDF that the base writes for a class conforms to its shape."""
    assert findings(EXAMPLES[name]) == []


@pytest.mark.parametrize(("text", "old", "new", "said"), BREAKS)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_each_constraint_can_be_violated(text: str, old: str, new: str, said: str):
    """One change to a valid example gives the message of that constraint."""
    assert old in text

    assert any(said in message for message in findings(text.replace(old, new, 1)))


def test_every_message_of_a_shape_has_a_test():
    """Each constraint is violated by one of the examples."""
    said = [one[3] for one in BREAKS]
    messages = {str(message) for message in SHAPES.objects(None, SH.message)}

    assert [m for m in sorted(messages) if not any(part in m for part in said)] == []


def test_every_class_has_a_shape():
    """Each class but the abstract Atom has a shape."""
    shaped = set(SHAPES.objects(None, SH.targetClass))

    assert {node for node in CLASSES if node not in shaped} == {URIRef(HILT + "Atom")}


@pytest.mark.parametrize("node", sorted([*CLASSES, *PROPERTIES]))
def test_every_term_has_a_label_and_a_comment(node: URIRef):
    """Each class and property has a label and a comment."""
    assert VOCABULARY.value(node, RDFS.label)
    assert str(VOCABULARY.value(node, RDFS.comment)).endswith(".")


@pytest.mark.parametrize("node", sorted(PROPERTIES))
def test_every_property_has_domain_and_range(node: URIRef):
    """Each property has a domain and a range."""
    assert VOCABULARY.value(node, RDFS.domain)
    assert VOCABULARY.value(node, RDFS.range)


def test_shapes_use_only_terms_of_the_vocabulary():
    """Shapes have no term that the vocabulary does not define."""
    used = {
        node
        for triple in SHAPES
        for node in triple
        if isinstance(node, URIRef) and node.startswith(HILT)
    }

    assert used <= set(VOCABULARY.subjects())

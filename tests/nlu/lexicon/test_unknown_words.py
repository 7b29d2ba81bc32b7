"""Unknown words: their roles, their forms, and misspellings of known ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.nlu import AskBack, Language, Misunderstanding, NewWord
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.lexicon.unknown_words import KnownWords


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("A ladle is used for cutting", {"ladle": "object"}),
        ("Ladles are used for cutting", {"ladle": "object"}),
        ("A knife is used for whittling", {"whittling": "affordance"}),
        ("A knife is used to whittle", {"whittling": "affordance"}),
        ("You can whittle with a knife", {"whittling": "affordance"}),
        ("To pass a knife grab it by the ferrule", {"ferrule": "part"}),
        ("To throw a mug grab it by the handle", {"throw": "context"}),
        ("When throwing a mug, grab it by the handle", {"throw": "context"}),
        ("To store a mug, grab it by the handle", {"store": "context"}),
        ("A ladle is used for scooping", {"ladle": "object", "scooping": "affordance"}),
        ("To pass a ladle grab it by the ferrule", {"ladle": "object", "ferrule": "part"}),
        ("Scissors are used for cutting", {"scissors": "object"}),
    ],
)
def test_the_rest_of_the_sentence_shows_the_role(
    language: Language, text: str, words: dict[str, str]
) -> None:
    """A new word is named in its dictionary form."""
    understood = language.understand(text)

    assert understood.kind == "statement"
    assert {word.word: word.role for word in understood.new_words} == words


@pytest.mark.parametrize(
    ("text", "kind", "unknown"),
    [
        ("pass me the ladle", "command", "ladle"),
        ("what is a ladle used for", "question", "ladle"),
        ("pick up something used for scooping", "command", "scooping"),
        ("cut the rope with the saw", "command", "saw"),
    ],
)
def test_commands_and_questions_teach_no_words(
    language: Language, text: str, kind: str, unknown: str
) -> None:
    """An unknown word in a question or command is reported as unknown."""
    understood = language.understand(text)

    assert understood.kind == kind
    assert understood.new_words == ()
    assert understood.unknown == (unknown,)


def test_the_agent_of_a_passive_is_no_part(language: Language) -> None:
    """After "by" may stand a part or a doer, so one of a passive's two words must be known."""
    assert language.understand("A mug is washed by the handle").kind == "statement"
    assert language.understand("A mug is washed by the cleaner").kind == "error"


def test_known_words_are_not_called_unknown(language: Language) -> None:
    """Every word is known, but not in this combination."""
    meaning = language.understand("you may touch not the knife with").meaning

    assert isinstance(meaning, Misunderstanding)
    assert meaning.message.startswith(
        'I can\'t do anything with "you may touch not the knife with".'
    )


@pytest.mark.parametrize("text", ["cut Kim with the knife", "Poke Bob."])
def test_nothing_is_done_to_people(language: Language, text: str) -> None:
    """A new name in a command is that of a thing."""
    assert language.understand(text).kind in {"error", "ask_back"}


@pytest.mark.parametrize(
    ("text", "suggestion"),
    [
        ("A knfe is used for cutting", "knife"),
        ("A hamer is used for pounding", "hammer"),
        ("A knife is uesd for cutting", "used"),
        ("To pass a knife grab it by the hadnle", "handle"),
        ("A knife is used for cuttng", "cutting"),
        ("pass me the knive", "knife"),
        ("A mugg is used for drinking", "mug"),
        ("Knivs are used for cutting", "knives"),
    ],
)
def test_a_misspelling_is_asked_about(language: Language, text: str, suggestion: str) -> None:
    """A near miss of a known word is never learned silently."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, AskBack)
    assert meaning.choices == (suggestion,)


def test_a_speaker_may_insist_on_a_new_word(language: Language) -> None:
    """A word is new when its speaker says so, however close it is to another."""
    understood = language.understand("A hamper is used for containing", accepted={"hamper"})

    assert understood.new_words == (NewWord("hamper", "object", "hamper"),)


def test_learned_words_are_known_in_all_forms(language: Language) -> None:
    """Plural, gerund, infinitive: at once."""
    taught = language.with_words(
        [NewWord("fork", "object", "fork"), NewWord("stirring", "affordance", "stirring")]
    )

    for text in ("pass me the fork", "pick up something to stir with", "what are forks used for"):
        assert taught.understand(text).kind in {"command", "question"}
    assert language.understand("pass me the fork").unknown == ("fork",)


@pytest.mark.parametrize(
    "text",
    [
        "A knife is used for nothing",
        "To pass a knife grab it by the wrong",
        "none is used for cutting",
    ],
)
def test_words_of_grammar_are_no_names(language: Language, text: str) -> None:
    """The word "nothing" is no affordance, and "none" no object."""
    assert language.understand(text).kind == "error"


def test_too_many_new_words_of_one_rule_teach_nothing(language: Language) -> None:
    """With too many unknown words the rest of a sentence shows no roles."""
    understood = language.understand("To zorp a florp grab the blick by the quux")

    assert understood.kind in {"error", "ask_back"}
    assert understood.new_words == ()


@pytest.mark.parametrize("text", ["Cake, knives are for cutting", "Cake. Knives are for cutting"])
def test_no_parsed_name_spans_a_pause(language: Language, text: str) -> None:
    """A cake knife is one thing, cake and then knives are two, in whatever way it is tried."""
    together = language.understand(text.replace(",", "").replace(".", ""))
    apart = language.understand(text)

    assert together.meaning.as_json()["object"] == "cake knife"
    assert apart.meaning.as_json().get("object") != "cake knife"


@pytest.fixture
def known_words(language: Language) -> KnownWords:
    """The words that English has."""
    return language.utterance_parser.known_words


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a zorp is used for cutting", ["zorp"]),
        ("a knife is used for cutting", []),
        ("nothing is used for florping", ["florping"]),
    ],
)
def test_words_outside_every_lexicon_are_unknown(
    known_words: KnownWords, text: str, words: list[str]
) -> None:
    """Words of grammar are known, also those that Hilt has no use for."""
    assert [token.word for token in known_words.unknown(tokenize(text, {}))] == words


def test_an_unknown_word_may_have_every_role(known_words: KnownWords) -> None:
    """An object, a part, an act, a use or a person; the rest of the sentence decides."""
    tokens = tokenize("to zorp it.", {})

    guessed = known_words.guesses(tokens, known_words.unknown(tokens))

    roles = {entry.role for entry in guessed[1]}
    assert roles == {"object", "part", "context", "affordance", "place", "recipient"}


def test_a_word_of_a_construction_may_be_taught(known_words: KnownWords) -> None:
    """The word "carry" adds nothing in some turns, and is an act in a lesson all the same."""
    tokens = tokenize("to carry it", {})

    assert known_words.unknown(tokens) == []
    assert 1 in known_words.guesses(tokens, [])


def test_no_guessed_name_spans_a_pause(known_words: KnownWords) -> None:
    """A cake knife is one thing; "cake, knife" are two."""

    def names(text: str) -> set[str]:
        tokens = tokenize(text, {})
        found = known_words.guesses(tokens, known_words.unknown(tokens))
        return {entry.says for entries in found.values() for entry in entries if " " in entry.says}

    assert "zorp knife" in names("zorp knife")
    assert "zorp knife" not in names("zorp, knife")


def test_a_thing_may_be_called_as_a_word_of_meanings_is(language: Language) -> None:
    """A speaker that plays music is not the speaker of the sentence."""
    meaning = language.understand("a speaker is used for zorping").meaning.as_json()

    assert (meaning["object"], meaning["affordance"]) == ("speaker", "zorping")


@pytest.mark.parametrize(
    "text",
    [
        "Give the knife to the drawer",
        "Give the knife to the left",
        "Give the knife to the spoon",
        "Pass softly the mug",
        "Pass plese the mug",
        "The lock needs a key",
        "Send a letter to my landlord",
        "Pick up the mug by the fjord",
        "Pick up the mug by the window",
        "Pass me the chipped mug",
        "Is the chipped mug used for containing?",
        "Knives are for cutting, and pigs fly",
        "Mugs as with glasses are used for containing",
    ],
)
def test_where_a_sentence_shows_no_role_nothing_is_guessed(language: Language, text: str) -> None:
    """A word may be a place, an adjective, an adverb, a clause of its own, or a slip."""
    assert language.understand(text).kind in {"error", "ask_back"}


@pytest.mark.parametrize(
    ("text", "use"),
    [
        ("One slurps from a mug.", "slurping"),
        ("One sips from a beaker.", "sipping"),
        ("One dusts with a cloth.", "dusting"),
        ("One polishes with a cloth.", "polishing"),
        ("You can floss with a cord.", "flossing"),
        ("A lens is used to focus.", "focusing"),
    ],
)
def test_use_is_named_after_the_bare_verb(language: Language, text: str, use: str) -> None:
    """A third person form is no verb of its own; a verb may end in "s" all the same."""
    assert language.understand(text).meaning.as_json()["affordance"] == use


@pytest.mark.parametrize("text", ["A mug is used to slurps.", "You can slurps from a mug."])
def test_third_person_form_is_no_verb_of_its_own(language: Language, text: str) -> None:
    """Where a bare verb is expected, no use is named after a third person form."""
    assert language.understand(text).kind in {"error", "ask_back"}


@given(st.from_regex(r"[bcdfgklmnprt]{1,2}[aeiou][bdgklmnprt]{1,2}", fullmatch=True))
def test_no_use_ends_as_a_third_person_form_does(language: Language, verb: str) -> None:
    """Whatever the unknown verb, its third person form gives the gerund of the verb."""
    known = language.utterance_parser.known_words
    tokens = tokenize(f"one {verb}s with a zib", {})

    guessed = known.guesses(tokens, known.unknown(tokens)).get(1, ())

    assert not [entry.name for entry in guessed if entry.name.endswith("sing")]


def test_one_word_may_be_taught_and_used_in_one_conversation(language: Language) -> None:
    """What one rule teaches is known to the next, in every form, and asked about no more."""
    learned = language.understand("A scythe is picked up by the snath").new_words
    taught = language.with_words(learned)

    told = taught.understand("Scythes are passed by the snath")
    asked = taught.understand("Pick the scythe up by the snath")

    assert told.kind == "statement"
    assert told.new_words == ()
    assert asked.meaning.as_json()["part"] == "snath"

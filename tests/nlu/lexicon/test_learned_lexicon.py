"""The lexicon that grows: any number of words, in any order, without any change to the old one."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.nlu import Language, NewWord

ROLES = {"object": "zorp", "part": "blick", "affordance": "florping", "context": "quux"}
words = st.builds(
    lambda role, ending: NewWord(f"{ending}{ROLES[role]}", role, ROLES[role]),
    st.sampled_from(sorted(ROLES)),
    st.sampled_from(["", "b", "tr"]),
)
shuffled = st.lists(words, max_size=6).flatmap(
    lambda learned: st.tuples(st.just(learned), st.permutations(learned))
)
SENTENCES = ("zorps are used for florping", "to quux a zorp grab it by the blick", "pass the bzorp")


@settings(max_examples=25)
@given(shuffled)
def test_the_order_of_learning_does_not_matter(
    language: Language, orders: tuple[list[NewWord], list[NewWord]]
) -> None:
    """Whoever learned the same words understands the same."""
    one, other = map(language.with_words, orders)

    for text in SENTENCES:
        assert one.understand(text).as_json() == other.understand(text).as_json()


@settings(max_examples=25)
@given(st.lists(words, max_size=6), words)
def test_to_learn_a_word_again_changes_nothing(
    language: Language, learned: list[NewWord], word: NewWord
) -> None:
    """A language that has all words is returned as it is."""
    taught = language.with_words([*learned, word])

    assert taught.with_words([word]) is taught
    assert taught.with_words(learned) is taught
    assert list(language.lexicon.learned) == []


@given(st.lists(words, max_size=3), st.lists(words, max_size=3), st.lists(words, max_size=3))
def test_each_language_has_its_own_words(
    language: Language, first: list[NewWord], second: list[NewWord], third: list[NewWord]
) -> None:
    """Two languages made from the same one share nothing but what it has."""
    known = language.with_words(first)

    known.with_words(second)
    known.with_words(third)

    assert known.lexicon.learned == language.with_words(first).lexicon.learned
    assert {*known.with_words(second).lexicon.learned} == {(w.role, w.word) for w in first + second}


def test_thousands_of_words_are_learned_one_by_one(language: Language) -> None:
    """There is no limit to how often a language grows."""
    taught = language
    for number in range(3000):
        name = "zorp" + "".join(chr(97 + int(digit)) for digit in str(number))
        taught = taught.with_words([NewWord(name, "object", name)])

    assert len(taught.lexicon.learned) == 3000
    assert taught.understand("a zorpcjjj is used for cutting").new_words == ()


def test_a_word_has_all_its_roles(language: Language) -> None:
    """A saw, sawing and the saw of a knife are three things."""
    taught = language.with_words(
        NewWord(word, role, word)
        for word, role in (("zorp", "object"), ("zorping", "affordance"), ("zorp", "part"))
    )

    for text, meaning in (
        ("a zorp is used for zorping", {"object": "zorp", "affordance": "zorping"}),
        ("to pass a knife grab it by the zorp", {"object": "knife", "part": "zorp"}),
        ("to pass a zorp grab it by the zorp", {"object": "zorp", "part": "zorp"}),
    ):
        understood = taught.understand(text)
        assert meaning.items() <= understood.meaning.as_json().items()
        assert understood.new_words == ()

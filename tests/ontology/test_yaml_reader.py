"""YAML is read with positions, and mistakes are reported with theirs."""

from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import MAX_DEPTH, YamlNode, parse_yaml, read_yaml

plain = st.recursive(
    st.none() | st.booleans() | st.integers(-1000, 1000) | st.text("abc xyz", max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("kmn", min_size=1), inner),
    max_leaves=20,
)


def without_positions(node: YamlNode) -> object:
    """The plain data of a node."""
    match node.value:
        case tuple() as items:
            return [without_positions(each) for each in items]
        case dict() as fields:
            return {key: without_positions(each) for key, each in fields.items()}
        case value:
            return value


@given(plain)
def test_plain_data_reads_back_as_written(value: object):
    """YAML without tags is read as plain data."""
    text = yaml.safe_dump(value)

    assert without_positions(parse_yaml(text)) == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "<text>: the file is empty."),
        ("a: 1\na: 2", '<text>:2:1: the key "a" is given twice.'),
        ("a: &x [1]\nb: *x", "<text>:2:4: aliases are not allowed."),
        ("a: [1", "<text>:2:1: is not YAML: did not find expected ',' or ']'."),
        ("a: !!python/name:os.system x", '<text>:1:4: the type "tag:yaml.org,2002:python/name'),
        ("a: 2026-11-21", '<text>:1:4: the type "tag:yaml.org,2002:timestamp" is not allowed'),
        ("yes: 1", "<text>:1:1: expected a text, found True."),
        ("[" * (MAX_DEPTH + 2), f"<text>:1:{MAX_DEPTH + 1}: nested too deeply."),
    ],
)
def test_yaml_beyond_plain_data_is_refused_with_its_position(text: str, message: str):
    """The error has line and column."""
    with pytest.raises(DataError) as caught:
        parse_yaml(text)

    assert str(caught.value).startswith(message)


def test_unknown_key_is_refused_with_a_suggestion():
    """The error has the position of the key, the most similar key and the known ones."""
    field = parse_yaml("name: knife\nmas: 0.1")

    with pytest.raises(DataError, match=r'2:1: unknown key "mas" \(did you mean "mass"\?\); expe'):
        field.entries(required={"name", "mass"}, optional=())


def test_missing_key_is_refused():
    """The error lists the keys that were found."""
    with pytest.raises(DataError, match='the key "mass" is missing; found name'):
        parse_yaml("name: knife").entries(required={"name", "mass"})


@pytest.mark.parametrize(
    ("text", "ask", "message"),
    [
        ("-1", lambda f: f.number(low=0, high=1), r"expected a number in \[0, 1\], found -1"),
        ("x", lambda f: f.number(), 'expected a number in .*, found "x"'),
        ("true", lambda f: f.integer(), "expected a whole number, found True"),
        ("1.5", lambda f: f.integer(), "expected a whole number, found 1.5"),
        ("[1, 2]", lambda f: f.numbers(count=3), "expected 3 numbers, found 2"),
        ("gren", lambda f: f.text(choices={"green"}), r'did you mean "green"\?'),
        ("{}", lambda f: f.items(), "expected a list, found a mapping"),
        ("[]", lambda f: f.entries(), "expected a mapping, found a list"),
        ("~", lambda f: f.text(), "expected a text, found nothing"),
        ("1", lambda f: f.truth(), "expected true or false, found 1"),
    ],
)
def test_value_of_another_type_is_refused(text: str, ask, message: str):
    """The error has what was expected and what was found."""
    with pytest.raises(DataError, match=message):
        ask(parse_yaml(text))


def test_file_that_is_not_utf8_is_refused(tmp_path: Path):
    """A file in another encoding gives a data error."""
    path = tmp_path / "bad.yaml"
    path.write_bytes(b"a: \xff\xfe")

    with pytest.raises(DataError, match="expected UTF-8 text; byte 3 is not"):
        read_yaml(path)


def test_missing_file_is_refused(tmp_path: Path):
    """The error names the file."""
    with pytest.raises(DataError, match=r"none\.yaml: cannot be read: No such file"):
        read_yaml(tmp_path / "none.yaml")


def test_excerpt_points_at_the_column():
    """The caret is under the position of the syntax error."""
    with pytest.raises(DataError) as caught:
        parse_yaml("a: 1\nb: ]")

    assert caught.value.excerpt() == "b: ]\n   ^"

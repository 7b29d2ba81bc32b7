"""Facts of a table: what is said, stored and decided."""

from pathlib import Path

import pytest

from hilt.agent.evaluation.experiments.facts import Fact, FactsExperiment, read_facts
from hilt.kb import Interval, functional
from hilt.ontology.errors import DataError

SAMPLE = Path(__file__).parents[4] / "examples" / "facts.tsv"


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """A file that a test writes."""
    return tmp_path / "facts.tsv"


@pytest.mark.parametrize(
    ("share", "word"), [(1, "generally"), (0.7, "often"), (0.3, "occasionally"), (0.01, "never")]
)
def test_a_share_is_said_with_the_nearest_word(share: float, word: str):
    """The words are those of Table 2, and never."""
    assert Fact("mug", "drinking", share).sentence == f"a mug is {word} used for drinking"


def test_a_rule_states_a_fact_only_if_all_of_it_is_the_same():
    """Object, use, material and degree."""
    fact = Fact("knife", "cutting bread", 0.75)
    often = Interval(0.75, 1)

    assert fact.is_stated_by(functional("knife", "cutting", material="bread", interval=often))
    assert not fact.is_stated_by(functional("knife", "cutting", interval=often))
    assert not fact.is_stated_by(functional("saw", "cutting", material="bread", interval=often))
    assert not fact.is_stated_by(
        functional("knife", "cutting", material="bread", interval=Interval(0.5, 1))
    )


def test_sample_is_stored_as_said_and_decided_by():
    """The sample has objects and uses that Hilt does not know."""
    experiment = FactsExperiment(file=str(SAMPLE), scenes=30)

    results = [experiment.run(case) for case in experiment.cases()]

    assert [(result.key, result.found) for result in results if not result.right] == []
    assert experiment.summary(results) == {
        "facts": {"as said": len(read_facts(SAMPLE))},
        "decisions": {"all": 30, "right": 30},
    }


def test_what_is_not_understood_is_reported_as_refused(table: Path):
    """A row that Hilt does not take for a use is not stored, and counts as wrong."""
    table.write_text("object\tuse\tshare\nmug\tof of\t1\n", encoding="utf-8")
    experiment = FactsExperiment(file=str(table), scenes=0)

    (result,) = [experiment.run(case) for case in experiment.cases()]

    assert (result.right, result.found) == (False, "refused")


@pytest.mark.parametrize("row", ["mug\tdrinking\t1.5", "mug\tdrinking\tmany", "mug\t\t1", "mug"])
def test_a_wrong_row_is_an_error_with_its_line(table: Path, row: str):
    """A share outside [0, 1], or a missing column."""
    table.write_text(f"object\tuse\tshare\nmug\tdrinking\t1\n{row}\n", encoding="utf-8")

    with pytest.raises(DataError, match=r"facts\.tsv:3"):
        read_facts(table)

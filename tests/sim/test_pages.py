"""What the pages about scenes and episodes show can be read."""

import re
from pathlib import Path

from hilt.kb.knowledge_base import KnowledgeBase
from hilt.ontology.objects import load_household
from hilt.sim.scene.scene import parse_scene

DOCS = Path(__file__).parents[2] / "docs"


def blocks(page: str, language: str) -> list[str]:
    """The blocks of a language on a page."""
    text = (DOCS / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


def test_examples_of_the_page_are_valid(tmp_path: Path):
    """The scene and the object of the page are a scene and an object."""
    scene, mine = blocks("objects.md", "yaml")
    for name, text in (("scene.yaml", scene), ("mine.yaml", mine)):
        (tmp_path / name).write_text(text, encoding="utf-8")

    objects = load_household(tmp_path / "mine.yaml", added_to=load_household()).objects
    read = parse_scene(str(tmp_path / "scene.yaml"), seed=0, objects=objects)

    assert objects["rolling pin"].mass > 0.4
    assert len(read.placements) == 3 + 4 + 1  # what is listed, the clutter, the block


def test_question_of_the_page_is_answered():
    """The SPARQL text is one that a base understands."""
    (question,) = blocks("episodes.md", "sparql")

    with KnowledgeBase.open("memory:") as base:
        assert list(base.select(question)) == []

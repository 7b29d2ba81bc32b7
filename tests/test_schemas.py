"""The JSON Schemas of the YAML formats say what the readers of Hilt say."""

import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator
from referencing import Registry, Resource

from hilt.agent.config import AgentConfig
from hilt.agent.evaluation.experiments.custom import load_custom
from hilt.inference.settings import Settings
from hilt.kb.formats.rule_yaml import read_sheet
from hilt.nlu import Language
from hilt.ontology.actions import load_actions
from hilt.ontology.errors import HiltError
from hilt.ontology.objects import load_household
from hilt.sim import load_robots, parse_scene

ROOT = Path(__file__).parents[1]
SCHEMAS = {
    path.name.partition(".")[0]: json.loads(path.read_text(encoding="utf-8"))
    for path in sorted((ROOT / "docs" / "schemas").iterdir())
}
REGISTRY: Registry[Any] = Registry().with_resources(
    [(f"{name}.schema.json", Resource.from_contents(each)) for name, each in SCHEMAS.items()]
)
WRONG = yaml.safe_load(Path(__file__).with_name("wrong_files.yaml").read_text(encoding="utf-8"))
SHIPPED = {
    "objects": ["ontology/objects.yaml"],
    "actions": ["ontology/actions.yaml", "examples/kitchen_actions.yaml"],
    "rules": ["examples/kitchen_rules.yaml"],
    "robots": ["sim/robot/robots.yaml"],
    "settings": ["ontology/settings.yaml"],
    "experiment": ["examples/experiment.yaml"],
    "lexicon": [
        f"ontology/english/{name}.yaml"
        for name in ("lexicon", "constructions", "clauses", "attitudes", "requests", "conversation")
    ],
}
BLOCKS = {  # the YAML blocks of each page, in order
    "objects.md": ["scene", "objects"],
    "actions.md": ["actions"],
    "robot.md": ["robots"],
    "words.md": ["lexicon", "lexicon"],
    "files.md": ["rules"],
    "norms.md": ["rules"],
}
READERS: dict[str, Callable[[Path], object]] = {
    "objects": lambda path: load_household(path, added_to=load_household()),
    "scene": lambda path: parse_scene(str(path), seed=0, objects=load_household().objects),
    "actions": lambda path: load_actions(path, added_to=load_actions()),
    "rules": lambda path: list(read_sheet(path.read_text(encoding="utf-8"), source=str(path))),
    "robots": load_robots,
    "settings": Settings.load,
    "options": AgentConfig.from_yaml,
    "lexicon": lambda path: Language.load(extra_lexicon=path),
    "experiment": load_custom,
}


@cache
def validator(name: str) -> Draft202012Validator:
    """What checks values against a schema."""
    return Draft202012Validator(SCHEMAS[name], registry=REGISTRY)


def mistakes(name: str, text: str) -> list[str]:
    """What a schema says against a file."""
    return [
        f"{e.json_path}: {e.message}" for e in validator(name).iter_errors(yaml.safe_load(text))
    ]


@pytest.mark.parametrize("name", SCHEMAS)
def test_schema_is_one(name: str):
    """Each schema keeps to the standard, and says what each key is."""
    Draft202012Validator.check_schema(SCHEMAS[name])

    assert all(each.get("description") for each in SCHEMAS[name].get("properties", {}).values())


@pytest.mark.parametrize(("name", "path"), [(n, p) for n, each in SHIPPED.items() for p in each])
def test_shipped_file_keeps_to_its_schema(name: str, path: str):
    """What Hilt comes with is as the schemas say."""
    assert mistakes(name, (ROOT / path).read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")), ids=lambda path: path.name)
def test_blocks_of_pages_keep_to_their_schemas(page: Path):
    """What a page shows as YAML is as the schemas say."""
    blocks = re.findall(r"^```yaml\n(.*?)^```", page.read_text("utf-8"), flags=re.DOTALL | re.M)

    names = BLOCKS.get(page.name, [])
    assert len(names) == len(blocks)
    assert [mistakes(*pair) for pair in zip(names, blocks, strict=True)] == [[]] * len(blocks)


@pytest.mark.parametrize(("name", "text"), [(n, t) for n, each in WRONG.items() for t in each])
def test_wrong_file_is_refused_by_schema_and_reader(name: str, text: str, tmp_path: Path):
    """A mistake that an editor shows is one that Hilt reports."""
    path = tmp_path / "wrong.yaml"
    path.write_text(text, encoding="utf-8")

    assert mistakes(name, text) != []
    with pytest.raises(HiltError):
        READERS[name](path)


PROBES = {  # where in a schema the keys are, and a file that has another key there
    ("objects", ""): "x: 1",
    ("objects", "$defs/object"): "objects: {plank: {x: 1}}",
    ("objects", "$defs/part"): "objects: {plank: {is_a: tool, rests: {}, parts: {body: {x: 1}}}}",
    ("scene", ""): "x: 1",
    ("scene", "properties/objects/items/anyOf/1"): "objects: [{x: 1}]",
    ("actions", ""): "x: 1",
    ("actions", "$defs/tree"): "trees: {wave: {x: 1}}",
    ("rules", ""): "x: 1",
    ("rules", "$defs/rule"): "rules: [{x: 1}]",
    ("robots", "$defs/robot"): "arm: {x: 1}",
    ("settings", ""): "x: 1",
    ("settings", "properties/threshold"): "threshold: {x: 1}",
    ("options", ""): "x: 1",
    ("lexicon", ""): "x: 1",
    ("lexicon", "properties/verbs/items"): "verbs: [{x: 1}]",
    ("lexicon", "properties/words/items"): "words: [{x: 1}]",
    ("experiment", ""): "x: 1",
}


@pytest.mark.parametrize(("place", "text"), PROBES.items(), ids=str)
def test_schema_lists_the_keys_of_the_reader(place: tuple[str, str], text: str, tmp_path: Path):
    """An editor completes exactly the keys that Hilt expects there."""
    name, pointer = place
    node: Any = SCHEMAS[name]
    for step in filter(None, pointer.split("/")):
        node = node[int(step) if isinstance(node, list) else step]
    path = tmp_path / "probe.yaml"
    path.write_text(text, encoding="utf-8")

    with pytest.raises(HiltError) as told:
        READERS[name](path)

    (expected,) = re.findall(r'unknown key "x".*; expected ([^.]*)\.', str(told.value))
    assert sorted(node["properties"]) == sorted(expected.split(", "))


def test_every_schema_meets_a_wrong_file():
    """No schema accepts everything."""
    assert WRONG.keys() == SCHEMAS.keys() == READERS.keys()

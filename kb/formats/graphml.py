"""Rules as a networkx graph and as GraphML: atoms are nodes, each rule is an edge between them.

An edge leads from each feature of a rule to its argument, with all that the rule says as
attributes; the id of the rule is its key. A rule without features starts at its contexts, one
without an argument ends at a node for its functor. All attributes are plain texts and numbers, so
that GraphML and other tools carry them, and the rules can be read back.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from ...ontology.errors import DataError, HiltError
from ..rule import Rule
from . import value_notation
from .value_notation import COLUMNS

if TYPE_CHECKING:
    from networkx import MultiDiGraph

_OPTIONAL = frozenset({"speaker", "status", "time"})


def graph_of(rules: Iterable[Rule]) -> MultiDiGraph[str]:
    """Return the graph of rules.

    >>> from hilt.kb import Interval, grasping
    >>> graph = graph_of([grasping("knife", "blade", "pass", interval=Interval(0.95, 1))])
    >>> [(a, b, data["lower"]) for a, b, data in graph.edges(data=True)]
    [('object:knife', 'part:blade', 0.95)]

    Nodes have `kind` and `name`; edges have `rule`, `label`, `functor`, `argument`, `features`,
    `contexts`, `lower`, `upper`, `speaker`, `status` and `time`.
    """
    import networkx as nx  # half a second to import

    graph: MultiDiGraph[str] = nx.MultiDiGraph()
    for rule in rules:
        end = str(rule.argument) if rule.argument else f"functor:{rule.functor}"
        attributes = _attributes(rule)
        for start in sorted(rule.features or rule.contexts):
            graph.add_node(str(start), kind=start.kind, name=start.name)
            graph.add_node(end, kind=end.partition(":")[0], name=end.partition(":")[2])
            graph.add_edge(str(start), end, key=rule.id, **attributes)
    return graph


def rules_of_graph(graph: MultiDiGraph[str], *, source: str = "<graph>") -> Iterator[Rule]:
    """Iterate over the rules of the edges of a graph, each rule once.

    DataError if an edge lacks an attribute of a rule; `source` names the graph.
    """
    seen: set[str] = set()
    for start, end, attributes in graph.edges(data=True):
        try:
            rule = _rule(attributes)
        except (HiltError, KeyError, TypeError, ValueError) as error:
            problem = f"it has no {error}." if isinstance(error, KeyError) else str(error)
            raise DataError(f"the edge {start} -> {end}: {problem}", source=source) from error
        if rule.id not in seen:
            seen.add(rule.id)
            yield rule


def write_graphml(rules: Iterable[Rule]) -> bytes:
    """Return the graph of rules as GraphML."""
    import networkx as nx

    target = io.BytesIO()
    nx.write_graphml_xml(graph_of(rules), target, named_key_ids=True, edge_id_from_attribute=None)
    return target.getvalue()


def read_graphml(text: bytes, *, source: str) -> Iterator[Rule]:
    """Iterate over the rules of a GraphML text with the attributes that `write_graphml` writes.

    DataError if it is no GraphML, or an edge lacks an attribute of a rule.
    """
    import networkx as nx

    try:
        graph: Any = nx.read_graphml(io.BytesIO(text), force_multigraph=True)
    except Exception as error:  # the reader raises whatever its XML parser does
        raise DataError(f"is no GraphML: {error}.", source=source) from error
    yield from rules_of_graph(graph, source=source)


def _attributes(rule: Rule) -> dict[str, str | float]:
    texts = dict(zip(COLUMNS, value_notation.write_texts(rule, bare=False), strict=True))
    said = {key: texts.pop(key) for key in ("functor", "argument")}  # these come first in files
    bounds = {"lower": rule.interval.lower, "upper": rule.interval.upper}
    return {"rule": rule.id, "label": str(rule.interval), **said, **texts, **bounds}


def _rule(found: Mapping[str, Any]) -> Rule:
    given = {key: value for key, value in found.items() if value is not None}
    given = {**dict.fromkeys(_OPTIONAL, ""), **given}
    return value_notation.read_rule([str(given[key]) for key in COLUMNS])

"""Rules of every form, for laws that hold for all of them."""

from __future__ import annotations

from hypothesis import strategies as st

from hilt.kb.interval import Interval
from hilt.kb.rule import Atom, Rule, functional, grasping, norm

words = st.sampled_from(["knife", "wine glass", "mug", "salad spoon", "o'clock", "crêpe", "t-bar"])
chances = st.integers(0, 1_000_000).map(lambda millionths: millionths / 1_000_000)
intervals = st.tuples(chances, chances).map(lambda pair: Interval(min(pair), max(pair)))
speakers = st.sampled_from(["sam", "anna", "Dr. Müller"])
contexts = st.sampled_from(["pass", "pickUp", "use"])

functional_rules = st.builds(
    functional, words, st.sampled_from(["cutting", "holding water"]), interval=intervals,
    material=st.none() | st.sampled_from(["bread", "tent peg"]),
    properties=st.lists(st.just("red"), max_size=1), speaker=speakers,
)  # fmt: skip
grasping_rules = st.builds(
    grasping, words, st.sampled_from(["blade", "top rim"]), st.none() | contexts,
    interval=intervals, speaker=speakers,
)  # fmt: skip
general_rules = st.builds(
    Rule,
    st.frozensets(st.builds(Atom, st.sampled_from(["object", "property"]), words), min_size=1),
    st.frozensets(
        st.builds(Atom, st.just("action"), contexts) | st.builds(Atom, st.just("place"), words)
    ),
    st.sampled_from(["moveTo", "cutWith"]),
    st.none() | st.builds(Atom, st.sampled_from(["place", "part", "affordance"]), words),
    intervals,
    speakers,
)
norms = st.builds(
    norm, st.sampled_from(["forbidden", "permitted"]), contexts, words | st.just("*"),
    st.none() | st.builds(Atom, st.just("part"), words), interval=intervals, speaker=speakers,
    contexts=st.lists(st.builds(Atom, st.sampled_from(["role", "place"]), words), max_size=2),
    properties=st.lists(st.just("hot"), max_size=1),
)  # fmt: skip
rules = functional_rules | grasping_rules | norms | general_rules

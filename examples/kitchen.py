# SPDX-License-Identifier: Apache-2.0
"""Rules of the general form and actions of one's own, from two files to what the robot would do.

`kitchen_rules.yaml` concludes cutWith(X, bread) from several antecedents; `kitchen_actions.yaml`
has the trees "cut", "stir" and "serve". Run: python examples/kitchen.py
"""

from pathlib import Path

from hilt.agent import Agent
from hilt.inference.explanation import explain_choice
from hilt.kb import Interval
from hilt.kb.formats.transfer import import_file
from hilt.kb.rule import Atom

HERE = Path(__file__).parent
KITCHEN, CHILD = Atom("place", "kitchen"), Atom("role", "child")
SAID = (
    "cut the bread",
    "cut the mug",
    "stir the mug",
    "To pass a knife grab it by the blade",
    "serve the knife",
)


def converse(contexts: dict[Atom, Interval]) -> None:
    """Say all sentences where these contexts hold, and prove the first decision."""
    print(f"--- {', '.join(f'{atom} {sure}' for atom, sure in contexts.items()) or 'anywhere'}")
    actions = HERE / "kitchen_actions.yaml"
    with Agent.open("memory:", simulate=False, actions=actions, contexts=contexts) as agent:
        import_file(agent.base, HERE / "kitchen_rules.yaml")
        for sentence in SAID:
            reply = agent.hear(sentence)
            print(f"sam: {sentence}\nhilt: {reply.said}")
            if sentence == SAID[0] and reply.achievement and reply.achievement.decision:
                print(explain_choice(reply.achievement.decision.object))


def main() -> None:
    """The same sentences anywhere, and in what is probably a kitchen with a child in it."""
    converse({})
    converse({KITCHEN: Interval(0.9, 1.0), CHILD: Interval(1.0, 1.0)})


if __name__ == "__main__":
    main()

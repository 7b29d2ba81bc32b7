"""Rules of the general form and actions of one's own, from two files to what the robot would do.

`kitchen_rules.yaml` concludes cutWith(X, bread) from several antecedents; `kitchen_actions.yaml`
has the trees "cut", "stir" and "serve". Run: python examples/kitchen.py
"""

from pathlib import Path

from hilt.agent import Agent, AgentConfig
from hilt.kb.formats.import_export import import_file

HERE = Path(__file__).parent
SAID = (
    "cut the bread",
    "cut the mug",
    "stir the mug",
    "To pass a knife grab it by the blade",
    "serve the knife",
)


def converse(*contexts: str) -> None:
    """Say all sentences where these contexts hold, and prove the first decision."""
    print(f"--- {', '.join(contexts) or 'anywhere'}")
    actions = HERE / "kitchen_actions.yaml"
    config = AgentConfig(simulate=False, actions=actions, contexts=contexts)
    with Agent.open("memory:", config) as agent:
        import_file(agent.base, HERE / "kitchen_rules.yaml")
        for sentence in SAID:
            reply = agent.hear(sentence)
            print(f"sam: {sentence}\nhilt: {reply.said}")
            if sentence == SAID[0] and reply.result and reply.result.decision:
                for proof in reply.result.decision.proofs():
                    print("\n".join(proof.lines()))


def main() -> None:
    """The same sentences anywhere, and in what is probably a kitchen with a child in it."""
    converse()
    converse("place:kitchen=0.9", "role:child")


if __name__ == "__main__":
    main()

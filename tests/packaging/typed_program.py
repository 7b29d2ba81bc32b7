"""A program of a user: it teaches, asks, decides and looks into the base, with types."""

from hilt import __version__
from hilt.agent import Agent, AgentConfig, Reply
from hilt.inference import Affordances, Goal, Inference, Observation, Target
from hilt.kb import Atom, Interval, KnowledgeBase, Rule
from hilt.nlu import Language, Understanding
from hilt.ontology import HiltError, ObjectType, load_objects
from hilt.sim import Scene, parse_scene

LESSONS = ("A knife is used for cutting", "To pass a knife grab the knife by the blade")


def teach(agent: Agent) -> list[Reply]:
    """Tell the agent all lessons."""
    return [agent.hear(lesson, speaker="sam") for lesson in LESSONS]


def decide(base: KnowledgeBase, types: tuple[str, ...]) -> Inference:
    """Infer which of the objects seen to pass."""
    seen = [Observation(name, name, {Atom("object", name): Interval(0.9, 1)}) for name in types]
    return Affordances(base).infer(
        "pass/findObject", Goal("pass", Target(used_for="cutting")), seen
    )


def understand(text: str) -> str:
    """Return the meaning of a text, in the notation of the predicates."""
    understood: Understanding = Language.load().understand(text)
    return understood.pragmatics


def main() -> None:
    """Print what Hilt does with the lessons."""
    objects: dict[str, ObjectType] = dict(load_objects())
    scene: Scene = parse_scene("objects:knife,mug", seed=7, objects=objects)
    config = AgentConfig(scene="objects:knife,mug", simulate=False)
    with Agent.open("memory:", config) as agent:
        replies = teach(agent)
        rules: list[Rule] = agent.base.rules(object="knife")
        best = decide(agent.base, scene.types).best
        passed = agent.hear("pass me something used for cutting", speaker="sam")
    print(
        f"Hilt {__version__}: {sum(reply.is_done for reply in replies)} lessons, {len(rules)} rules"
    )
    print(best.name if best else "nothing")
    print(passed.said)
    print(understand(LESSONS[0]))
    try:
        parse_scene("objects:brick", seed=7, objects=objects)
    except HiltError as error:
        print(error)


if __name__ == "__main__":
    main()

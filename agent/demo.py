"""The paper's running example (section 3): three sentences, and a knife is passed by the blade."""

from collections.abc import Generator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.panel import Panel
from rich.text import Text

from .agent import Agent
from .dialogue.reply import Reply
from .execution.outcome import Json, WalkStep
from .presentation import console as shown

LESSONS = (
    "A knife is used for cutting",
    "To pickup a knife grab the knife by the handle",
    "To pass a knife grab the knife by the blade",
)
COMMAND = "pass me something used for cutting"
PICTURED = {"graspObject": "grasp", "handOver": "hand-over", "pointAt": "pointing"}
AFTERWARDS = ("pick up the knife", "pass me something used for rolling")


@dataclass(frozen=True)
class ExampleReplies:
    """The replies of the running example: to three sentences, a command, and the two after it."""

    lessons: tuple[Reply, ...]
    commands: tuple[Reply, ...]
    simulate: bool

    @property
    def is_as_told(self) -> bool:
        """Whether every result is that of the paper."""
        results = [reply.result for reply in self.commands if reply.result]
        parts = [each.decision.chosen_part for each in results if each.decision]
        touched = [each.world.touched for each in results]
        as_decided = not self.simulate or touched == [("blade",), ("handle",), ()]
        endings = [reply.ending for reply in self.commands]
        decided = parts == ["blade", "handle", None]
        return decided and as_decided and endings == ["done", "done", "failed"]

    def as_json(self) -> Json:
        """As `hilt demo --json` prints it."""
        return {
            "tell": [reply.as_tell_json() for reply in self.lessons],
            "do": [reply.as_do_json() for reply in self.commands],
            "as_told": self.is_as_told,
        }


def run(agent: Agent, progress: Console, folder: Path) -> ExampleReplies:
    """Run the example and write its pictures."""
    replies: list[Reply] = []
    for text in (*LESSONS, COMMAND, *AFTERWARDS):
        recorded = _recorded(agent, folder) if text == COMMAND and agent.simulate else nullcontext()
        with progress.status(Text(text)), recorded as pictures:
            reply = agent.hear(text)
        replies.append(reply.with_pictures(*pictures) if pictures else reply)
    told = len(LESSONS)
    return ExampleReplies(tuple(replies[:told]), tuple(replies[told:]), agent.simulate)


def show(example: ExampleReplies, out: Console, agent: Agent) -> None:
    """Print the dialogue, the rules, the executions and the decisions."""
    out.print(Panel("Teaching", style="cyan", expand=False))
    for reply in example.lessons:
        out.print(shown.turn(reply))
    out.print(shown.rules(rule for reply in example.lessons for rule in reply.rules))
    for reply in example.commands:
        out.print(Panel(reply.text, style="cyan", expand=False))
        out.print(shown.turn(reply))
        if reply.result:
            out.print(shown.goal_result(reply.result, agent.quote))
            for picture in reply.result.world.pictures:
                out.print(f"wrote {picture}", markup=False)


@contextmanager
def _recorded(agent: Agent, folder: Path) -> Generator[list[str]]:
    files = [str(agent.body.picture(folder / "before.png"))]

    def keep(step: WalkStep) -> None:
        name = PICTURED.get(step.node.rsplit("/", 1)[-1])
        if name and step.action == "executed":
            files.append(str(agent.body.picture(folder / f"{name}.png")))

    agent.goals.watchers.append(keep)
    try:
        with agent.filmed(folder / "animation.gif"):
            yield files
    finally:
        agent.goals.watchers.remove(keep)
    files.append(str(folder / "animation.gif"))

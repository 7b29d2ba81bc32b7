"""Films of what the robot does: what is written, tinted and drawn in them."""

from pathlib import Path

import pytest
from PIL import Image

from hilt.agent.agent import Agent
from hilt.agent.cli import main
from hilt.agent.config import AgentConfig
from hilt.agent.presentation.video import LEGEND
from hilt.sim.media.pictures import ACCEPTED, CHOSEN, REJECTED, Pen
from hilt.sim.media.recording import WorldRecorder

pytestmark = pytest.mark.sim


def test_film_says_what_the_robot_thinks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Utterance, nodes, constraint and interval are below; the part is tinted, grasps are drawn."""
    taken: list[tuple[str, tuple[str, str] | None, set[Pen]]] = []

    def take(recorder: WorldRecorder, at: object = None) -> None:
        kinds = {pen for pen, grasps in recorder.grasps.items() if grasps}
        taken.append((recorder.caption, recorder.tint, kinds))

    monkeypatch.setattr(WorldRecorder, "take", take)
    monkeypatch.setattr(WorldRecorder, "_write", lambda _: None)
    with Agent.open("memory:", AgentConfig(scene="objects:knife", seed=3)) as agent:
        agent.hear("To pass a knife grab the knife by the blade")
        with agent.filmed(tmp_path / "out.gif"):
            reply = agent.hear("pass me the knife")

    told = '"pass me the knife"\npass/graspObject: knife by the blade [0.90, 1.00]'
    every_kind = {ACCEPTED, CHOSEN, REJECTED}
    assert (f"{told}\n{LEGEND}", ("knife", "blade"), every_kind) in taken
    assert ('"pass me the knife"\npass/findObject: knife [0.95, 1.00]', None, set()) in taken
    assert taken[-1] == (f'"pass me the knife"\n{reply.said}', None, set())


def test_command_is_filmed_into_one_file(tmp_path: Path, capfd: pytest.CaptureFixture[str]):
    """`hilt do --record` writes the strip, and names it among the pictures."""
    out = tmp_path / "new" / "out.png"

    with pytest.raises(SystemExit) as ended:
        main([
            "do", "point to the knife", "--kb", "memory:", "--scene", "objects:knife",
            "--record", str(out), "--json",
        ])  # fmt: skip

    assert ended.value.code == 0
    assert str(out) in capfd.readouterr().out
    with Image.open(out) as picture:
        assert picture.size[0] == 4 * 480


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (("--record", "out.avi"), "expected a file ending in .gif, .mp4, .png"),
        (("--record", "/proc/out.gif"), "cannot be written"),
        (("--record", "out.gif", "--no-sim"), "Leave out --no-sim"),
    ],
)
def test_what_cannot_be_filmed_is_told_at_once(
    arguments: tuple[str, ...], problem: str, capfd: pytest.CaptureFixture[str]
):
    """Wrong usage is one line on stderr and exit code 2, before anything moves."""
    with pytest.raises(SystemExit) as ended:
        main(["do", "pick up the knife", "--kb", "memory:", "--scene", "objects:knife", *arguments])

    said = capfd.readouterr()
    assert (ended.value.code, said.out) == (2, "")
    assert problem in said.err

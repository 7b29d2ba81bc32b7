"""Teaching, commanding and watching: the page of a service with a robot."""

import gzip
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from hilt.agent.web.server import STATIC

from ..running_service import RunningService, end, start
from .conftest import Visit
from .driving import COMMAND, LESSONS, Visitor

pytestmark = pytest.mark.sim
ROOT = Path(__file__).parents[4]
PICTURES = ROOT / "out" / "page"
MOST_FIRST, MOST_SCENE = 400_000, 1_000_000  # bytes, compressed


@pytest.fixture(scope="module")
def pictures() -> Path:
    """Where pictures for people go."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    return PICTURES


def wait_for_scene(visitor: Visitor) -> None:
    """Wait until the scene is drawn, and shows the newest frame."""
    visitor.wait_for('html[data-scene="drawn"]')


def test_knife_is_seen_passed_by_the_blade(robot: RunningService, visit: Visit, pictures: Path):
    """Three sentences and a command, typed: the tree lights up, and the arm holds the blade."""
    visitor = visit(robot)
    wait_for_scene(visitor)
    learned = [visitor.say(lesson) for lesson in LESSONS]
    before = visitor.stage()

    visitor.begin(COMMAND)
    visitor.wait_for('[data-node="pass/graspObject"][data-state="reached"]')
    visitor.wait_for('[data-node="pass/handOver"][data-state="reached"]')
    visitor.wait_for('[data-node="pass/handOver"][data-state="done"]')
    visitor.wait_for('html[data-moving="false"]')
    answer = visitor.wait_for('.turn[data-sequence="4"] .bubble.hilt > p').inner_text()

    assert all(each.startswith("I learned") for each in learned)
    assert "knife" in answer and "by the blade" in answer
    assert visitor.wait_for(".touched").inner_text() == "The hand touched: blade"
    visitor.page.screenshot(path=pictures / "wide.png")
    changed = np.abs(visitor.stage() - before).max(axis=2) > 40
    assert changed.mean() > 0.01
    assert visitor.ask_api("episodes")[-1]["decision"]["part"] == "blade"


def test_page_looks_alike_at_every_size(robot: RunningService, visit: Visit, pictures: Path):
    """Light and wide, dark and of a tablet, narrow as a telephone; nothing is cut off sideways."""
    sizes = {
        "tablet_dark": {"viewport": {"width": 1024, "height": 768}, "color_scheme": "dark"},
        "narrow": {"viewport": {"width": 400, "height": 800}},
    }
    for name, options in sizes.items():
        visitor = visit(robot, **options)
        if name == "narrow":
            visitor.page.get_by_role("button", name="Scene").click()
        else:
            visitor.show("rules")
            visitor.wait_for(".graph-canvas canvas")
        wait_for_scene(visitor)
        visitor.page.screenshot(path=pictures / f"{name}.png")

        width = visitor.page.evaluate("document.documentElement.scrollWidth")
        assert width == options["viewport"]["width"]


def test_page_and_scene_are_small(robot: RunningService, visit: Visit):
    """The files of the first load take at most 400 kB compressed, the arm and all 1 MB."""
    visitor = visit(robot)
    wait_for_scene(visitor)
    loaded = visitor.page.evaluate("performance.getEntriesByType('resource').map(e => e.name)")
    names = [name.partition("/static/")[2] for name in loaded if "/static/" in name]
    scene = visitor.page.request.get(next(name for name in loaded if "scene.glb" in name))

    files = {name: len(gzip.compress((STATIC / name).read_bytes())) for name in {*names}}

    first = sum(size for name, size in files.items() if "viewer" not in name)
    assert 0 < first < MOST_FIRST
    assert len(gzip.compress(scene.body())) < MOST_SCENE


def test_new_table_is_shown(robot: RunningService, visit: Visit):
    """Another table has other things on it, and the picture follows."""
    visitor = visit(robot)
    wait_for_scene(visitor)
    before = visitor.wait_for("canvas").get_attribute("aria-label")

    visitor.page.get_by_role("button", name="New table").click()
    visitor.wait_until("before => document.querySelector('canvas').ariaLabel !== before", before)

    assert "hammer" in visitor.wait_for("canvas").get_attribute("aria-label")
    assert "hammer" in [each["name"] for each in visitor.ask_api("scene")["things"]]


@pytest.fixture
def pupil(tmp_path: Path) -> Iterator[RunningService]:
    """A service with learned eyes, at a table with something that they do not know."""
    scene = str(ROOT / "examples" / "unknown_thing.yaml")
    started = start(tmp_path / "kb", "--scene", scene, "--vision", "learned")
    yield started
    end(started)


def test_what_is_clicked_is_what_the_next_sentence_is_about(
    pupil: RunningService, visit: Visit, pictures: Path
):
    """An unknown thing is pointed at, named, and known from then on."""
    visitor = visit(pupil)
    wait_for_scene(visitor)
    visitor.page.get_by_role("button", name="Top", exact=True).click()

    point_at(visitor, "thing")
    visitor.wait_for(".pointed")
    visitor.page.locator(".stage").screenshot(path=pictures / "pointed.png")
    answer = visitor.say("This is a mallet.")

    assert "mallet" in answer
    assert visitor.page.locator(".pointed").count() == 0
    assert {"word": "mallet", "shown": True}.items() <= visitor.ask_api("words")[0].items()


def point_at(visitor: Visitor, name: str) -> None:
    """Move over the scene until the page names a thing, and click there."""
    box = visitor.wait_for("canvas").bounding_box()
    hovered = visitor.page.locator(".hovered")
    for row, column in product(range(1, 40), repeat=2):
        at = (box["x"] + box["width"] * column / 40, box["y"] + box["height"] * row / 40)
        visitor.page.mouse.move(*at)
        if hovered.count() and hovered.inner_text().partition(":")[0] == name:
            visitor.page.mouse.click(*at)
            return
    raise AssertionError(f"{name} is not in the picture")


def test_escape_stops_the_arm_while_another_waits(robot: RunningService, visit: Visit):
    """What moves is stopped in the middle; the command that waited behind it is dropped."""
    anna, ben = visit(robot), visit(robot, forgives=["status of 409"])
    for each in (anna, ben):
        wait_for_scene(each)
    anna.say(LESSONS[2])
    anna.begin("pass me the mug")
    anna.wait_for('[data-node="pass/graspObject"][data-state="reached"]')
    ben.begin("point to the glass")
    ben.wait_until("() => document.querySelector('.stop').textContent.includes('1 waiting')")

    anna.page.keyboard.press("Escape")
    ben.wait_for('.turn[data-outcome="refused"]')
    anna.wait_for('.turn[data-outcome="failed"]')
    anna.wait_until("() => !document.querySelector('.stop').classList.contains('active')")

    assert anna.ask_api("episodes")[-1]["outcome"] == "failed"

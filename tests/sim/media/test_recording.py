"""Pictures and recordings for people."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from hilt.ontology.errors import DataError, MissingExtraError
from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.media import pictures, recording
from hilt.sim.media.pictures import ACCEPTED, OVERVIEW, add_caption, save_picture, take_picture
from hilt.sim.media.recording import WorldRecorder, strip
from hilt.sim.robot.path_planner import Grasp
from hilt.sim.scene.scene import parse_scene
from hilt.sim.scene.world import World

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
SMALL = replace(OVERVIEW, width=120, height=90)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    """A mug on the table."""
    with World.build(parse_scene("objects:mug", seed=0, objects=OBJECTS), OBJECTS) as made:
        yield made


def recorded(world: World, path: Path, captions: tuple[str, ...]) -> Path:
    """A recording of 0.5 s for each caption, a picture every quarter of a second."""
    with WorldRecorder(world, path, camera=SMALL) as recorder:
        for caption in captions:
            recorder.caption = caption
            world.engine.step(120)
    return path


def test_picture_shows_a_warm_wall_and_a_brown_table(world: World):
    """The upper edge is nearly white; the table below is brown."""
    picture = take_picture(world.engine, SMALL).astype(float)

    assert picture.shape == (90, 120, 3)
    assert picture[0].min() > 230
    table = picture[-30:, 40:80].reshape(-1, 3)
    assert (table[:, 0] > table[:, 2] + 30).mean() > 0.9


def test_picture_leaves_the_world_alone(world: World):
    """Taking a picture moves nothing and lets no time pass."""
    before, time = world.pose("mug"), world.time

    take_picture(world.engine, SMALL)

    assert (world.pose("mug") == before).all()
    assert world.time == time


def test_saved_picture_is_read_back(world: World, tmp_path: Path):
    """A PNG holds exactly what was taken."""
    picture = take_picture(world.engine, SMALL, smoothing=1)

    save_picture(picture, tmp_path / "new" / "picture.png")

    assert (np.asarray(Image.open(tmp_path / "new" / "picture.png")) == picture).all()


def test_tint_is_seen_and_taken_back(world: World):
    """A tinted part is redder while it is tinted, and then as before."""
    before = take_picture(world.engine, SMALL, smoothing=1).astype(int)

    with world.engine.rendering.tinted("mug", "barrel", (1.0, 0.0, 0.0)):
        tinted = take_picture(world.engine, SMALL, smoothing=1).astype(int)

    after = take_picture(world.engine, SMALL, smoothing=1).astype(int)
    assert (tinted - before)[..., 0].max() > 50
    assert (after == before).all()


def test_gif_lasts_as_long_as_what_happened(world: World, tmp_path: Path):
    """A second of the world lasts a second, and the last picture stays a little longer."""
    path = recorded(world, tmp_path / "out.gif", ("Reach.", "Grasp."))

    with Image.open(path) as film:
        durations = [frame.info["duration"] for frame in ImageSequence.Iterator(film)]
        assert sum(durations) == 1000 / recording.SPEED + 1000 * recording.LAST_FRAME_TIME
        assert film.size[0] == 120
        assert film.size[1] > 90


def test_strip_shows_moments_side_by_side(world: World, tmp_path: Path):
    """A PNG of three pictures is three pictures wide."""
    path = recorded(world, tmp_path / "out.png", ("Reach.",))

    with Image.open(path) as image:
        assert image.size[0] == 3 * 120


def test_strip_is_made_of_evenly_spaced_pictures():
    """Of many pictures eight are shown, the first and the last among them."""
    shades = [np.full((4, 6, 3), value, dtype=np.uint8) for value in range(50)]

    whole = strip(shades)

    assert whole.shape == (8, 24, 3)
    assert (whole[0, 0, 0], whole[-1, -1, 0]) == (0, 49)


def test_strip_has_what_must_be_in_it():
    """A moment between the evenly spaced ones is kept when it is asked for."""
    shades = [np.full((4, 6, 3), shade, np.uint8) for shade in range(100)]

    whole = strip(shades, [41, 43])

    assert {41, 43, 0, 99} <= set(whole.ravel().tolist())
    assert whole.shape == (8, 24, 3)


def test_nothing_is_rendered_when_nobody_records(
    world: World, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    """After a recording, and without one, time passes without a picture."""
    recorded(world, tmp_path / "out.png", ("",))
    monkeypatch.setattr(pictures, "take_picture", lambda *_, **__: pytest.fail("rendered"))

    world.engine.step(60)

    assert world.engine.watchers == []


def test_failed_run_leaves_no_file(world: World, tmp_path: Path):
    """When what is recorded fails, nothing is written and nobody watches any more."""
    with pytest.raises(ZeroDivisionError), WorldRecorder(world, tmp_path / "out.gif", camera=SMALL):
        _ = 1 / 0

    assert not (tmp_path / "out.gif").exists()
    assert world.engine.watchers == []


def test_unknown_ending_is_refused_at_once(world: World):
    """What cannot be written is told before anything is recorded."""
    with pytest.raises(DataError, match=r"expected a file ending in .gif, .mp4, .png"):
        WorldRecorder(world, Path("out.avi"))


def test_mp4_holds_the_pictures(world: World, tmp_path: Path):
    """An MP4 plays as long as what happened, at the size of its pictures with caption."""
    import imageio.v2 as imageio

    path = recorded(world, tmp_path / "out.mp4", ("Reach.", "Grasp."))

    with imageio.get_reader(path) as film:
        facts = film.get_meta_data()
        assert facts["duration"] == pytest.approx(
            1 / recording.SPEED + recording.LAST_FRAME_TIME, abs=0.3
        )
        assert facts["size"][0] == 120
        assert facts["size"][1] > 90


def test_mp4_without_its_encoder_is_told(world: World, monkeypatch: pytest.MonkeyPatch):
    """Where the encoder of MP4 is missing, that is told before anything is recorded."""
    monkeypatch.setattr(recording, "find_spec", lambda _: None)

    with pytest.raises(MissingExtraError, match=r'"imageio-ffmpeg" is not installed'):
        WorldRecorder(world, Path("out.mp4"))


def test_long_caption_is_broken_into_lines():
    """A caption wider than its picture takes several lines, none of them too long."""
    picture = np.zeros((90, 300, 3), dtype=np.uint8)
    text = "To pass a knife grab the knife by the blade. " * 3

    lines = pictures.wrap_caption(picture, text)

    assert len(lines) > 2
    assert " ".join(lines) == text.strip()
    assert add_caption(picture, text).shape[0] > add_caption(picture, "Pass.").shape[0] > 90


def test_caption_keeps_its_own_lines():
    """What was said and what is done stand on lines of their own."""
    picture = np.zeros((90, 300, 3), dtype=np.uint8)

    assert pictures.wrap_caption(picture, "Pass.\npass")[:2] == ["Pass.", "pass"]


def test_recording_tints_and_draws_what_it_is_told(world: World, tmp_path: Path):
    """From the moment it is told, the part is tinted and the grasps are drawn; not before."""
    at = poses.translation(*world.pose("mug")[:3, 3])
    with WorldRecorder(world, tmp_path / "out.png", camera=SMALL) as recorder:
        for tint, grasps in (
            (None, {}),
            (("mug", "barrel"), {}),
            (None, {ACCEPTED: [Grasp(at, 0.06, 0.08, 1.0)]}),
        ):
            recorder.tint, recorder.grasps = tint, grasps
            recorder.take()
        plain, tinted, drawn = (picture.astype(int) for picture in recorder.pictures)

    assert (tinted - plain)[..., 2].max() > 40
    assert 0 < (drawn != plain).any(axis=2).sum() < 400


def test_picture_of_unknown_ending_is_refused():
    """What is no picture is told before anything is rendered."""
    with pytest.raises(DataError, match=r"expected a file ending in \.png"):
        pictures.check_writable(Path("scene.pdf"))

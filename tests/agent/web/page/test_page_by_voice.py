"""The running example by voice alone: Chromium hears sounds that a voice has made."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile
from scipy.signal import resample_poly

from ..running_service import RunningService
from .driving import Visitor

pytest.importorskip("pocketsphinx", reason='speech is not installed: pip install "hilt[speech]"')
pytest.importorskip("moonshine_voice")
if shutil.which("flite") is None:
    pytest.skip("the program flite is not installed", allow_module_level=True)

RATE = 48_000  # of Chromium's microphone
SILENCE_S = 1.0
Talk = Callable[[Visitor, str], str]


@pytest.fixture(scope="module")
def microphone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file that Chromium takes for what its microphone hears, anew each time it listens."""
    return tmp_path_factory.mktemp("microphone") / "now.wav"


@pytest.fixture(scope="module")
def options(microphone: Path) -> Sequence[str]:
    """Chromium with that microphone."""
    fakes = ("--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream")
    return (*fakes, f"--use-file-for-fake-audio-capture={microphone}%noloop",
            "--autoplay-policy=no-user-gesture-required")  # fmt: skip


@pytest.fixture
def talk(microphone: Path, tmp_path: Path) -> Talk:
    """Says something with the button held, and returns the text that was heard."""

    def said(visitor: Visitor, text: str) -> str:
        raw, page = tmp_path / "raw.wav", visitor.page
        subprocess.run(["flite", "-voice", "rms", "-t", text, "-o", raw], check=True)
        rate, samples = wavfile.read(raw)
        silence = np.zeros(int(SILENCE_S * RATE))
        sound = np.concatenate([silence, resample_poly(samples.astype(float), RATE, rate), silence])
        wavfile.write(microphone, RATE, sound.clip(-32768, 32767).astype("<i2"))
        count = page.locator(".turn").count()
        page.locator(".microphone").dispatch_event("pointerdown")
        visitor.wait_for('[data-talking="listening"]')
        page.wait_for_timeout(1_000 * sound.size / RATE + 300)
        page.locator(".microphone").dispatch_event("pointerup")
        return visitor.wait_for(f".turn:nth-of-type({count + 1}) .person p").inner_text()

    return said


def answer(visitor: Visitor) -> str:
    """The last answer, once there is one to everything."""
    visitor.wait_until("() => document.querySelector('.turn[data-outcome=waiting]') === null")
    return visitor.page.locator(".turn").last.locator(".hilt > p").first.inner_text()


def confirmed(visitor: Visitor, talk: Talk) -> str:
    """The answer, after the first of the readings if Hilt asked which was meant."""
    if answer(visitor).startswith("Did you say: 1."):
        talk(visitor, "the first one")
    return answer(visitor)


def test_running_example_by_voice(visit: Callable[..., Visitor], robot: RunningService, talk: Talk):
    """Taught, commanded, asked why and stopped; what is not sure is read back first."""
    visitor, asked = visit(robot, permissions=["microphone"]), list[str]()
    visitor.page.on("request", lambda request: asked.append(request.url))
    visitor.wait_for_connection()
    visitor.page.get_by_label("Speak answers").check()

    talk(visitor, "to pass a knife grab it by the blade")
    assert confirmed(visitor, talk) == "I learned: to pass a knife, grab it by the blade."
    talk(visitor, "pass me the knife")
    assert "holding it by the blade" in confirmed(visitor, talk)
    talk(visitor, "why")
    assert "to pass a knife grab it by the blade" in answer(visitor)

    visitor.begin("pass me the mug")
    visitor.wait_for('.turn[data-outcome="waiting"]')
    talk(visitor, "stop")
    assert answer(visitor).startswith("I stopped")
    assert any("/api/v1/voice?" in url for url in asked)

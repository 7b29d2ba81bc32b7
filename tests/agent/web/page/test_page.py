"""The page of a service without a robot: what is known, who said it, and how it is asked."""

from pathlib import Path

import pytest

from ..running_service import RunningService, start
from .conftest import Visit
from .driving import COMMAND, LESSONS, Visitor

MARKUP = "<img src=x onerror=alert(1)>"


@pytest.fixture
def taught(school: RunningService, visit: Visit) -> Visitor:
    """A visitor of the service that was taught the three sentences, who only reads."""
    visitor = visit(school)
    visitor.wait_for('.turn[data-sequence="3"]')
    return visitor


@pytest.fixture
def teacher(mind: RunningService, visit: Visit) -> Visitor:
    """A visitor who has taught the three sentences to an empty base."""
    visitor = visit(mind)
    for lesson in LESSONS:
        visitor.say(lesson)
    return visitor


def test_guide_leads_through_the_first_minute(mind: RunningService, visit: Visit):
    """On an empty base three sentences and a command are clicked, and then the guide is gone."""
    visitor = visit(mind)
    for number in range(1, 5):
        visitor.wait_for(".guide .next button").click()
        visitor.wait_for(f'.turn[data-sequence="{number}"]')

    visitor.wait_until("() => document.querySelector('.guide') === null")

    assert len(visitor.ask_api("rules")) == 3


def test_rules_are_those_of_the_service(taught: Visitor):
    """The table has one row a rule, with its interval."""
    shown = taught.rules()

    assert [row[0] for row in shown] == [rule["object"] for rule in taught.ask_api("rules")]
    assert shown[1] == ["knife", "by the blade", "pass", "[0.95, 1.00]"]


def test_rule_leads_to_who_said_it_and_is_forgotten(teacher: Visitor):
    """A click shows the sentence and its speaker; forgetting retracts, and the history keeps it."""
    teacher.rules()
    teacher.page.locator(".rule-table button").nth(1).click()
    source = teacher.wait_for(".provenance blockquote").inner_text()

    teacher.page.get_by_role("button", name="Forget").click()
    teacher.page.get_by_role("button", name="Really forget it").click()
    teacher.wait_until("() => document.querySelectorAll('.rule-table tbody tr').length === 2")

    assert LESSONS[1] in source and "sam" in source and "utterance 2" in source
    assert [rule["object"] for rule in teacher.ask_api("rules")] == ["knife", "mug"]
    assert teacher.ask_api("history")[1]["text"] == LESSONS[1]


def test_slider_shows_the_rules_as_they_were(taught: Visitor):
    """As of the first utterance there is one rule, and the page says loudly that it is the past."""
    taught.rules()
    taught.page.get_by_label("Now").fill("1")
    taught.wait_until("() => document.querySelectorAll('.rule-table tbody tr').length === 1")

    assert taught.wait_for(".slider strong").inner_text() == "As of utterance 1"
    taught.page.get_by_role("button", name="Back to now").click()
    taught.wait_until("() => document.querySelectorAll('.rule-table tbody tr').length === 3")


def test_graph_is_drawn_and_stays(taught: Visitor):
    """The canvas is not empty, and a filter takes away what does not fit."""
    taught.show("rules")
    taught.wait_for(".graph-canvas canvas")

    taught.page.get_by_label("Object").fill("mug")
    taught.wait_until("() => document.querySelector('[data-tab=rules] .mark').textContent === '1'")

    assert taught.wait_for(".graph-canvas").get_attribute("aria-label").startswith("1 rule")


def test_decision_is_proved(teacher: Visitor):
    """The proof shows what was told and its intervals, and what would change the decision."""
    teacher.say(COMMAND)
    teacher.show("proof")
    teacher.page.get_by_role("button", name="What would change it?").click()
    teacher.wait_for(".changes li")

    assert teacher.wait_for(".verdict").inner_text() == "Chosen: knife, by the blade"
    assert "chosen" in teacher.wait_for(".candidates li").inner_text()
    steps = teacher.page.locator(".proof .step-kind").all_inner_texts()
    assert {"modus ponens", "told", "seen"} <= {*steps}
    assert teacher.page.locator(".proof .interval").count() == len(steps)


def test_history_tells_everything(taught: Visitor):
    """The newest comes first; from an entry a click leads to the rules of then."""
    taught.show("history")
    said = taught.page.locator(".history .said").all_inner_texts()
    taught.page.get_by_role("button", name="rules then").last.click()

    assert said == [*reversed(LESSONS)]
    assert taught.wait_for(".slider strong").inner_text() == "As of utterance 1"


def test_what_is_not_understood_offers_what_could_be_said(mind: RunningService, visit: Visit):
    """The nearest sentences are buttons, and a click says one."""
    visitor = visit(mind)
    visitor.say("To pass a knife grab the knife by", outcome="not_understood")

    visitor.page.get_by_role("button", name="To pass a knife, grab the knife by the blade.").click()
    visitor.wait_for('.turn[data-sequence="2"][data-outcome="done"]')

    assert len(visitor.ask_api("rules")) == 1


def test_markup_in_a_sentence_stays_text(mind: RunningService, visit: Visit):
    """What is said is shown as it was typed, in the conversation and in the history."""
    visitor = visit(mind)
    visitor.say(MARKUP, outcome="not_understood")
    visitor.show("history")

    assert visitor.wait_for(".bubble.person p").inner_text() == MARKUP
    assert visitor.wait_for(".history .said").inner_text() == MARKUP
    assert visitor.page.locator("img[src=x]").count() == 0


def test_keyboard_is_enough(mind: RunningService, visit: Visit):
    """By keys alone: skip to the field, teach, call it back, and go through the tabs."""
    visitor = visit(mind)
    keyboard = visitor.page.keyboard
    keyboard.press("Tab")
    keyboard.press("Enter")
    visitor.wait_until("() => location.hash === '#utterance' || document.activeElement.id")
    visitor.page.get_by_label("Say something to Hilt").focus()
    keyboard.type(LESSONS[0])
    keyboard.press("Enter")
    visitor.wait_for('.turn[data-sequence="1"]')
    keyboard.press("ArrowUp")

    assert visitor.page.get_by_label("Say something to Hilt").input_value() == LESSONS[0]
    visitor.page.get_by_role("tab", name="Action").focus()
    keyboard.press("End")
    assert visitor.page.evaluate("document.activeElement.dataset.tab") == "history"
    keyboard.press("ArrowRight")
    assert visitor.page.evaluate("document.activeElement.dataset.tab") == "tree"


def test_everything_that_can_be_used_has_a_name(taught: Visitor):
    """Buttons, fields and pictures all have a name for screen readers, in every tab."""
    for tab in ("tree", "proof", "rules", "history"):
        taught.show(tab)

        unnamed = taught.page.evaluate(
            """() => [...document.querySelectorAll('button, input, select, canvas, img, a')]
            .filter(e => !e.closest('.graph-canvas'))
            .filter(e => !(e.ariaLabel || e.textContent.trim() || e.labels?.length || e.alt === ''))
            .map(e => e.outerHTML)"""
        )
        assert unnamed == []


def test_narrow_screen_shows_one_part_at_a_time(mind: RunningService, visit: Visit):
    """At 400 pixels the parts are chosen below, and nothing reaches beyond the side."""
    visitor = visit(mind, viewport={"width": 400, "height": 780})
    for name, part in (("Why", ".why"), ("Scene", ".scene"), ("Talk", ".talk")):
        visitor.page.get_by_role("button", name=name, exact=True).click()

        assert visitor.page.locator(".pane:visible").count() == 1
        assert visitor.page.locator(part).is_visible()
        assert visitor.page.evaluate("document.documentElement.scrollWidth") == 400


def test_reader_sees_only_what_readers_may_do(mind: RunningService, visit: Visit):
    """No stop, no new table, no forgetting; who teaches all the same is told why not."""
    with mind.client("teacher") as teacher:
        teacher.post("/api/v1/tell", json={"text": LESSONS[0]})
    visitor = visit(mind, roles=("reader",), forgives=["status of 403"])
    visitor.rules()
    visitor.page.locator(".rule-table button").first.click()
    visitor.wait_for(".provenance")

    visitor.begin(LESSONS[1])
    refused = visitor.wait_for('.turn[data-outcome="refused"] .bubble.hilt').inner_text()

    assert "teacher" in refused
    for name in ("Stop", "New table", "Forget"):
        assert visitor.page.get_by_role("button", name=name).count() == 0


def test_page_catches_up_with_a_service_that_comes_back(
    mind: RunningService, visit: Visit, tmp_path: Path
):
    """Killed and started again at its port; what was said meanwhile appears by itself."""
    first = start(tmp_path / "other", "--no-sim", "--no-auth")
    port = first.url.rpartition(":")[2]
    visitor = visit(first, forgives=["WebSocket", "ERR_CONNECTION"])
    visitor.say(LESSONS[0])
    first.process.kill()
    first.process.communicate()
    visitor.wait_for('html[data-connection="lost"]')

    second = start(tmp_path / "other", "--no-sim", "--no-auth", "--port", port)
    try:
        with second.client() as another:
            another.post("/api/v1/tell", json={"text": LESSONS[1]})
        visitor.wait_for('.turn[data-sequence="2"]')
        visitor.show("rules")
        visitor.wait_until(
            "() => document.querySelector('[data-tab=rules] .mark').textContent === '2'"
        )
    finally:
        second.process.terminate()
        second.process.communicate()


def test_address_with_the_key_opens_the_page_once(mind: RunningService, visit: Visit):
    """The key is taken out of the address; without one the page asks, and takes a token."""
    visitor = visit(mind, roles=(), forgives=["status of 401"])
    visitor.page.goto(f"{mind.url}/?key={mind.key}")
    visitor.wait_for_connection()
    stranger = visit(mind, roles=(), forgives=["status of 401"])
    token = mind.tokens.add("tablet", "anna", ["reader"])[1]
    stranger.page.get_by_label("one-time key").fill(token)
    stranger.page.get_by_role("button", name="Enter").click()
    stranger.wait_for_connection()

    assert visitor.page.url == f"{mind.url}/"
    assert stranger.ask_api("session")["speaker"] == "anna"


def test_named_question_is_answered(taught: Visitor):
    """How a knife is grasped is asked by a form, and answered as the service does."""
    taught.page.get_by_role("link", name="Ask").click()
    taught.wait_for("select:has(option[value='how-to-grasp'])")
    taught.page.get_by_label("Question", exact=True).select_option("how-to-grasp")
    taught.page.get_by_label("object").fill("knife")
    taught.page.get_by_role("button", name="Ask", exact=True).click()

    row = taught.wait_for(".results tbody tr").inner_text()

    assert "blade" in row and "0.95" in row


def test_sparql_is_answered_in_the_editor(taught: Visitor):
    """The editor opens with a query of the rules on grasping, and shows what the base has."""
    taught.page.get_by_role("link", name="Ask").click()
    taught.show("sparql")
    taught.wait_for(".yasqe_queryButton").click()

    rows = taught.wait_for(".yasr_results tbody:has(tr:nth-child(2))").inner_text()

    assert "blade" in rows and "handle" in rows


def test_evaluation_is_begun_watched_and_read(mind: RunningService, visit: Visit):
    """The experiment of the paper runs from the page, and its report opens in a frame."""
    visitor = visit(mind)
    visitor.page.get_by_role("link", name="Evaluations").click()
    visitor.page.get_by_role("button", name="Begin").click()
    done = visitor.wait_for('[data-evaluation][data-state="done"]')
    done.get_by_role("button", name="Report").click()

    report = visitor.page.frame_locator("iframe").locator("h1").first
    report.wait_for()

    assert "runs" in done.inner_text()


def test_two_see_the_same(mind: RunningService, visit: Visit):
    """What one says appears on the page of the other, with who said it."""
    anna, ben = visit(mind), visit(mind)
    for each in (anna, ben):
        each.wait_for_connection()
    anna.say(LESSONS[0])

    assert ben.wait_for('.turn[data-sequence="1"] .person p').inner_text() == LESSONS[0]
    ben.wait_until("() => document.querySelector('[data-tab=rules] .mark').textContent === '1'")


def test_motion_is_reduced_where_that_is_wanted(mind: RunningService, visit: Visit):
    """With less motion, nothing on the page is animated."""
    visitor = visit(mind, reduced_motion="reduce")
    visitor.say(LESSONS[0])

    assert visitor.page.evaluate("document.getAnimations().length") == 0

"""The JSON interface: its documents, events, repeated requests, the robot's lease, the end."""

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
import websockets.sync.client as websocket
from websockets.exceptions import ConnectionClosed

from hilt.agent.cli import main
from hilt.kb import KnowledgeBase
from hilt.kb.formats.import_export import import_file

from .running_service import SECONDS, RunningService, end, say, start

LESSONS = ("A knife is used for cutting", "To pass a knife, grab it by the blade")
COMMAND = "pass me something used for cutting"
LISTS = {  # route -> command that prints the same
    "rules": "rules", "rules?object=knife&at=1": "rules --object knife --at 1", "graph": "graph",
    "conflicts": "conflicts", "induced": "induce", "words": "words", "history": "history",
    "history?since=1": "history --since 1", "episodes": "episodes", "trust": "trust",
    "questions": "query --list",
}  # fmt: skip


@pytest.fixture(scope="module")
def sam(service: RunningService) -> Iterator[httpx.Client]:
    """The owner, who has taught two sentences, and had a command carried out."""
    client = service.browser()
    for lesson in LESSONS:
        say(client, "tell", lesson)
    say(client, "do", COMMAND)
    yield client
    client.close()


@contextmanager
def listen(service: RunningService, client: httpx.Client, **hello: Any) -> Iterator[Any]:
    """A WebSocket of somebody for the block."""
    cookie = "; ".join(f"{name}={value}" for name, value in client.cookies.items())
    headers, address = {"Cookie": cookie, "Origin": service.url}, service.url.replace("http", "ws")
    with websocket.connect(f"{address}/api/v1/live", additional_headers=headers) as socket:
        socket.send(json.dumps({"type": "hello", **hello}))
        yield socket


def until(socket: Any, kind: str) -> dict[str, Any]:
    """The next event of a kind."""
    while True:
        event: dict[str, Any] = json.loads(socket.recv(timeout=SECONDS))
        if event["type"] == kind:
            return event


@pytest.mark.parametrize("route", LISTS)
def test_answers_are_what_commands_print(
    service: RunningService, sam: httpx.Client, route: str, capsys: pytest.CaptureFixture[str]
):
    """There is one form of each document, on the command line and over HTTP."""
    with pytest.raises(SystemExit):
        main([*LISTS[route].split(), "--json", "--kb", str(service.base)])

    assert sam.get(f"/api/v1/{route}").json() == json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(("how", "text"), [("tell", LESSONS[0]), ("ask", "what is a knife for?")])
def test_sentences_are_answered_as_by_commands(
    sam: httpx.Client, how: str, text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """`tell` and `ask` have the keys of the commands, and say what it was and how it ended."""
    with pytest.raises(SystemExit):
        main([how, text, "--json", "--kb", str(tmp_path / "kb")])
    printed = json.loads(capsys.readouterr().out)

    answer = say(sam, how, text).json()

    assert answer.keys() == printed.keys() | {"kind", "outcome"}
    assert (answer["utterance"], answer["outcome"]) == (text, "done")


def test_command_is_decided_as_by_the_command_line(
    sam: httpx.Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """`explain` proves the same, and `dry` decides the same, without a word in the history."""
    before = sam.get("/readyz").json()["sequence"]
    explained = sam.post("/api/v1/explain", json={"text": COMMAND}).json()
    decided = say(sam, "do", COMMAND, dry=True).json()
    (tmp_path / "base.trig").write_bytes(sam.get("/api/v1/export").content)
    with KnowledgeBase.open(tmp_path / "kb") as base:
        import_file(base, tmp_path / "base.trig")
    with pytest.raises(SystemExit):
        main(["explain", COMMAND, "--json", "--kb", str(tmp_path / "kb")])

    assert explained == json.loads(capsys.readouterr().out)
    assert (decided["decision"]["object"], decided["decision"]["part"]) == ("knife", "blade")
    assert decided["world"] == {"executed": False}
    assert sam.get("/readyz").json()["sequence"] == before


def test_parse_keeps_nothing(sam: httpx.Client):
    """What was said before counts, and only there."""
    said = {"text": "pass it", "before": ["A knife is used for cutting"]}
    found = sam.post("/api/v1/parse", json=said).json()

    assert found["meaning"]["target"] == {"object": "knife"}


def test_what_is_not_understood_says_what_could_be_said(sam: httpx.Client):
    """It was heard and answered: that is no error of HTTP."""
    answer = say(sam, "hear", "glorb the frobnicator")

    assert answer.status_code == 200
    assert answer.json()["outcome"] == "not_understood"
    assert answer.json()["error"]["nearest"]


def test_question_among_alternatives_is_answered(sam: httpx.Client):
    """A recogniser may give several texts; a question that is understood does no harm."""
    others = [{"text": "what is a mug for?", "heard": 0.7}]
    answer = say(sam, "hear", "glorb a mug", heard=0.3, alternatives=others)

    assert answer.json()["utterance"] == "what is a mug for?"
    assert answer.json()["heard"] == 0.7


def test_command_among_alternatives_is_read_back(sam: httpx.Client):
    """It is done after a yes, unless it is sure what was said."""
    others = [{"text": "pass me the mug", "heard": 0.5}]
    asked = say(sam, "do", "pass me the knife", heard=0.5, alternatives=others).json()
    chosen = say(sam, "hear", "the second").json()

    assert (asked["outcome"], asked["expires_s"]) == ("asked", 60)
    assert chosen["utterance"] == "pass me the mug"


def test_stop_in_any_alternative_halts(sam: httpx.Client):
    """That needs no certainty."""
    others = [{"text": "stop", "heard": 0.05}]
    answer = say(sam, "do", "pass me the knife", heard=0.9, alternatives=others).json()

    assert answer["utterance"] == "stop"


def test_contexts_hold_for_one_utterance(sam: httpx.Client):
    """A context that is given with a sentence ends with it; a wrong one is told."""
    wrong = say(sam, "hear", "what is a mug for?", context=["kitchen"])

    assert say(sam, "ask", "what is a mug for?", context=["place:kitchen"]).status_code == 200
    assert (wrong.status_code, wrong.json()["type"]) == (422, "urn:hilt:wrong")


def test_uncertain_command_is_confirmed(sam: httpx.Client):
    """What was hardly heard is asked back; yes has it done, once."""
    asked = say(sam, "do", "pass me the knife", heard=0.3).json()
    done = sam.post("/api/v1/confirm", json={"id": asked["confirm"], "yes": True})
    again = sam.post("/api/v1/confirm", json={"id": asked["confirm"], "yes": True})

    assert (asked["outcome"], asked["expires_s"]) == ("asked", 60)
    assert (done.status_code, done.json()["outcome"]) == (200, "done")
    assert again.status_code == 410


def test_others_cannot_confirm(service: RunningService, sam: httpx.Client):
    """A question is answered by who was asked, whatever the speaker is called."""
    asked = say(sam, "do", "pass me the knife", heard=0.3).json()
    with service.client("reader") as reader:
        answered = reader.post("/api/v1/confirm", json={"id": asked["confirm"], "yes": True})
        said = say(reader, "hear", "yes").json()

    assert answered.status_code == 410
    assert "decision" not in said


def test_repeated_request_is_done_once(sam: httpx.Client):
    """A key makes a request that is sent again the same one."""
    before = sam.get("/readyz").json()["sequence"]
    header = {"Idempotency-Key": "one"}
    first = say(sam, "do", COMMAND, headers=header).json()
    again = say(sam, "do", COMMAND, headers=header).json()
    other = say(sam, "do", "pass me the mug", headers=header)

    assert first == again
    assert sam.get("/readyz").json()["sequence"] == before + 1
    assert other.status_code == 422


def test_long_command_answers_at_once(sam: httpx.Client):
    """Who does not want to wait gets an address that tells how far it is."""
    begun = say(sam, "do", COMMAND, headers={"Prefer": "respond-async"})
    place = begun.headers["Location"]
    while (job := sam.get(place).json())["state"] != "done":
        pass

    assert begun.status_code == 202
    assert job["answer"]["outcome"] == "done"


def test_lease_keeps_others_from_the_robot(service: RunningService, sam: httpx.Client):
    """Who holds the robot commands it alone; others are told who does, and may stop it."""
    with service.client("operator", speaker="anna") as anna:
        sam.post("/api/v1/robot/lease", json={"seconds": 30})
        refused = say(anna, "do", COMMAND)
        stopped = anna.post("/api/v1/robot/stop")
        sam.post("/api/v1/robot/lease", json={"seconds": 0})
        heard = say(anna, "do", COMMAND)

    assert (refused.status_code, refused.json()["type"]) == (409, "urn:hilt:leased")
    assert "sam" in refused.json()["detail"]
    assert (stopped.status_code, heard.status_code) == (200, 200)


def test_table_is_laid_anew(sam: httpx.Client):
    """Another scene is on the table, and what was taught stays."""
    sam.post("/api/v1/scene", json={"scene": "objects:spoon,knife"})
    done = say(sam, "do", COMMAND).json()
    scene = sam.get("/api/v1/scene").json()
    sam.post("/api/v1/scene", json={"scene": "all"})

    assert [thing["name"] for thing in scene["things"]] == ["spoon", "knife"]
    assert done["decision"]["object"] == "knife"


def test_what_is_no_sound_is_refused(sam: httpx.Client):
    """In one line, whether recognisers are installed or not."""
    for sound in (b"", b"RIFF nonsense", bytes(1_000)):
        found = sam.post("/api/v1/listen", content=sound, headers={"Content-Type": "audio/wav"})
        assert found.status_code in {409, 422}
        assert found.json()["type"] in {"urn:hilt:not-installed", "urn:hilt:wrong"}


def test_rules_come_in_pages(sam: httpx.Client):
    """The header Link leads through all of them."""
    whole, found, address = sam.get("/api/v1/rules").json(), [], "/api/v1/rules?limit=1"
    while address:
        answer = sam.get(address)
        found += answer.json()
        address = answer.links.get("next", {}).get("url")

    assert found == whole
    assert len(found) > 1


def test_rule_is_forgotten(service: RunningService, sam: httpx.Client):
    """Who taught a rule retracts it; the history keeps it, and others' rules need an admin."""
    told = say(sam, "tell", "A spoon is used for eating").json()["rules"][0]["id"]
    with service.client("teacher", speaker="anna") as anna:
        refused = anna.delete(f"/api/v1/rules/{told}")
    gone = sam.delete(f"/api/v1/rules/{told}").json()

    assert refused.status_code == 403
    assert [rule["id"] for rule in gone["retracted"]] == [told]
    assert sam.get(f"/api/v1/rules/{told}").json()["status"] == "retracted"


def test_named_question_is_answered_in_sparql_json(sam: httpx.Client):
    """Its parameters are names; a wrong name is told."""
    found = sam.post("/api/v1/questions/best-for", json={"affordance": "cutting"})
    wrong = sam.post("/api/v1/questions/best-for", json={"use": "cutting"})

    assert found.json()["results"]["bindings"][0]["object"]["value"].endswith("/knife")
    assert (wrong.status_code, wrong.json()["type"]) == (422, "urn:hilt:unknown-name")


@pytest.mark.parametrize("format", ["trig", "sheet", "csv", "nquads"])
def test_files_go_out_and_in(sam: httpx.Client, format: str):
    """What is exported is read again, and changes nothing."""
    file = sam.get("/api/v1/export", params={"format": format}).content
    read = sam.post(f"/api/v1/import?format={format}", content=file).json()
    broken = sam.post(f"/api/v1/import?format={format}", content=b"\xff<")

    assert (read["applied"], read["new"], read["conflicting"]) == (True, 0, 0)
    assert broken.status_code in {409, 422}


def test_backup_is_beside_the_base(service: RunningService, sam: httpx.Client):
    """It can be opened like any base."""
    made = sam.post("/api/v1/backup", json={"name": "monday"})

    assert made.status_code == 201
    assert (service.base.with_name("kb.backups") / "monday").is_dir()


def test_tokens_are_made_and_removed(service: RunningService, sam: httpx.Client):
    """A token is shown once; who has it may do what its roles allow."""
    wish = {"name": "tablet", "speaker": "anna", "roles": ["reader"], "days": 1}
    made = sam.post("/api/v1/tokens", json=wish)
    headers = {"Authorization": f"Bearer {made.json()['token']}"}
    who = httpx.get(f"{service.url}/api/v1/session", headers=headers).json()
    gone = sam.delete(f"/api/v1/tokens/{made.json()['id']}")

    assert (made.status_code, who["speaker"], gone.status_code) == (201, "anna", 204)
    assert "token" not in sam.get("/api/v1/tokens").text.replace("tokens", "")


def test_evaluation_runs_beside_with_progress(service: RunningService, sam: httpx.Client):
    """It has a process of its own, tells how far it is, and leaves a report."""
    with listen(service, sam) as socket:
        begun = sam.post("/api/v1/evaluations", json={"what": "random", "scenarios": 3})
        busy = sam.post("/api/v1/evaluations", json={"what": "random"})
        while (event := until(socket, "progress"))["state"] == "running":
            pass
    place = begun.headers["Location"]

    assert (begun.status_code, busy.status_code) == (202, 409)
    assert event["done"] == event["of"] > 0
    assert sam.get(place).json()["result"]["runs"] > 0
    assert "<html" in sam.get(f"{place}/report").text


def test_events_tell_what_happens(service: RunningService, sam: httpx.Client):
    """A command is queued, begun, walked node by node, decided, said and done."""
    with listen(service, sam) as socket:
        assert until(socket, "hello")["version"] == 1
        say(sam, "do", COMMAND)
        kinds, event = list[str](), dict[str, Any]()
        while event.get("state") != "done":
            event = json.loads(socket.recv(timeout=SECONDS))
            kinds.append(event["type"])

    assert kinds[:3] == ["command", "command", "step"]
    assert set(kinds[2:-3]) == {"step"}
    assert kinds[-3:] == ["decision", "said", "command"]


def test_nothing_is_missed_after_a_lost_connection(service: RunningService, sam: httpx.Client):
    """Who comes back says what was heard last, and gets what was said since, in order."""
    last = sam.get("/readyz").json()["sequence"]
    for lesson in LESSONS:
        say(sam, "tell", lesson)
    with listen(service, sam, since=last) as socket:
        ids = [until(socket, "said")["id"] for _ in LESSONS]
    with sam.stream("GET", "/api/v1/events", headers={"Last-Event-ID": str(last)}) as stream:
        lines = (line for line in stream.iter_lines() if line.startswith("id: "))
        seen = [next(lines) for _ in LESSONS]

    assert ids == [last + 1, last + 2]
    assert seen == [f"id: {number}" for number in ids]
    assert stream.headers["content-type"].startswith("text/event-stream")
    assert stream.headers["cache-control"] == "no-cache"


def test_metrics_are_counted(service: RunningService, sam: httpx.Client):
    """Prometheus reads them."""
    text = sam.get("/metrics").text

    assert 'hilt_requests_total{method="POST",route="/api/v1/do",status="200"}' in text
    assert "hilt_utterances " in text


@pytest.mark.parametrize("ended_by", [signal.SIGTERM, signal.SIGINT])
def test_service_ends_with_streams_open(tmp_path: Path, ended_by: signal.Signals):
    """Readers are told, and the base is closed, within seconds."""
    service = start(tmp_path / "kb", "--no-sim")
    sam = service.browser()
    with listen(service, sam) as socket:
        say(sam, "tell", LESSONS[0])
        with sam.stream("GET", "/api/v1/events") as events:
            service.process.send_signal(ended_by)
            told = "".join(events.iter_text())
        with pytest.raises(ConnectionClosed) as closed:
            until(socket, "none")
        service.process.communicate(timeout=15)
    sam.close()

    assert "event: closing" in told
    assert closed.value.rcvd
    assert closed.value.rcvd.code == 1001


def test_session_outlives_the_service(tmp_path: Path):
    """A page that was open goes on when the service comes back."""
    first = start(tmp_path / "kb", "--no-sim")
    client = first.browser()
    port = first.url.rpartition(":")[2]
    end(first)
    again = start(tmp_path / "kb", "--no-sim", "--port", port)
    answer = client.get("/api/v1/session")
    end(again)
    client.close()

    assert answer.json()["id"] == "owner"


def test_service_without_keys_says_so(tmp_path: Path):
    """For scripts on one machine; everybody there is the owner."""
    command = ["serve", "--kb", "memory:", "--no-sim", "--no-auth", "--port", "0", "--json"]
    process = subprocess.Popen(
        [sys.executable, "-m", "hilt", *command],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout
    ready = json.loads(process.stdout.readline())
    answer = httpx.post(f"{ready['url']}api/v1/tell", json={"text": LESSONS[0]})
    process.terminate()
    _, told = process.communicate(timeout=SECONDS)

    assert (ready["key"], answer.status_code) == (None, 200)
    assert "Without keys" in told

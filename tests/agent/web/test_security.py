"""What the service refuses, and to whom: each line of its table of threats is a test."""

import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
import websockets.sync.client as websocket
from websockets.exceptions import ConnectionClosed, InvalidStatus

from .running_service import RunningService, say

LESSON = "A knife is used for cutting"
WRITES = [
    ("POST", "/api/v1/tell", {"text": LESSON}, "teacher"),
    ("POST", "/api/v1/do", {"text": "pass me the knife"}, "operator"),
    ("DELETE", "/api/v1/rules/last", None, "teacher"),
    ("POST", "/api/v1/scene", {"scene": "all"}, "operator"),
    ("POST", "/api/v1/robot/stop", None, "operator"),
    ("POST", "/api/v1/robot/lease", {"seconds": 1}, "operator"),
    ("POST", "/api/v1/evaluations", {"what": "random"}, "operator"),
    ("DELETE", "/api/v1/evaluations/x", None, "operator"),
    ("PUT", "/api/v1/trust/sam", {"degree": 0}, "admin"),
    ("POST", "/api/v1/import?format=trig", None, "admin"),
    ("POST", "/api/v1/backup", {"name": "x"}, "admin"),
    ("GET", "/api/v1/tokens", None, "admin"),
    ("POST", "/api/v1/tokens", {"name": "x", "speaker": "sam", "roles": ["admin"]}, "admin"),
    ("DELETE", "/api/v1/tokens/x", None, "admin"),
]


@pytest.fixture(scope="module")
def page(service: RunningService) -> Iterator[httpx.Client]:
    """The owner's browser."""
    client = service.browser()
    yield client
    client.close()


def problem(answer: httpx.Response) -> str:
    """The type of the problem that an answer reports, in the form of problem documents."""
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["status"] == answer.status_code
    return answer.json()["type"]


def test_owner_writes_in_the_page(service: RunningService, page: httpx.Client):
    """The key of the address is exchanged for a cookie that scripts cannot read."""
    answer = say(page, "tell", LESSON)

    assert answer.json()["accepted"]
    assert page.get("/api/v1/session").json()["speaker"] == "sam"


def test_key_opens_one_session(service: RunningService, page: httpx.Client):
    """The address cannot be used again, whoever finds it."""
    again = httpx.get(f"{service.url}/", params={"key": service.key})

    assert (again.status_code, problem(again)) == (401, "urn:hilt:who")
    assert "set-cookie" not in again.headers


def test_nobody_reads_without_a_token(service: RunningService):
    """Everything but the page itself and the signs of life asks who one is."""
    with service.client() as stranger:
        asked = [stranger.get(f"/api/v1/{path}").status_code for path in ("rules", "events")]
        alive = [stranger.get(path).status_code for path in ("/healthz", "/readyz", "/")]

    assert asked == [401, 401]
    assert alive == [200, 200, 200]


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1"])
def test_foreign_origin_is_refused(service: RunningService, page: httpx.Client, origin: str):
    """Another site cannot use the cookie, nor a token that it was given, nor open a WebSocket."""
    answer = say(page, "tell", LESSON, headers={"Origin": origin})

    assert (answer.status_code, problem(answer)) == (403, "urn:hilt:forbidden")
    with pytest.raises(InvalidStatus) as refused:
        websocket.connect(f"{service.url.replace('http', 'ws')}/api/v1/live", origin=origin)
    assert refused.value.response.status_code == 403


def test_request_with_a_cookie_names_its_page(page: httpx.Client):
    """A POST with a cookie and no origin comes from no page of ours."""
    with httpx.Client(base_url=page.base_url, cookies=page.cookies) as other:
        refused = say(other, "tell", LESSON)
        fetched = say(other, "tell", LESSON, headers={"Sec-Fetch-Site": "same-origin"})

    assert (refused.status_code, fetched.status_code) == (403, 200)


def test_foreign_host_is_refused(service: RunningService):
    """A name that an attacker lets point to this machine is not served."""
    with service.client("admin") as client:
        answer = client.get("/api/v1/rules", headers={"Host": "evil.example"})

    assert answer.status_code == 400


def test_speaker_cannot_be_forged(service: RunningService):
    """A token speaks for one; neither the body nor an introduction makes it another's."""
    with service.client("admin") as owner, service.client("teacher", speaker="eve") as eve:
        say(owner, "tell", LESSON)
        owner.put("/api/v1/trust/eve", json={"degree": 0.5})
        named = say(eve, "tell", "A mug is used for drinking", speaker="sam")
        introduced = say(eve, "hear", "I'm Sam. A mug is used for drinking")
        greeted = say(eve, "hear", "I'm Sam")
        own = say(eve, "tell", "A mug is used for drinking")

    assert [each.status_code for each in (named, introduced, greeted)] == [403, 403, 403]
    assert [rule["speaker"] for rule in own.json()["rules"]] == ["eve"]


def test_admin_may_name_the_speaker(service: RunningService):
    """A program that hears several people says who spoke."""
    with service.client("admin") as robot:
        robot.put("/api/v1/trust/anna", json={"degree": 0.9})
        said = say(robot, "tell", "A spoon is used for stirring", speaker="anna")

    assert said.json()["rules"][0]["speaker"] == "anna"


def test_trust_is_given_by_admins(service: RunningService):
    """A teacher cannot vouch for others by saying so."""
    with service.client("teacher") as teacher:
        said = say(teacher, "hear", "You can trust Mallory")

    assert (said.status_code, said.json()["needs"]) == (403, "admin")


def test_expired_token_is_refused(service: RunningService):
    """A token ends when it was said to end, and at once when it is removed."""
    _, old = service.tokens.add("old", "sam", ["admin"], timedelta(seconds=-1))
    made, secret = service.tokens.add("new", "sam", ["reader"])
    headers = {"Authorization": f"Bearer {secret}"}
    before = httpx.get(f"{service.url}/api/v1/rules", headers=headers)
    service.tokens.remove(made.id)
    after = httpx.get(f"{service.url}/api/v1/rules", headers=headers)
    expired = httpx.get(f"{service.url}/api/v1/rules", headers={"Authorization": f"Bearer {old}"})

    assert [each.status_code for each in (before, after, expired)] == [200, 401, 401]


@pytest.mark.parametrize(("method", "path", "body", "role"), WRITES)
def test_reader_changes_nothing(
    service: RunningService, method: str, path: str, body: object, role: str
):
    """Every route that changes something names the role that it needs."""
    with service.client("reader") as reader:
        answer = reader.request(method, path, json=body)

    assert (answer.status_code, answer.json()["needs"]) == (403, role)


@pytest.mark.parametrize(
    ("roles", "text", "needs"),
    [
        (("reader",), LESSON, "teacher"),
        (("reader",), "pass me the knife", "operator"),
        (("reader",), "stop", "operator"),
        (("teacher",), "pass me the knife", "operator"),
        (("operator",), LESSON, "teacher"),
        (("operator",), "forget that", "teacher"),
        (("reader",), "A saw is used for cutting bread. Bring me one.", "teacher"),
        (("teacher",), "A saw is used for cutting bread. Bring me one.", "operator"),
        (("operator",), "A saw is used for cutting bread. Bring me one.", "teacher"),
    ],
)
def test_hear_needs_what_the_words_need(
    service: RunningService, roles: tuple[str, ...], text: str, needs: str
):
    """Whatever is heard is what its words say, and needs the role for that."""
    with service.client(*roles) as client:
        answer = say(client, "hear", text)

    assert (answer.status_code, answer.json()["needs"]) == (403, needs)


def test_every_alternative_needs_what_its_words_need(service: RunningService):
    """Any of them may be what is done."""
    others = [{"text": LESSON, "heard": 0.2}]
    with service.client("operator") as client:
        answer = say(client, "hear", "pass me the knife", alternatives=others)

    assert (answer.status_code, answer.json()["needs"]) == (403, "teacher")


def test_operator_confirms_a_command_that_is_read_back(service: RunningService):
    """What may be answered goes by what is read back, not by the question itself."""
    others = [{"text": "pass me the mug", "heard": 0.5}]
    with service.client("operator") as client:
        asked = say(client, "do", "pass me the knife", heard=0.5, alternatives=others)
        answered = client.post(
            "/api/v1/confirm", json={"id": asked.json()["confirm"], "yes": False}
        )

    assert answered.status_code == 200


def test_yes_of_a_reader_teaches_nothing(service: RunningService):
    """A question of Hilt that a reader's question led to is not answered with a rule."""
    with service.client("reader") as reader:
        asked = say(reader, "ask", "is a hammer used for cutting?")
        answered = say(reader, "hear", "yes")
        rules = reader.get("/api/v1/rules", params={"object": "hammer"}).json()

    assert "confirm" not in asked.json()
    assert not answered.json().get("accepted")
    assert rules == []


def test_form_with_a_cookie_changes_nothing(page: httpx.Client):
    """A form of another page needs no preflight; it reaches no route that changes something."""
    before = page.get("/api/v1/rules").json()
    form = {"update": "CLEAR ALL", "text": "A mug is used for cutting"}
    answers = [page.post(path, data=form).status_code for path in ("/update", "/api/v1/tell")]

    assert all(status in {401, 403, 404, 415, 422} for status in answers)
    assert page.get("/api/v1/rules").json() == before


def test_markup_in_sentences_stays_text(page: httpx.Client):
    """What people say comes back as JSON, under a policy that runs no script of it."""
    said = "<img src=x onerror=alert(1)>"
    answer = say(page, "hear", said)

    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert "script-src 'self'" in answer.headers["content-security-policy"]
    assert answer.json()["utterance"] == said


def test_body_without_end_is_cut(service: RunningService):
    """A body is counted while it comes, whatever its headers say."""
    secret = service.tokens.add("t", "sam", ["admin"])[1]
    sent = 0

    def endless() -> Iterator[bytes]:
        nonlocal sent
        while sent < 2**26:
            sent += 2**16
            yield b" " * 2**16

    headers = {"Authorization": f"Bearer {secret}", "Content-Type": "application/json"}
    try:
        answer = httpx.post(f"{service.url}/api/v1/tell", content=endless(), headers=headers)
    except httpx.WriteError:  # it hangs up before all is sent
        answer = None

    assert answer is None or answer.status_code == 413
    assert sent < 2**26


def test_long_sentences_are_refused(page: httpx.Client):
    """At most 2,000 characters are parsed."""
    answer = say(page, "hear", "a knife " * 300)

    assert (answer.status_code, problem(answer)) == (422, "urn:hilt:wrong-form")


def test_slow_readers_do_not_hold_up_others(service: RunningService, page: httpx.Client):
    """64 who open a stream and never read it take a bounded queue each, and nobody waits."""
    place = urlsplit(service.url)
    secrets = [service.tokens.add(f"slow{n}", "sam", ["reader"])[1] for n in range(17)]
    slow = list[socket.socket]()
    for secret in [secret for secret in secrets for _ in range(4)]:
        connection = socket.create_connection((place.hostname, place.port))
        head = f"GET /api/v1/events HTTP/1.1\r\nHost: {place.netloc}\r\n"
        connection.sendall(f"{head}Authorization: Bearer {secret}\r\n\r\n".encode())
        slow.append(connection)
    told = [say(page, "tell", LESSON).status_code for _ in range(20)]
    statuses = [connection.recv(12).decode().rpartition(" ")[2] for connection in slow]
    for connection in slow:
        connection.close()

    assert told == [200] * 20
    assert statuses.count("200") <= 64
    assert set(statuses) == {"200", "429"}


def test_path_cannot_leave_its_folder(service: RunningService):
    """No name of a file or folder comes from outside."""
    up = "../../../../../../etc/passwd"
    with service.client("admin") as admin:
        answers = [
            admin.get(f"/static/{up}"),
            admin.get("/static/%2e%2e/%2e%2e/app.py"),
            admin.get(f"/api/v1/evaluations/{up.replace('/', '%2F')}/report"),
            admin.get("/api/v1/evaluations/../report"),
            admin.post("/api/v1/backup", json={"name": "../x"}),
            admin.post("/api/v1/scene", json={"scene": "/etc/passwd"}),
            admin.post(
                "/api/v1/explain", json={"text": "pass me the knife", "scene": "/etc/x.yaml"}
            ),
        ]

    assert {each.status_code for each in answers} <= {404, 405, 422}
    assert not any("root:" in each.text for each in answers)


def test_token_is_in_no_log(service: RunningService):
    """Who did what is noted, without what opens the door."""
    made, secret = service.tokens.add("noted", "sam", ["teacher"])
    headers = {"Authorization": f"Bearer {secret}"}
    httpx.post(f"{service.url}/api/v1/tell", json={"text": LESSON}, headers=headers)
    httpx.get(f"{service.url}/", params={"key": secret})
    log = service.base.with_name("kb.tokens.audit.log").read_text()
    kept = service.base.with_name("kb.tokens.json")

    assert f"{made.id} sam POST /api/v1/tell 200" in log
    assert secret not in log and LESSON not in log
    assert secret not in kept.read_text()
    assert kept.stat().st_mode & 0o077 == 0


def test_too_many_requests_wait(service: RunningService):
    """A token has 30 requests at once; who guesses keys five a minute."""
    with service.client("reader") as eager:
        answers = [eager.get("/api/v1/session") for _ in range(35)]
    guessed = [
        httpx.post(f"{service.url}/api/v1/session", json={"key": f"hilt_{n}"}) for n in range(9)
    ]

    assert [each.status_code for each in answers] == [200] * 30 + [429] * 5
    assert int(answers[-1].headers["retry-after"]) >= 1
    assert [each.status_code for each in guessed][-1] == 429


def test_websocket_wants_to_know_who_listens(service: RunningService):
    """A first message without a token, or with a wrong one, ends it."""
    address = f"{service.url.replace('http', 'ws')}/api/v1/live"
    with websocket.connect(address) as stranger:
        stranger.send(json.dumps({"type": "hello"}))
        with pytest.raises(ConnectionClosed) as closed:
            stranger.recv()

    assert closed.value.rcvd
    assert closed.value.rcvd.code in {4401, 4429}


@pytest.mark.parametrize(
    "options",
    [["--host", "0.0.0.0"], ["--host", "0.0.0.0", "--no-auth", "--behind-proxy"]],  # noqa: S104
)
def test_others_are_let_in_with_tokens_and_tls_only(tmp_path: Path, options: list[str]):
    """Beyond this machine it does not listen without them."""
    command = ["serve", "--kb", str(tmp_path / "kb"), "--no-sim", "--no-browser", "--port", "0"]
    ended = subprocess.run(
        [sys.executable, "-m", "hilt", *command, *options], capture_output=True, text=True
    )

    assert ended.returncode == 2
    assert "0.0.0.0" in ended.stderr  # noqa: S104

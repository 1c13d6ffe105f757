"""Who is let in, and under which name."""

from __future__ import annotations

import re
from pathlib import Path

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from tests.unit.server.running import TOKEN, RunningApp, StartApp


@pytest.fixture
def stranger(start_app: StartApp, maps_folder: Path) -> RunningApp:
    """A client without the token."""
    return start_app(maps_folder, authorized=False)


@pytest.mark.parametrize(
    "path", ["/", "/app.js", "/api/maps", "/api/maps/loops/nodes/1/image", "/openapi.json", "/viser/loops/"]
)
def test_without_the_token_nothing_is_told(stranger: RunningApp, path: str) -> None:
    answer = stranger.get(path)
    assert answer.status_code == 401
    assert "loops" not in answer.text.replace(path, "")
    if path.startswith("/api"):
        assert answer.json()["error"]["code"] == "no_token"
    else:
        assert answer.status_code == 401


@pytest.mark.parametrize("path", ["/api/events", "/viser/loops/"])
def test_without_the_token_no_stream_opens(stranger: RunningApp, path: str) -> None:
    with pytest.raises(InvalidStatus) as refused, stranger.stream_of(path):
        pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize(
    "header", ["Bearer wrong", f"Basic {TOKEN}", f"Bearer {TOKEN}x", "Bearer", TOKEN, "Bearer \xfc"]
)
def test_a_wrong_token_is_none(stranger: RunningApp, header: str) -> None:
    assert stranger.get("/api/maps", headers={"Authorization": header.encode("latin-1")}).status_code == 401
    assert stranger.get("/", params={"token": "wrong"}).status_code == 401


def test_the_link_becomes_a_cookie_and_leaves_a_clean_address(stranger: RunningApp) -> None:
    answer = stranger.get(f"/?token={TOKEN}&view=loops")
    assert answer.status_code == 303 and answer.headers["location"] == "/?view=loops"
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie and f"slamdeck-{stranger.port}=" in cookie
    assert stranger.get("/api/maps").status_code == 200
    assert stranger.get("/").status_code == 200


def test_health_needs_no_token_and_tells_nothing(stranger: RunningApp) -> None:
    answer = stranger.get("/healthz")
    assert (answer.status_code, answer.text) == (200, "ok\n")


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "", "10.0.0.7", "[", "localhost@evil"])
def test_under_another_name_it_does_not_answer(client: RunningApp, host: str) -> None:
    answer = client.get("/api/maps", headers={"Host": host})
    assert answer.status_code in (400, 421)
    with pytest.raises(InvalidStatus), client.stream_of("/api/events", headers={"Host": host or "x"}):
        pass


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "localhost:9", "LOCALHOST", "[::1]:8700"])
def test_its_own_names_are_known(client: RunningApp, host: str) -> None:
    assert client.get("/api/maps", headers={"Host": host}).status_code == 200


def test_a_name_of_a_reverse_proxy_is_known_when_it_was_told(start_app: StartApp, maps_folder: Path) -> None:
    client = start_app(maps_folder, hosts=("maps.example",))
    assert client.get("/api/maps", headers={"Host": "maps.example"}).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
)
def test_other_sites_change_nothing_and_open_no_stream(client: RunningApp, headers: dict[str, str]) -> None:
    answer = client.post("/api/session/stop", headers=headers)
    assert answer.status_code == 403
    assert answer.json()["error"]["code"] == "wrong_origin"
    assert client.patch("/api/scene/loops", json={}, headers=headers).status_code == 403
    with pytest.raises(InvalidStatus), client.stream_of("/api/events", headers=headers):
        pass


def test_its_own_page_may(client: RunningApp) -> None:
    own = {"Origin": f"http://127.0.0.1:{client.port}", "Sec-Fetch-Site": "same-origin"}
    assert client.post("/api/session/stop", headers=own).status_code == 409
    with client.stream_of("/api/events", headers=own):
        pass


@pytest.mark.parametrize("path", ["/", "/app.js", "/api/maps", "/api/maps/none", "/nothing", "/healthz"])
def test_every_answer_says_what_it_may_do(client: RunningApp, path: str) -> None:
    answer = client.get(path)
    policy = answer.headers["content-security-policy"]
    assert "default-src 'none'" in policy and "frame-ancestors 'self'" in policy
    assert "unsafe" not in policy and re.search(r"script-src 'self' 'sha256-[\w+/]{43}='", policy)
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["referrer-policy"] == "no-referrer"
    assert "document-isolation-policy" not in answer.headers


def test_the_3d_view_and_the_document_around_it_are_together_and_apart_from_the_page(client: RunningApp) -> None:
    apart = [client.get(path).headers["document-isolation-policy"] for path in ("/frame.html", "/viser/loops/")]
    assert apart == ["isolate-and-require-corp"] * 2
    assert "default-src 'none'" in client.get("/frame.html").headers["content-security-policy"]


@pytest.mark.parametrize(
    "path",
    [
        "/../pyproject.toml",
        "/..%2f..%2fetc%2fpasswd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/api/maps/..%2floops",
        "/api/maps/%2e%2e%2f%2e%2e%2fetc%2fpasswd",
        "/api/maps/notes.txt",
        "/api/maps/%2fetc%2fpasswd",
        "/viser/..%2f..%2f/",
        "/viser/loops/../../etc/passwd",
        "/viser/loops/%2e%2e/%2e%2e/etc/passwd",
    ],
)
def test_no_way_leads_out_of_the_served_folders(client: RunningApp, path: str) -> None:
    request = client.build_request("GET", "/")
    request.url = httpx.URL(f"http://127.0.0.1:{client.port}").copy_with(raw_path=path.encode())
    answer = client.send(request)
    assert answer.status_code in (404, 422), answer.text
    assert "root:" not in answer.text and "[project]" not in answer.text


def test_without_a_token_by_choice_everybody_on_this_machine_is_let_in(start_app: StartApp, maps_folder: Path) -> None:
    open_to_all = start_app(maps_folder, authorized=False, token=None)
    assert open_to_all.get("/api/maps").status_code == 200
    assert open_to_all.post("/api/session/stop", headers={"Origin": "https://evil.example"}).status_code == 403

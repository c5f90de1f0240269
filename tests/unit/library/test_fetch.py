"""Public data arrive whole, checked and resumable; every failure is one sentence."""

from __future__ import annotations

import hashlib
import lzma
import re
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.read import find_recipe
from studykit.library import fetch as fetching

CONTENT = {"salsa/01.bvh": b"a" * 50_000 + b"b" * 50_000, "indian/04.bvh": bytes(range(256)) * 300}


class Origin(ThreadingHTTPServer):
    """A web server with the files above that can be told to misbehave."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.content = dict(CONTENT)
        self.cut_after: list[int] = []  # one entry an answer: bytes sent before the connection is cut
        self.knows_range = True
        self.status = 0
        self.asked: list[tuple[str, str | None]] = []

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}/data"


class Handler(BaseHTTPRequestHandler):
    server: Origin

    def do_GET(self) -> None:
        wanted = self.headers.get("Range")
        name = self.path.removeprefix("/data/")
        self.server.asked.append((name, wanted))
        if self.server.status or name not in self.server.content:
            self.send_error(self.server.status or 404)
            return
        body = self.server.content[name]
        partial = wanted is not None and self.server.knows_range
        if partial:
            body = body[int(re.fullmatch(r"bytes=(\d+)-", wanted)[1]) :]
        self.send_response(206 if partial else 200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        cut = self.server.cut_after.pop(0) if self.server.cut_after else None
        self.wfile.write(body[:cut])

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def origin(monkeypatch: pytest.MonkeyPatch) -> Iterator[Origin]:
    entry = fetching.RegisteredDataSet(
        title="Two takes",
        origin="a test",
        base_url="https://nowhere.invalid/",
        recipe="cmu-dance",
        files=tuple(
            fetching.RegisteredFile(path=path, size_bytes=len(body), sha256=hashlib.sha256(body).hexdigest())
            for path, body in CONTENT.items()
        ),
    )
    monkeypatch.setattr(fetching, "registry", lambda: {"cmu-dance": entry})
    server = Origin()
    thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield server
    server.shutdown()
    server.server_close()
    thread.join()


def arrived(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*.bvh*")}


def test_everything_arrives_with_the_recipe_beside_it(origin: Origin, tmp_path: Path) -> None:
    told: list[str] = []

    def progress(items, *, label, total):
        told.append(f"{label}: {total}")
        return items

    folder = fetching.fetch("cmu-dance", tmp_path / "takes", progress, base_url=origin.url)
    assert arrived(folder) == CONTENT
    assert told == ["Fetching cmu-dance: 2"]
    recipe = find_recipe(folder)
    assert recipe.data_set == "cmu-dance"
    rule = recipe.rule("salsa/01.bvh")
    assert rule is not None
    assert rule.frame_rate_hz == 60.0


def test_a_second_call_asks_for_nothing(origin: Origin, tmp_path: Path) -> None:
    fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    (tmp_path / "library.toml").write_text("mine")
    origin.asked.clear()
    fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    assert origin.asked == []
    assert (tmp_path / "library.toml").read_text() == "mine"


def test_a_cut_connection_is_taken_up_where_it_broke_off(origin: Origin, tmp_path: Path) -> None:
    origin.cut_after = [30_000, 25_000]
    fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    assert arrived(tmp_path) == CONTENT
    ranges = [wanted for name, wanted in origin.asked if name == "salsa/01.bvh"]
    assert ranges == [None, "bytes=30000-", "bytes=55000-"]


def test_what_has_arrived_is_kept_for_the_next_call(origin: Origin, tmp_path: Path) -> None:
    origin.cut_after = [10_000, 10_000, 10_000]
    with pytest.raises(InputError, match=r"broke off 3 times; run the same command again"):
        fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    assert {name: len(body) for name, body in arrived(tmp_path).items()} == {"salsa/01.bvh.part": 30_000}
    fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    assert ("salsa/01.bvh", "bytes=30000-") in origin.asked
    assert arrived(tmp_path) == CONTENT


def test_a_server_without_ranges_sends_all_again(origin: Origin, tmp_path: Path) -> None:
    origin.knows_range = False
    origin.cut_after = [30_000]
    fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    assert arrived(tmp_path) == CONTENT


def test_a_corrupted_file_is_refused_and_thrown_away(origin: Origin, tmp_path: Path) -> None:
    origin.content["indian/04.bvh"] = b"\x01" + CONTENT["indian/04.bvh"][1:]
    with pytest.raises(InputError, match=r"indian/04\.bvh: what arrived is not the file of the registry"):
        fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    assert list(arrived(tmp_path)) == ["salsa/01.bvh"]


def test_a_file_of_another_length_is_refused(origin: Origin, tmp_path: Path) -> None:
    origin.content["salsa/01.bvh"] = b"moved"
    with pytest.raises(InputError, match="not as long as the registry says"):
        fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)


def test_a_spoilt_half_is_replaced_by_the_next_call(origin: Origin, tmp_path: Path) -> None:
    (tmp_path / "salsa").mkdir()
    (tmp_path / "salsa/01.bvh.part").write_bytes(b"x" * 20_000)
    with pytest.raises(InputError, match="SHA-256 differs"):
        fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)
    assert arrived(tmp_path) == CONTENT


def test_an_answer_that_refuses_is_told(origin: Origin, tmp_path: Path) -> None:
    origin.status = 503
    with pytest.raises(InputError, match="the server answers 503"):
        fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)


@pytest.mark.usefixtures("origin")
def test_offline_is_one_sentence(tmp_path: Path) -> None:
    gone = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    port = gone.server_address[1]
    gone.server_close()
    with pytest.raises(InputError, match=r"cannot be reached .*; check the network connection"):
        fetching.fetch("cmu-dance", tmp_path, base_url=f"http://127.0.0.1:{port}")


def test_a_folder_that_cannot_be_written_is_one_sentence(origin: Origin, tmp_path: Path) -> None:
    (tmp_path / "salsa").write_text("a file where a folder should be")
    with pytest.raises(InputError, match=r"salsa: cannot be written \(.*\); choose a folder"):
        fetching.fetch("cmu-dance", tmp_path, base_url=origin.url)


@pytest.mark.usefixtures("origin")
@pytest.mark.parametrize(
    ("name", "base_url", "message"),
    [
        ("cmu-dnace", None, "no public data set is called 'cmu-dnace'; choose cmu-dance"),
        ("cmu-dance", "file:///etc", "is not a web address"),
    ],
)
def test_wrong_calls(name: str, base_url: str | None, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        fetching.fetch(name, tmp_path, base_url=base_url)


def test_the_registry_pins_each_file_of_the_recipe() -> None:
    entry = fetching.registry()["cmu-dance"]
    assert entry.base_url.startswith("https://")
    assert re.search(r"/[0-9a-f]{40}/", entry.base_url)  # a commit, which cannot change
    assert len({file.path for file in entry.files}) == len(entry.files) == 34


def test_the_registry_names_the_real_files(shared_data) -> None:
    folder = shared_data("motion/cmu-bvh-acrnn")
    for file in fetching.registry()["cmu-dance"].files[::11]:
        body = lzma.decompress((folder / f"{file.path}.xz").read_bytes())
        assert (len(body), hashlib.sha256(body).hexdigest()) == (file.size_bytes, file.sha256)

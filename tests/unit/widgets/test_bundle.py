"""What runs in the browser is what the sources say, works offline, and never makes markup of data."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

import pytest

import studykit.reports
import studykit.widgets

WIDGETS = Path(studykit.widgets.__file__).parent
BUNDLES = {
    path.name: path.read_text(encoding="utf-8")
    for path in (WIDGETS / "bundle.js", Path(studykit.reports.__file__).parent / "player.js")
}


def sources() -> dict[str, bytes]:
    """Give what the bundles are built from, by path."""
    files = [path for folder in WIDGETS.glob("*/src") for path in folder.rglob("*") if path.is_file()]
    files += [WIDGETS / "player" / name for name in ("package-lock.json", "build.mjs")]
    files.append(WIDGETS / "style.css")
    return {path.relative_to(WIDGETS).as_posix(): path.read_bytes() for path in files}


def digest(files: dict[str, bytes]) -> str:
    """Give the digest as build.mjs does: path, NUL, content, NUL."""
    found = hashlib.sha256()
    for path in sorted(files):
        found.update(path.encode() + b"\0" + files[path] + b"\0")
    return found.hexdigest()


@pytest.fixture(params=sorted(BUNDLES))
def bundle(request: pytest.FixtureRequest) -> str:
    """Give what runs in notebooks, and what runs in pages of dances."""
    return BUNDLES[request.param]


def test_the_bundle_was_built_from_these_sources(bundle: str) -> None:
    assert digest(sources()) in bundle.split("\n", 1)[0], 'run "make widgets"'


def test_a_changed_source_would_be_noticed(bundle: str) -> None:
    files = sources()
    assert len(files) >= 12
    for path in files:
        assert digest(files | {path: files[path] + b" "}) not in bundle.split("\n", 1)[0]


def test_the_bundle_asks_nobody_for_anything(bundle: str) -> None:
    code = bundle.split("*/", 1)[1]
    assert not re.search(r"\bimport\s*[\"'(]|\bfrom\s*[\"']https?:", code)
    own = b"\n".join(content for path, content in sources().items() if path.endswith(".js")).decode()
    own = own.replace('"http://www.w3.org/2000/svg"', "")  # a name that nobody is asked for
    assert not re.search(r"https?://|\bfetch\(|XMLHttpRequest|WebSocket|\beval\(", own)


def test_the_bundle_of_pages_carries_its_styles_and_does_not_end_their_script() -> None:
    code = BUNDLES["player.js"]
    assert ".sk-stage" in code
    assert not re.search(r"</script|<!--", code, re.IGNORECASE)


def test_data_enter_the_page_as_text_only() -> None:
    own = b"\n".join(content for path, content in sources().items() if path.endswith(".js")).decode()
    assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|DOMParser", own)


def test_the_licence_of_what_is_bundled_comes_along(bundle: str) -> None:
    banner = bundle.split("*/", 1)[0]
    assert "three.js authors" in banner
    assert "Permission is hereby granted" in banner


def test_every_bundled_package_is_pinned_with_its_digest() -> None:
    lock = json.loads((WIDGETS / "player" / "package-lock.json").read_text())
    declared = json.loads((WIDGETS / "player" / "package.json").read_text())
    packages = {name: package for name, package in lock["packages"].items() if name}
    assert all(package["integrity"].startswith("sha512-") for package in packages.values())
    for name, version in (declared["dependencies"] | declared["devDependencies"]).items():
        assert packages[f"node_modules/{name}"]["version"] == version

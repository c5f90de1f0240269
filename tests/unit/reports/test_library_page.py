"""A library on one page: all that it holds and all that it does not, in one file."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from studykit.core.errors import InputError
from studykit.io.bvh import bvh_text
from studykit.io.datasets.read import find_recipe
from studykit.library import make_sample
from studykit.library.build import build
from studykit.library.sample import synthetic_takes
from studykit.reports.library_page import library_page


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("libraries") / "sample"
    make_sample(out, segments=60, seed=1)
    return out


def test_the_page_says_what_the_library_holds_and_that_it_is_made_up(sample: Path) -> None:
    text = library_page(sample).read_text()
    assert "SYNTHETIC MOVEMENT" in text
    for words in (
        "60 segments",
        "synthetic-kick",
        "CC0-1.0",
        "56.5 to 147.2",
        "the paper, intense; hard",
        "mass in kg",
    ):
        assert words in text
    assert text.count("<figure>") == text.count("data:image/svg+xml;base64,") == 6
    assert not re.search(r'(?:src|href)="https?:', text)  # nothing is fetched


def test_the_same_library_gives_the_same_page(sample: Path) -> None:
    first = library_page(sample).read_bytes()
    assert library_page(sample).read_bytes() == first


def test_what_was_left_out_is_listed_as_text(tmp_path: Path) -> None:
    folder = tmp_path / "takes"
    folder.mkdir()
    (folder / "library.toml").write_text(
        'data_set = "own"\nlicence = "ours"\nskeleton = "smpl"\nunits_m = 0.01\n'
    )
    for source in synthetic_takes(20, seed=1):
        (folder / f"{source.name}.bvh").write_text(bvh_text(source.takes()[0].motion))
    (folder / "a<b>broken.bvh").write_text("nonsense")
    build({folder: find_recipe(folder)}, tmp_path / "library")
    text = library_page(tmp_path / "library").read_text()
    assert "1 file could not be used" in text
    assert "a&lt;b&gt;broken.bvh, line 1: not BVH" in text
    assert "a<b>" not in text
    shutil.rmtree(folder)
    without = library_page(tmp_path / "library").read_text()
    assert without.count("data:image/svg+xml;base64,") == 5
    assert "the source of" in without or "no such folder" in without


def test_a_folder_that_is_no_library(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not a dance library"):
        library_page(tmp_path)

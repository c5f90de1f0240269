"""All importers, by name."""

from __future__ import annotations

from studykit.io.datasets.bvh import BvhFiles
from studykit.io.datasets.dataset import Dataset

DATASETS: dict[str, Dataset] = {dataset.name: dataset for dataset in (BvhFiles(),)}
"""What studykit can read; a recipe's `format` names one of them."""

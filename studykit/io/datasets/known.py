"""All importers, by name."""

from __future__ import annotations

from studykit.io.datasets.aioz_gdance import AiozGdance
from studykit.io.datasets.aistpp import AistPlusPlus
from studykit.io.datasets.aistpp_keypoints import AistPlusPlusKeypoints
from studykit.io.datasets.amass import Amass
from studykit.io.datasets.asf_amc import AsfAmcFiles
from studykit.io.datasets.bvh import BvhFiles
from studykit.io.datasets.dataset import Dataset
from studykit.io.datasets.finedance import FineDance
from studykit.io.datasets.markers import MarkerTables
from studykit.io.datasets.positions import JointTables
from studykit.io.datasets.smpl_npz import SmplNpz

DATASETS: dict[str, Dataset] = {
    dataset.name: dataset
    for dataset in (
        AiozGdance(),
        AistPlusPlus(),
        AistPlusPlusKeypoints(),
        Amass(),
        AsfAmcFiles(),
        BvhFiles(),
        FineDance(),
        JointTables(),
        MarkerTables(),
        SmplNpz(),
    )
}
"""What studykit can read; a recipe's `format` names one of them."""

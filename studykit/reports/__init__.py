"""Recordings to tables, figures and one document."""

from studykit.reports.analyse import analyse as analyse
from studykit.reports.trials import dances as dances
from studykit.reports.trials import paces as paces
from studykit.reports.trials import trials as trials

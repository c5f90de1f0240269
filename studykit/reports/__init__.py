"""Recordings to tables, figures and one document."""

from studykit.reports.analyse import analyse as analyse
from studykit.reports.choices import Choices as Choices
from studykit.reports.curves import asked_energy as asked_energy
from studykit.reports.curves import curves as curves
from studykit.reports.draw import draw as draw
from studykit.reports.draw import figure as figure
from studykit.reports.library_page import library_page as library_page
from studykit.reports.report import read_trials as read_trials
from studykit.reports.report import report as report
from studykit.reports.trials import dances as dances
from studykit.reports.trials import joint_energies as joint_energies
from studykit.reports.trials import paces as paces
from studykit.reports.trials import trials as trials

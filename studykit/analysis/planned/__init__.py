"""What the protocol declares, made: one module for each kind of comparison."""

from studykit.analysis.planned.course import Course as Course
from studykit.analysis.planned.run import Courses as Courses
from studykit.analysis.planned.run import run as run

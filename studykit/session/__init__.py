"""Running one participant: the plan of a visit, its steps, its state and its runner."""

from studykit.session.study import Study as Study
from studykit.session.study import open_study as open_study

"""The dance library on disk: build it from takes, make one up, fetch public ones, review, rate, open it."""

from studykit.library.build import build as build
from studykit.library.cohort import make_cohort as make_cohort
from studykit.library.dance_file import read_dances as read_dances
from studykit.library.dance_file import write_dances as write_dances
from studykit.library.measure import Settings as Settings
from studykit.library.rating import RatingSheet as RatingSheet
from studykit.library.rating import rated_targets as rated_targets
from studykit.library.rating import rating_plan as rating_plan
from studykit.library.review import decide as decide
from studykit.library.review import findings as findings
from studykit.library.review import take_again as take_again
from studykit.library.sample import make_sample as make_sample
from studykit.library.sample import make_takes as make_takes
from studykit.library.store import open_library as open_library
from studykit.library.store import read_takes as read_takes

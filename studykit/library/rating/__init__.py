"""Letting dancers say what is light, intense, easy and hard in a library (section 5.6 of the paper).

Make a plan with `rating_plan`, show each window with `window_motion`, keep the answers on a `RatingSheet`,
and turn them into targets with `rated_targets`.
"""

from studykit.library.rating.plan import PLAN_COLUMNS as PLAN_COLUMNS
from studykit.library.rating.plan import SCALES as SCALES
from studykit.library.rating.plan import rating_plan as rating_plan
from studykit.library.rating.plan import window_motion as window_motion
from studykit.library.rating.sheet import RatingSheet as RatingSheet
from studykit.library.rating.sheet import plan_of_sheet as plan_of_sheet
from studykit.library.rating.targets import LEAST_WINDOWS as LEAST_WINDOWS
from studykit.library.rating.targets import RatedTargets as RatedTargets
from studykit.library.rating.targets import rated_targets as rated_targets

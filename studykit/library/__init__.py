"""The dance library on disk: build it from takes, make one up, fetch public ones, open it."""

from studykit.library.dance_file import read_dances as read_dances
from studykit.library.dance_file import write_dances as write_dances
from studykit.library.sample import make_sample as make_sample
from studykit.library.store import open_library as open_library

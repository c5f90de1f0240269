"""The dance library on disk: build it from takes, make one up, fetch public ones, open it."""

from studykit.library.sample import make_sample as make_sample
from studykit.library.store import open_library as open_library

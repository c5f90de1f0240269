"""Choosing and arranging segments into dances; pure functions of explicit seeds."""

from studykit.choreography.choreograph import choreograph as choreograph

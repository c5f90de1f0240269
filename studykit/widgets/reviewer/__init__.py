"""The review of takes: see what was flagged, decide what is kept and what is cut."""

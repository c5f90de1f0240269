"""The library browser: find a segment, see it move, read where it comes from."""

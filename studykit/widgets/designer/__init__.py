"""The dance designer: say what a dance shall be like, see how close it came, watch it."""

"""Choosing and arranging segments into dances; pure functions of explicit seeds."""

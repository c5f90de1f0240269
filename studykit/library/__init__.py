"""The dance library on disk: build it from takes, make one up, fetch public ones, open it."""

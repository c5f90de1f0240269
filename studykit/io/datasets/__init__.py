"""Collections of recorded dances, each in its native format: one module and one shape each."""

"""Running one participant: the plan of a visit, its steps, its state and its runner."""

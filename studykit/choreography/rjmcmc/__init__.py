"""The search for a dance: reversible-jump Markov chain Monte Carlo with annealing (section 5.6, Eq. 13)."""

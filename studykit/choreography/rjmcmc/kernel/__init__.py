"""The search in compiled form: the same as `rjmcmc.reference`, every change in constant time."""

"""The costs of a dance, one module a term (Eq. 2, 4, 6, 9, 12), and their sum (Eq. 1)."""

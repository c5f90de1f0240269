"""The costs of a dance: of its blocks (Eq. 2, 6, 9, 12, 14), its joins (Eq. 4), and their sum (Eq. 1)."""

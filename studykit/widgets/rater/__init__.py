"""The blinded rating: dances one after the other, two questions each, and nothing that could sway."""

"""Everything written during a session, and the Motion-BIDS files derived from it."""

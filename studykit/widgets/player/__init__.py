"""The player: one figure that moves, on the browser's own clock."""

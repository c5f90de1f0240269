"""Things that produce timed samples: cameras, heart-rate belts and the clocks they run on."""

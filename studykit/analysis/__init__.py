"""From samples to numbers: heart rate, movement, enjoyment and the tests that the protocol declares."""

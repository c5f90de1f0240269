"""A simulated person: how the heart, the movement and the answers follow what a dance asks for."""

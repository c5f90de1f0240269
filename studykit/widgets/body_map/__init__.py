"""The body map: click the joints that are to be spared."""

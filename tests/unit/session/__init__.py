"""Tests of the session room; a package because another room has a module of the same name."""

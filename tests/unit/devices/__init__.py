"""Tests of the devices room; a package because another room has a module of the same name."""

"""Tests of the analysis room; a package because another room has a module of the same name."""

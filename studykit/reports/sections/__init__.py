"""The sections of a study's report: each turns results and recordings into blocks of a document."""

"""Words that every layer shares; imports nothing else of studykit."""

"""studykit: design, run and analyse clinical studies of personalised dance exergames."""

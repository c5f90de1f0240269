"""The study on paper: conditions, their order, questionnaires, thresholds and the analysis plan."""

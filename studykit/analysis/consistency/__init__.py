"""Whether numbers can be true together: published claims, and a study's own results."""

from studykit.analysis.consistency.finding import Finding as Finding
from studykit.analysis.consistency.own_results import check_results as check_results
from studykit.analysis.consistency.text import check_text as check_text

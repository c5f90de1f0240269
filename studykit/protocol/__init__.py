"""The study on paper: conditions, their order, questionnaires, thresholds and the analysis plan."""

from studykit.protocol.latin_square import assignment as assignment
from studykit.protocol.latin_square import balance as balance
from studykit.protocol.study_protocol import StudyProtocol as StudyProtocol

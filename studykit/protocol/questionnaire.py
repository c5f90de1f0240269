"""What people are asked: the enjoyment scale and the question about smoothness."""

from __future__ import annotations

from dataclasses import dataclass

PACES_NAME = "PACES-18"
"""Physical Activity Enjoyment Scale, 18 bipolar items of 7 points (Kendzierski and DeCarlo 1991)."""
LOWEST, HIGHEST = 1, 7
SMOOTHNESS_ANCHORS = ("strongly disagree", "strongly agree")


@dataclass(frozen=True, kw_only=True, slots=True)
class Item:
    """One line of a questionnaire with a pole at each end.

    Parameters
    ----------
    number : int
        Place in the questionnaire, from 1.
    left, right : str
        What answering 1 and 7 means.
    is_reversed : bool
        Whether the pleasant pole is the left one, so that the answer is turned round before summing.
    """

    number: int
    left: str
    right: str
    is_reversed: bool

    @property
    def name(self) -> str:
        """Column of the item in tables, such as ``item_01``."""
        return f"item_{self.number:02d}"

    def keyed(self, answer: int) -> int:
        """Turn an answer round where the pleasant pole is the left one: 8 minus the answer.

        Doing it twice gives the answer back.

        Parameters
        ----------
        answer : int
            What was ticked, 1 to 7.

        Raises
        ------
        ValueError
            If the answer lies outside 1 to 7.

        Examples
        --------
        >>> PACES[0].keyed(1), PACES[1].keyed(1)
        (7, 1)
        """
        if not LOWEST <= answer <= HIGHEST:
            raise ValueError(f"an answer lies between {LOWEST} and {HIGHEST}, not at {answer}")
        return LOWEST + HIGHEST - answer if self.is_reversed else answer


# Short paraphrases: the wording of the scale belongs to its publisher, and a study uses the original form.
_POLES: tuple[tuple[str, str, bool], ...] = (
    ("a joy for me", "hateful to me", True),
    ("boring", "interesting", False),
    ("not to my liking", "to my liking", False),
    ("a pleasure", "no pleasure", True),
    ("I was lost in it", "my mind was elsewhere", True),
    ("not fun", "great fun", False),
    ("gives me energy", "tires me out", True),
    ("makes me sad", "makes me glad", False),
    ("agreeable", "disagreeable", True),
    ("my body felt well", "my body felt unwell", True),
    ("livens me up", "does not liven me up", True),
    ("frustrating", "not frustrating", False),
    ("rewarding", "not rewarding", True),
    ("thrilling", "not thrilling", True),
    ("leaves me unmoved", "rouses me", False),
    ("I achieved a lot", "I achieved nothing", True),
    ("freshens me up", "does not freshen me up", True),
    ("I wished for something else", "I wished for nothing else", False),
)

PACES: tuple[Item, ...] = tuple(
    Item(number=number, left=left, right=right, is_reversed=is_reversed)
    for number, (left, right, is_reversed) in enumerate(_POLES, start=1)
)
"""The 18 items with the poles of the scale in words of our own."""
PACES_REVERSED: tuple[int, ...] = tuple(item.number for item in PACES if item.is_reversed)
"""Numbers of the items whose pleasant pole is the left one."""

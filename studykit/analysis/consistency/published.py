"""The numbers of the paper whose study the default protocol follows, written as claims.

Tang, X. et al. Personalized Dance Synthesis Based on Physical and Cognitive Intensities, section 6.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True, slots=True)
class Published:
    """One printed result.

    Parameters
    ----------
    about : str
        What it is about, for a reader.
    result : str
        Name of the test or correlation of the default protocol that answers the same question, or
        "enjoyment"; empty if none does.
    claim : str
        What is printed, as a claim.
    is_printed : bool
        False if something was added that the paper does not print but its text implies or a reader may ask.
    """

    about: str
    result: str
    claim: str
    is_printed: bool = True


PUBLISHED = (
    Published(
        about="mean heart rate by condition",
        result="heart_rate",
        claim="Friedman chi2(3)=30.00, p<.001, W=0.50, n=20",
    ),
    Published(
        about="the same, if both intense dances lie above both light ones in everybody, "
        "as 0.00 and 2.56 % against 66.17 and 73.67 % of vigorous time suggest",
        result="",
        claim="Friedman chi2(3)=30.00, n=20, separated=2+2",
        is_printed=False,
    ),
    Published(
        about="distance between dancer and guide by condition",
        result="movement",
        claim="Friedman chi2(3)=30.0, p<.001, W=0.50, n=20",
    ),
    Published(
        about="all six pairs of conditions, in heart rate and in distance",
        result="",
        claim="Wilcoxon, pairs=6, p<.01, n=20",
    ),
    Published(
        about="the same with the correction named beside the smoothness ratings",
        result="",
        claim="Wilcoxon, pairs=6, Bonferroni, p<.01, n=20",
        is_printed=False,
    ),
    Published(
        about="heart rate against the energy of the dance", result="heart_rate_energy", claim="r=.883, p<.001"
    ),
    Published(
        about="the same, if each of four conditions is one point",
        result="",
        claim="r=.883, p<.001, n=4",
        is_printed=False,
    ),
    Published(
        about="distance against the variety of the dance", result="movement_variety", claim="r=.897, p=.031"
    ),
    Published(
        about="smoothness ratings by condition",
        result="smoothness",
        claim="Friedman chi2(7)=18.53, p<.01, n=20",
    ),
    Published(about="enjoyment", result="enjoyment", claim="items=18, scale=1-7, 85 %"),
    Published(
        about="time at vigorous intensity in a dance of 32 s that begins at rest, mean age 25.3",
        result="",
        claim="vigorous=73.67 % of 32 s, age=25.3, rest=80, tau=30",
        is_printed=False,
    ),
)
"""Every printed result that can be checked, in the order of the paper."""


def example() -> str:
    """Give all of them as one text, a claim a line."""
    return "\n".join(f"{published.about}: {published.claim}" for published in PUBLISHED)

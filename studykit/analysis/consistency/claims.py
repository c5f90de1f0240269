"""Reading printed statistics: what a rounded number stands for, and which numbers belong together.

A claim is what one sentence of a paper says, such as "chi2(3) = 30.00, p < .001, W = 0.50, n = 20". Claims
are separated by semicolons or line ends, and what stands before a colon is only a name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

from studykit.core.errors import InputError

NOTATION = 'write numbers as in "chi2(3)=30.00, p<.001, W=0.50, n=20", with ";" between claims'

WORDS = {
    "friedman": "friedman", "wilcoxon": "wilcoxon", "bonferroni": "bonferroni", "holm": "holm",
    "exact": "exact", "permutation": "exact", "one-sided": "one-sided", "one-tailed": "one-sided",
    "two-sided": "two-sided", "two-tailed": "two-sided", "no ties": "no ties", "without ties": "no ties",
    "and": "", "with": "", "test": "",
}  # fmt: skip
"""Words that say how a number came about."""

_NAMES = {
    "chi2": "chi2", "f": "f", "t": "t", "z": "z", "r": "r", "w": "w", "v": "v", "w+": "v", "p": "p", "n": "n",
    "m": "mean", "mean": "mean", "sd": "sd", "items": "items", "pairs": "pairs", "age": "age", "rest": "rest",
    "tau": "tau", "count": "count", "percent": "percent", "vigorous": "percent",
}  # fmt: skip
_SPELLINGS = (
    (r"\\?chi[\s-]*squared?(?![a-z])|\\chi\s*\^?\{?2\}?|[χΧ]\s*\^?[²2]|\bX\^?[²2]|chi²|chi\^2", "chi2"),
    (r"[−–]", "-"),
    (r"≤|\\leq?(?![a-z])|<=", "≤"),
    (r"≥|\\geq?(?![a-z])|>=", "≥"),
    (r"≈", "="),
    (r"[$\\]", ""),
    (r"\bns\b|\bn\.s\.", "p>.05"),
)
_NUMBER = r"[+-]?(?:\d{1,15}(?:\.\d{0,20})?|\.\d{1,20})(?:[eE][+-]?\d{1,2})?"
_ITEM = re.compile(
    rf"""
      (?P<count>\d+)\s*(?:/|(?:out\ )?of)\s*(?P<all>\d+)\s*[=(]\s*(?P<share>{_NUMBER})\s*%\)?
    | (?P<sum>{_NUMBER}(?:\s*\+\s*{_NUMBER})+)\s*=\s*(?P<total>{_NUMBER})
    | (?P<range>scale|separated)\s*=\s*(?P<first>\d+)\s*(?:-|to|\+)\s*(?P<second>\d+)
    | (?P<name>[A-Za-z]\w*\+?)\s*(?:\((?P<df>[^)]*)\))?\s*(?P<relation>[=<>≤≥])\s*(?P<value>{_NUMBER})\s*%?
      (?:\s*of\s*(?P<seconds>{_NUMBER})\s*s\b)?
    | (?P<percent>{_NUMBER})\s*%(?:\s*of\s*(?P<of>{_NUMBER})\s*s\b)?
    | (?P<word>{"|".join(re.escape(word) for word in sorted(WORDS, key=len, reverse=True))})\b
    """,
    re.VERBOSE | re.IGNORECASE,
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Printed:
    """A number as printed: the interval of values that would be rounded to it.

    Parameters
    ----------
    value : float
        What is printed.
    half : float
        Half of the last digit's place.
    relation : {"=", "<", ">", "≤", "≥"}
        What stands before it.
    df : tuple of float
        Degrees of freedom in the parentheses before it.
    """

    value: float
    half: float = 0.0
    relation: str = "="
    df: tuple[float, ...] = ()

    @classmethod
    def read(cls, text: str, *, relation: str = "=", df: tuple[float, ...] = ()) -> Printed:
        """Read a number from its digits.

        Examples
        --------
        >>> Printed.read("30.0").low, Printed.read("30.00").low
        (29.95, 29.995)
        """
        number = Decimal(text)
        exponent = number.as_tuple().exponent
        half = Decimal(5).scaleb(int(exponent) - 1)
        return cls(value=float(number), half=float(half), relation=relation, df=df)

    @property
    def low(self) -> float:
        """The smallest value that is printed so."""
        return float(Decimal(repr(self.value)) - Decimal(repr(self.half)))

    @property
    def high(self) -> float:
        """The largest value that is printed so."""
        return float(Decimal(repr(self.value)) + Decimal(repr(self.half)))

    def allows(self, low: float, high: float) -> bool:
        """Tell whether some value from `low` to `high` could have been printed so."""
        slack = 1e-9 * max(1.0, abs(self.value))
        if self.relation in "<≤":
            return low < self.value or (self.relation == "≤" and low <= self.value + slack)
        if self.relation in ">≥":
            return high > self.value or (self.relation == "≥" and high >= self.value - slack)
        return low <= self.high + slack and high >= self.low - slack


@dataclass(frozen=True, kw_only=True, slots=True)
class Claim:
    """What one sentence says.

    Parameters
    ----------
    text : str
        As it was given.
    numbers : dict of str to Printed
        By name: "chi2", "f", "t", "z", "r", "w", "v", "p", "n", "mean", "sd", "items", "pairs", "percent" ...
    words : frozenset of str
        Those of `WORDS` that it uses.
    sums : tuple
        Sums, each the parts and the total.
    """

    text: str
    numbers: dict[str, Printed]
    words: frozenset[str]
    sums: tuple[tuple[tuple[Printed, ...], Printed], ...] = ()

    def has(self, *names: str) -> bool:
        """Tell whether all these numbers are given."""
        return all(name in self.numbers for name in names)

    def whole(self, name: str, default: int | None = None) -> int:
        """Give a count.

        Raises
        ------
        InputError
            If it is no positive whole number.
        """
        if name not in self.numbers and default is not None:
            return default
        value = self.numbers[name].value
        if value != int(value) or value < 1 or value > 10**7:
            raise InputError(
                f"{name} = {value:g} is no count", where=self.text, remedy="give a positive whole number"
            )
        return int(value)


def claims(text: str) -> tuple[Claim, ...]:
    """Read every claim of a text.

    Parameters
    ----------
    text : str
        Claims, separated by ";" or line ends; a line that begins with "#" is passed over.

    Raises
    ------
    InputError
        If something cannot be read, with the words that were not understood, or there is no claim.
    """
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    found = tuple(_claim(part.strip()) for line in lines for part in line.split(";") if part.strip())
    if not found:
        raise InputError("there is no claim to check", remedy=NOTATION)
    return found


def _claim(text: str) -> Claim:
    plain = text.rpartition(":")[2]
    for pattern, spelling in _SPELLINGS:
        plain = re.sub(pattern, spelling, plain, flags=re.IGNORECASE if "chi" in pattern else 0)
    _refuse_leftovers(plain, text)
    numbers: dict[str, Printed] = {}
    words: set[str] = set()
    sums = []
    for item in _ITEM.finditer(plain):
        if item["word"]:
            words.add(WORDS[item["word"].lower()])
        elif item["sum"]:
            parts = tuple(Printed.read(part.strip()) for part in item["sum"].split("+"))
            sums.append((parts, Printed.read(item["total"])))
        else:
            for name, number in _numbers(item, text):
                if name in numbers:
                    raise InputError(
                        f"{name} is given twice", where=text, remedy='put ";" between two claims'
                    )
                numbers[name] = number
    return Claim(text=text, numbers=numbers, words=frozenset(words - {""}), sums=tuple(sums))


def _refuse_leftovers(plain: str, text: str) -> None:
    for left in _ITEM.sub("\0", plain).split("\0"):
        if rest := left.strip(" \t,.()"):
            raise InputError(f'"{rest}" cannot be read', where=text, remedy=NOTATION)


def _numbers(item: re.Match[str], text: str) -> Iterator[tuple[str, Printed]]:
    """Give the numbers of an item by name."""
    if item["count"]:
        yield from (("count", _exact(item["count"])), ("n", _exact(item["all"])))
        yield "percent", Printed.read(item["share"])
    elif item["range"]:
        kind = item["range"].lower()
        yield from ((f"{kind}_first", _exact(item["first"])), (f"{kind}_second", _exact(item["second"])))
    elif item["percent"]:
        yield "percent", Printed.read(item["percent"])
        if item["of"]:
            yield "seconds", Printed.read(item["of"])
    else:
        yield from _statistic(item, text)


def _statistic(item: re.Match[str], text: str) -> Iterator[tuple[str, Printed]]:
    # A capital T without degrees of freedom is the smaller sum of signed ranks.
    spelt = "v" if item["name"] == "T" and not item["df"] else item["name"].lower()
    if spelt not in _NAMES:
        raise InputError(f'"{item["name"]}" is no statistic known here', where=text, remedy=NOTATION)
    degrees = []
    for part in (item["df"] or "").split(","):
        name, equals, value = part.rpartition("=")
        if not re.fullmatch(_NUMBER, value.strip()):
            if value.strip():
                raise InputError(f'"({item["df"]})" cannot be read', where=text, remedy=NOTATION)
        elif equals and name.strip().lower() == "n":
            yield "n", Printed.read(value.strip())
        else:
            degrees.append(float(value))
    yield _NAMES[spelt], Printed.read(item["value"], relation=item["relation"], df=tuple(degrees))
    if item["seconds"]:
        yield "seconds", Printed.read(item["seconds"])


def _exact(digits: str) -> Printed:
    return Printed(value=float(digits))

"""Classes of equality, which state how closely two results must agree."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from fnmatch import fnmatchcase
from pathlib import Path

import yaml

from provenance.content import Content
from tusqh.errors import ConfigError


class Equality(StrEnum):
    """Classes of equality, from the strictest to the weakest."""

    #: The same bytes.
    EXACT = "exact"
    #: Texts and integers are equal, and real numbers agree within a tolerance.
    NUMERIC = "numeric"
    #: The results are not compared, but are made from equal inputs.
    UNCHECKED = "unchecked"


@dataclass(frozen=True, kw_only=True)
class EqualityRule:
    """The class that results with matching names must reach.

    Parameters
    ----------
    pattern
        A shell pattern for the whole path.
    equality
        The class.
    tolerance
        For `Equality.NUMERIC` the largest relative difference of real numbers, see
        `provenance.content.Numbers.difference`.
    """

    pattern: str
    equality: Equality
    tolerance: float = 0.0


class EqualityRules:
    """The class of equality of every result; the first rule with a matching pattern decides.

    Parameters
    ----------
    rules
        Rules in the order in which they are tried.  A result that matches no rule must be exact.

    Examples
    --------
    >>> rules = EqualityRules([EqualityRule(pattern="*.png", equality=Equality.UNCHECKED)])
    >>> str(rules.of("results/bay/diagram.png").equality), str(rules.of("a.csv").equality)
    ('unchecked', 'exact')
    """

    def __init__(self, rules: Sequence[EqualityRule] = ()) -> None:
        self._rules = [*rules, EqualityRule(pattern="*", equality=Equality.EXACT)]

    @classmethod
    def from_file(cls, path: Path) -> EqualityRules:
        """Return the rules in a YAML file, or no rules if the file does not exist.

        Parameters
        ----------
        path
            The file.

        Raises
        ------
        ConfigError
            The file is not a list of rules.
        """
        if not path.is_file():
            return cls()
        try:
            entries = yaml.safe_load(path.read_text("utf-8"))
            return cls(
                [
                    EqualityRule(**entry | {"equality": Equality(entry["equality"])})
                    for entry in entries
                ]
            )
        except (OSError, ValueError, KeyError, TypeError, yaml.YAMLError) as reason:
            raise ConfigError(
                f"cannot be read: {reason}",
                where=str(path),
                expected="a YAML list of entries with pattern, equality (exact, numeric or "
                "unchecked) and, for numeric, tolerance",
                remedy="correct the entry",
            ) from reason

    def of(self, path: str) -> EqualityRule:
        """Return the rule for a result.

        Parameters
        ----------
        path
            The result, relative to the current folder.
        """
        return next(rule for rule in self._rules if fnmatchcase(path, rule.pattern))


def is_numerically_equal(one: Content | None, other: Content | None, tolerance: float) -> bool:
    """Return whether two contents agree within a relative tolerance; False if one is unknown.

    Parameters
    ----------
    one
        The first content; None if it is unknown.
    other
        The second content; None if it is unknown.
    tolerance
        Largest relative difference that counts as equal.
    """
    return one is not None and other is not None and one.difference(other)[0] <= tolerance


def weakest(classes: Iterable[Equality]) -> Equality:
    """Return the weakest of some classes, or exact if there are none.

    Parameters
    ----------
    classes
        The classes of equality.
    """
    return max(classes, key=list(Equality).index, default=Equality.EXACT)

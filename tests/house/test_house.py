"""Rules of the house that no linter has. Exceptions are listed, each with its reason."""

import pytest

from tests.house import rules

BUDGETS = {
    rules.too_long: 4,
    rules.nested_condition: 0,
    rules.unlike_things: 28,
    rules.begins_with_what: 2,
    rules.says_little: 4,
}
"""Breaches that are left from before the rule; the numbers only fall."""


@pytest.mark.parametrize("rule", BUDGETS, ids=lambda rule: rule.__name__)
def test_breaches_of_a_rule_become_fewer(rule):
    breaches = rules.breaches(rule)
    assert len(breaches) <= BUDGETS[rule], "\n".join(map(str, breaches))


def test_a_name_has_one_meaning():
    breaches = rules.two_meanings()
    assert not breaches, "\n".join(map(str, breaches))

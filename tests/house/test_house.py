"""Rules of the house that no linter has. No module of the package breaks one."""

import pytest

from tests.house import rules

RULES = (
    rules.too_long,
    rules.nested_condition,
    rules.unlike_things,
    rules.begins_with_what,
    rules.says_little,
    rules.undocumented,
    rules.leaves_a_folder,
)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_no_module_breaks_a_rule(rule):
    breaches = rules.breaches(rule)
    assert not breaches, "\n".join(map(str, breaches))


def test_a_text_of_the_library_names_arguments_and_no_option_of_the_command_line():
    own = ("orchestrator/commands/", "orchestrator/bench/")  # the latter starts commands
    found = rules.breaches(rules.names_an_option)
    breaches = [breach for breach in found if not breach.file.startswith(own)]
    assert not breaches, "\n".join(map(str, breaches))


def test_a_name_has_one_meaning():
    breaches = rules.two_meanings()
    assert not breaches, "\n".join(map(str, breaches))


def test_standard_gravity_is_written_once():
    (breach,) = rules.breaches(rules.standard_gravity)
    assert breach.file == "components/common/units.py"

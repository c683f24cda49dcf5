"""Operations of formulas that serve single numbers and vectors alike.

A formula that is written with these functions, with + - * / and with > is computed for one contact
at a time in kernels, and for eight contacts at a time where :mod:`.vector` writes instructions: the
same source, there with numbers and here with :class:`.vector.lanes.Lanes`, which bring the methods
``selected`` and ``fused``. This module does not know that class, whose module knows this one.
"""

from numba.extending import overload, register_jitable

formula = register_jitable(error_model="numpy")
"""Decorator of formulas: leaves the function as it is and lets kernels call it too."""


def where(condition, yes, no):
    """Return one of two numbers, lane by lane for vectors.

    Parameters
    ----------
    condition : bool or Lanes
        Comparison of two numbers.
    yes, no : float or Lanes
        The number where the condition holds, and where it does not.

    Returns
    -------
    float or Lanes
        The selected number.
    """
    if hasattr(condition, "selected"):
        return condition.selected(yes, no)
    return yes if condition else no


def multiply_add(one, other, added):
    """Return ``one * other + added``.

    Single numbers are rounded twice, as the formula is written; vectors once, whatever processor
    they are computed on.

    Parameters
    ----------
    one, other, added : float or Lanes
        Factors and summand, all of the same type.

    Returns
    -------
    float or Lanes
        The sum.
    """
    if hasattr(one, "fused"):
        return one.fused(other, added)
    return one * other + added


@overload(where, jit_options={"error_model": "numpy"})
def _where_of_numbers(condition, yes, no):
    return lambda condition, yes, no: yes if condition else no


@overload(multiply_add, jit_options={"error_model": "numpy"})
def _multiply_add_of_numbers(one, other, added):
    return lambda one, other, added: one * other + added


@formula
def larger(one, other):
    """Return the larger of two numbers, ``other`` where they are equal.

    Parameters
    ----------
    one, other : float or Lanes
        The numbers.

    Returns
    -------
    float or Lanes
        The larger one.
    """
    return where(one > other, one, other)


@formula
def smaller(one, other):
    """Return the smaller of two numbers, ``one`` where they are equal.

    Parameters
    ----------
    one, other : float or Lanes
        The numbers.

    Returns
    -------
    float or Lanes
        The smaller one.
    """
    return where(one > other, other, one)


@formula
def limited(number, limit):
    """Return a number cut off at plus and minus ``limit``.

    Parameters
    ----------
    number : float or Lanes
        The number.
    limit : float or Lanes
        Largest absolute value, not negative.

    Returns
    -------
    float or Lanes
        A number from ``-limit`` to ``limit``.
    """
    return smaller(larger(number, -limit), limit)

"""The contact law for a block of pairs of discs, eight contacts at a time and without branches.

The law itself is :mod:`..contact_law`; pairs that do not touch come out with nothing. Here are the
geometry of two discs, and the energies that add up in registers.
"""

from types import SimpleNamespace
from typing import Any

from numba import types
from numba.extending import intrinsic

from ..arithmetic import multiply_add, where
from ..contact_law import (
    Approach,
    Response,
    bridge_closure,
    capillary_energy,
    permanent_overlap,
    respond,
    slip_resistance,
    yield_loss,
)
from ..declarations import BLOCK, COLUMN, LANES, LAW, TALLY, Law
from .lanes import Access, Lanes, Running, divisor, divisors, spread, sqrt


def _constants(access: Access) -> Law:
    """Return the constants of contacts between discs, the same in all lanes."""
    law = Law(*(spread(access.builder, access.number(3, place), LANES) for place in LAW))
    return law._replace(yielding=divisor(law.yielding))


def _add(total: Running, one: Lanes, other: Lanes) -> None:
    """Add a product to a running sum."""
    total.become(multiply_add(one, other, total.now))


def _yielded(
    overlap: Lanes, before: Lanes, reach: Lanes, law: Law, sums: SimpleNamespace
) -> tuple[Lanes, Lanes, Lanes]:
    """Return elastic and permanent overlap and the capillary pull of contacts that last."""
    longest = divisor(law.bridge * reach)
    full = law.pull * reach
    grown = permanent_overlap(before, overlap, law)
    sums.plastic.become(sums.plastic.now + yield_loss(before, grown, full, law))
    permanent = where(overlap > -longest, grown, 0.0)
    elastic = overlap - permanent
    closure = bridge_closure(elastic, longest)
    sums.capillary.become(sums.capillary.now + capillary_energy(elastic, closure, longest, full))
    return elastic, permanent, full * closure


def _tally(approach: Approach, before: Lanes, response: Response, sums: SimpleNamespace) -> None:
    """Add what the contacts store and dissipate to the sums, most of it still to be scaled."""
    _add(sums.elastic, response.elastic, approach.overlap)
    _add(sums.stretched, response.spring, response.spring)
    _add(sums.normal_dashpot, response.elastic - response.normal, approach.opening)
    _add(sums.tangential_dashpot, approach.root * response.creep, response.creep)
    _add(sums.sliding, response.tangential, approach.slip - response.creep)
    _add(sums.released, before - response.kept, before)


def _contact(
    pair: SimpleNamespace,
    before: Lanes,
    permanent: Lanes | None,
    law: Law,
    dt: Lanes,
    sums: SimpleNamespace,
) -> tuple[tuple[Lanes, ...], Lanes, Lanes | None]:
    """Return the columns of forces of eight pairs, the spring forces and the permanent overlaps."""
    distance, resistance = divisors(
        sqrt(multiply_add(pair.x, pair.x, pair.y * pair.y)), slip_resistance(pair.root, law, dt)
    )
    nx, ny = pair.x / distance, pair.y / distance
    overlap = pair.reach - distance
    opening = multiply_add(pair.vx, nx, pair.vy * ny)
    slip = multiply_add(pair.vy, nx, -multiply_add(pair.vx, ny, pair.spin))
    pull = None
    if permanent is not None:
        overlap, permanent, pull = _yielded(overlap, permanent, pair.reach, law, sums)
    approach = Approach(overlap, opening, slip, pair.root)
    response = respond(approach, before, resistance, law, dt)
    _tally(approach, before, response, sums)
    normal, tangential = response.normal, response.tangential
    pressing = normal if pull is None else normal - pull
    x = multiply_add(pressing, nx, tangential * ny)
    y = multiply_add(pressing, ny, -(tangential * nx))
    return (x, y, tangential, normal), response.spring, permanent


def _block(access: Access, lasting: bool) -> None:
    """Write the loop over the contacts of a block, for the arguments of :func:`_block_law`."""
    constants = _constants(access)
    step = spread(access.builder, access[4], LANES)
    sums = SimpleNamespace(
        **{name: access.running(6, place * LANES, LANES) for name, place in TALLY._asdict().items()}
    )
    with access.lanes_of_block() as lane:
        pair = SimpleNamespace(
            **{
                name: access.load(0, access.place(lane, column * BLOCK), LANES)
                for name, column in COLUMN._asdict().items()
            }
        )
        contact = access.builder.add(access[5], lane)
        before = access.load(1, contact, LANES)
        permanent = access.load(2, contact, LANES) if lasting else None
        forces, after, permanent = _contact(pair, before, permanent, constants, step, sums)
        access.store(after, 1, contact)
        if permanent is not None:
            access.store(permanent, 2, contact)
        for column, force in enumerate(forces):
            access.store(force, 0, access.place(lane, column * BLOCK))
    for total in vars(sums).values():
        total.keep()


def _block_law(lasting: bool) -> Any:
    """Return the intrinsic for contacts that keep an overlap or stick together, or for others."""

    def block_law(typing, block, spring, plastic, law, dt, at, tally):
        """Compute the BLOCK contacts from ``at`` on, whose columns lie in ``block``.

        Parameters
        ----------
        block : ndarray of float64
            Columns of the contacts; force to the right and upwards (of the first disc on the
            second), tangential and normal force (N) come into the first four.
        spring, plastic : ndarray of float64
            Springs (N) and permanent overlaps (m), which become those after the step.
        law : ndarray of float64
            Constants of the contact.
        dt : float
            Time step (s).
        at : int
            First contact.
        tally : ndarray of float64
            The energies of TALLY, which grow.
        """

        def generate(context, builder, signature, arguments):
            _block(Access(context, builder, signature, arguments), lasting)
            return context.get_dummy_value()

        return types.void(block, spring, plastic, law, types.float64, types.int64, tally), generate

    return intrinsic(block_law)


plain_law = _block_law(lasting=False)
"""Intrinsic: the law of elastic contacts for a block of pairs."""
lasting_law = _block_law(lasting=True)
"""Intrinsic: the law of contacts that may keep an overlap or stick together."""

"""The law of contact between sand discs for a block of pairs, as vectors: contact_law.py written without branches.

What contact_law.py does for one contact is done here for eight at a time; pairs that do not touch come out with nothing. The
functions of contact_law.py are the reference in the tests.
"""

from types import SimpleNamespace
from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ..declarations import BLOCK, COLUMN, LANES, LAW, TALLY
from .lanes import INDEX, Access, Lanes, Running, fma, larger, smaller, spread, sqrt, where


def _constants(access: Access, dt: Any) -> SimpleNamespace:
    """The constants of the law, and products of them with the step, in all lanes."""
    law = SimpleNamespace(
        **{
            name: spread(access.builder, access.number(3, place), LANES)
            for name, place in LAW._asdict().items()
        }
    )
    law.dt = spread(access.builder, dt, LANES)
    law.advance = law.tangential * law.dt
    law.yielding_force = law.unloading * 0.5 * (1.0 - law.yielding) * (1.0 / law.yielding)
    return law


def _add(total: Running, one: Lanes, other: Lanes) -> None:
    """Add a product to a running sum."""
    total.become(fma(one, other, total.now))


def _lasting(
    pair: SimpleNamespace,
    overlap: Lanes,
    stays_before: Lanes,
    law: SimpleNamespace,
    sums: SimpleNamespace,
) -> tuple[Lanes, Lanes, Lanes]:
    """Contacts that yield or stick together: overlap beyond the one that stays, the one that stays, and the capillary pull."""
    bridge, full = law.bridge * pair.reach, law.pull * pair.reach
    stays = larger(law.yielding * overlap, stays_before)
    lost = (stays - stays_before) * (law.yielding_force * (stays + stays_before) - full)
    sums.plastic.become(sums.plastic.now + where(stays > stays_before, lost, 0.0))
    stays = where(overlap > -bridge, stays, 0.0)
    pressed = overlap - stays
    closed = smaller(larger(1.0 + pressed * (1.0 / bridge), 0.0), 1.0)
    sums.capillary.become(
        sums.capillary.now - full * (0.5 * bridge * closed * closed + larger(pressed, 0.0))
    )
    return pressed, stays, full * closed


def _contact(
    pair: SimpleNamespace,
    before: Lanes,
    stays: Lanes | None,
    law: SimpleNamespace,
    sums: SimpleNamespace,
) -> tuple[SimpleNamespace, Lanes, Lanes | None]:
    """Forces of eight pairs, the new spring force, and the overlap that stays where contacts last. One division serves both
    1/distance and 1/rate."""
    distance = sqrt(fma(pair.x, pair.x, pair.y * pair.y))
    rate = fma(law.tangential_damping, pair.root, law.advance)
    both = 1.0 / (distance * rate)
    inverse, per_rate = both * rate, both * distance
    nx, ny = pair.x * inverse, pair.y * inverse
    overlap, opening = pair.reach - distance, fma(pair.vx, nx, pair.vy * ny)
    slip = fma(pair.vy, nx, -fma(pair.vx, ny, pair.spin))
    pull = None
    if stays is not None:
        overlap, stays, pull = _lasting(pair, overlap, stays, law, sums)
    touching = overlap > 0.0
    elastic = law.unloading * larger(overlap, 0.0)
    normal = larger(where(touching, fma(law.damping, -(pair.root * opening), elastic), 0.0), 0.0)
    limit, spring = law.friction * normal, where(touching, before, 0.0)
    tangential = smaller(larger(fma(rate, slip, spring), -limit), limit)
    taken = (tangential - spring) * per_rate
    kept = fma(law.advance, taken, spring)
    _add(sums.elastic, elastic, overlap)
    _add(sums.stretched, kept, kept)
    _add(sums.normal_dashpot, elastic - normal, opening)
    _add(sums.tangential_dashpot, pair.root * taken, taken)
    _add(sums.sliding, tangential, slip - taken)
    _add(sums.released, before - spring, before)
    pressing = normal if pull is None else normal - pull
    force = SimpleNamespace(
        x=fma(pressing, nx, tangential * ny),
        y=fma(pressing, ny, -(tangential * nx)),
        tangential=tangential,
        normal=normal,
    )
    return force, kept, stays


def _block_law(lasting: bool) -> Any:
    def block_law(typing, block, spring, plastic, law, dt, at, tally):
        """The law for the BLOCK pairs from ``at`` on, whose columns lie in ``block``. It leaves force to the right and upwards (of
        the first on the second), tangential and normal force in the first four columns. Springs (N) and overlaps that stay (m)
        become those after the step, and the energies of TALLY grow."""

        def generate(context, builder, signature, arguments):
            access = Access(context, builder, signature, arguments)
            constants = _constants(access, access[4])
            sums = SimpleNamespace(
                **{
                    name: access.running(6, place * LANES, LANES)
                    for name, place in TALLY._asdict().items()
                }
            )
            with cgutils.for_range_slice(builder, INDEX(0), INDEX(BLOCK), INDEX(LANES)) as (
                lane,
                _,
            ):
                pair = SimpleNamespace(
                    **{
                        name: access.load(0, access.place(lane, column * BLOCK), LANES)
                        for name, column in COLUMN._asdict().items()
                    }
                )
                contact = builder.add(access[5], lane)
                stays = access.load(2, contact, LANES) if lasting else None
                force, kept, stays = _contact(
                    pair, access.load(1, contact, LANES), stays, constants, sums
                )
                access.store(kept, 1, contact)
                if stays is not None:
                    access.store(stays, 2, contact)
                for column, quantity in enumerate(
                    (force.x, force.y, force.tangential, force.normal)
                ):
                    access.store(quantity, 0, access.place(lane, column * BLOCK))
            for total in vars(sums).values():
                total.keep()
            return context.get_dummy_value()

        return types.void(block, spring, plastic, law, types.float64, types.int64, tally), generate

    return intrinsic(block_law)


plain_law, lasting_law = _block_law(lasting=False), _block_law(lasting=True)
"""The law of elastic contacts, and the one of contacts that may keep an overlap or stick together."""

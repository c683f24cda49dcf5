"""Formulas of practice for the impact of a rock on a cushion, beside which a run is held.

>>> from rockshed.formulas import RockImpact, estimates
>>> impact = RockImpact.fallen(mass=1000.0, radius=0.456, height=10.0, thickness=0.9)
>>> for estimate in estimates(impact):
...     if estimate.quantity == FORCE:
...         print(f"{estimate.name}: {estimate.value / 1e3:.0f} kN")
Japanese handbook: 609 kN
Japanese handbook, thickness factor: 613 kN
ASTRA 2008: 460 kN
Labiouse 1996: 581 kN
Hertz: 611 kN

A formula is no measurement: what its source covers, and whether the source itself could be read,
stands with every estimate.
"""

from .estimate import FORCE as FORCE
from .estimate import PENETRATION as PENETRATION
from .estimate import THICKNESS as THICKNESS
from .estimate import FormulaValue as FormulaValue
from .practice import estimates as estimates
from .rock_impact import RockImpact as RockImpact
from .shown import table_of as table_of

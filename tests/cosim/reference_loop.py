"""The exchange loop once more, call by call with numpy: what the compiled loop is compared with."""

import numpy as np

from rockshed.core.fmu.slave import WARNING
from rockshed.core.loop.exchange import Fault
from rockshed.core.loop.tables import NOT_FINITE
from rockshed.core.system.schedule import Action, Operation


class ReferenceLoop:
    """Behaves as :class:`rockshed.core.loop.exchange.ExchangeLoop`."""

    def __init__(self, buses, slaves):
        self.buses, self.slaves = buses, slaves
        self.first = np.cumsum([0, *map(len, buses.plan.schedule.operations)])

    def advance(self, first, count):
        buses, plan = self.buses, self.buses.plan
        for n in range(first, first + count):
            period = n // plan.schedule.period * plan.schedule.period
            origin = plan.timing.start + period * plan.schedule.exchange
            for operation in plan.schedule.operations[n % plan.schedule.period]:
                status = self.operate(operation, origin)
                if status > WARNING or status == NOT_FINITE:
                    return Fault(n, operation, status)
            self.post()
            self.watch(n + 1)
            if (n + 1) % buses.snapshots.every == 0:
                row = len(buses.snapshots.waiting) + len(buses.snapshots.due(first, n))
                lost = self.snapshot(row)
                if lost is not None:
                    return Fault(n, Operation(Action.RECORD, lost[0]), lost[1])
        return None

    def record(self, exchange):
        lost = self.snapshot(len(self.buses.snapshots.waiting))
        return lost and Fault(exchange - 1, Operation(Action.RECORD, lost[0]), lost[1])

    def operate(self, operation, origin):
        slave = self.slaves[operation.component]
        if operation.action is Action.SET:
            return self.buses.give(slave)
        if operation.action is Action.STEP:
            lasts = self.buses.plan.timing.lasts
            return slave.step(lasts(origin + operation.begin), lasts(operation.length))
        status = self.buses.take(slave)
        is_fine = status > WARNING or self.buses.not_finite(slave.name) is None
        return status if is_fine else NOT_FINITE

    def post(self):
        """Enter the work of one exchange."""
        channels, inputs, outputs = self.buses.channels, self.buses.inputs, self.buses.outputs
        position = outputs[channels["position"]]
        channels["taken"] += inputs[channels["given"]] * (position - channels["last_position"])
        channels["last_position"] = position
        shown = channels["seen"] >= 0
        seen, force = inputs[channels["seen"][shown]], outputs[channels["force"][shown]]
        channels["given_back"][shown] -= (
            0.5 * (force + channels["last_force"][shown]) * (seen - channels["last_seen"][shown])
        )
        channels["last_seen"][shown], channels["last_force"][shown] = seen, force

    def watch(self, exchange):
        """Enter the values after so many exchanges into extremes and integrals."""
        watched = self.buses.watched
        value = self.buses.outputs[watched["place"]]
        for bound, exceeds in (("high", value > watched["high"]), ("low", value < watched["low"])):
            watched[bound][exceeds], watched[f"{bound}_at"][exceeds] = value[exceeds], exchange
        watched["area"] += 0.5 * (watched["last"] + value)
        watched["last"] = value

    def snapshot(self, number):
        """Fill a row; return component and status where one does not give finite values."""
        buses, snapshots = self.buses, self.buses.snapshots
        row = snapshots.rows[number]
        row[: snapshots.exchanged] = buses.outputs[: snapshots.exchanged]
        row[snapshots.taken] = buses.channels["taken"]
        row[snapshots.given_back] = buses.channels["given_back"]
        for name, blocks in snapshots.blocks.items():
            for block in blocks:
                status = self.slaves[name].get(block.references, row[block.places], block.type)
                if status > WARNING:
                    return name, status
                if not np.isfinite(row[block.places]).all():
                    return name, NOT_FINITE
        return None

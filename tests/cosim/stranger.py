"""An FMU that knows nothing of this project: a damper with a few other things, and all the ways to misbehave."""

import time

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real, String
from pythonfmu.enums import Fmi2Status

PARAMETER = dict(causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)


class Stranger(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.damping, self.fail_at, self.nan_at, self.pause, self.refuses, self.label = (
            2.0,
            1e9,
            1e9,
            0.0,
            False,
            "none",
        )
        self.speed, self.level, self.enabled = 0.0, 0, True
        self.force, self.next_level, self.disabled, self.local_time = 0.0, 0, False, 0.0
        for name in ("damping", "fail_at", "nan_at", "pause"):
            self.register_variable(Real(name, **PARAMETER))
        self.register_variable(Boolean("refuses", **PARAMETER))
        self.register_variable(String("label", **PARAMETER))
        self.register_variable(Real("speed", causality=Fmi2Causality.input))
        self.register_variable(
            Integer("level", causality=Fmi2Causality.input, variability=Fmi2Variability.discrete)
        )
        self.register_variable(
            Boolean("enabled", causality=Fmi2Causality.input, variability=Fmi2Variability.discrete)
        )
        self.register_variable(Real("force", causality=Fmi2Causality.output))
        self.register_variable(
            Integer(
                "next_level", causality=Fmi2Causality.output, variability=Fmi2Variability.discrete
            )
        )
        self.register_variable(
            Boolean(
                "disabled", causality=Fmi2Causality.output, variability=Fmi2Variability.discrete
            )
        )
        self.register_variable(Real("local_time", causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        if self.refuses:
            self.log(f"{self.label} is 100% unwilling: %s %d", Fmi2Status.error)

    def do_step(self, current_time, step_size):
        time.sleep(self.pause)
        if current_time + step_size > self.fail_at:
            self.log("the damper is broken", Fmi2Status.error)
            return False
        self.local_time = current_time + step_size
        self.force = (
            float("nan")
            if self.local_time > self.nan_at
            else -self.damping * self.speed
            if self.enabled
            else 0.0
        )
        self.next_level, self.disabled = self.level + 1, not self.enabled
        return True

"""The FMU under check: its files, its description, and instances of it."""

from functools import cached_property
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.model_description import read_model_description

from ...platforms import LONGEST_HEAD, NoBinaryError, binary, this_machine
from ..verdicts import LOADING
from .calls import Called, CannotLoad, NoInstance, Trail
from .fmi2 import Called2
from .fmi3 import Called3
from .variables import Declared, declared

STEPS = 20
"""Steps of an ordinary simulation, at most."""
_STEPS_OF_EXPERIMENT = 100
"""Steps into which an experiment is divided whose step is not told."""
_NO_STEP = 1e-2
"""Communication step (s) where nothing is told."""


class Subject:
    """The FMU under check.

    Parameters
    ----------
    file : Path
        The FMU.
    folder : Path
        Where it is unpacked.
    shared : Path
        Folder through which the processes of a probe pass things on.
    trail : Path
        File that gets the name of each function that is called.
    step : float, optional
        Communication step (s); by default that of the description.
    """

    def __init__(
        self, file: Path, folder: Path, shared: Path, trail: Path, step: float | None = None
    ) -> None:
        self.file = file
        self.folder = folder
        self.shared = shared
        self.trail = Trail(trail)
        self._step = step

    # ------------------------------------------------------------------ description

    @cached_property
    def model(self) -> Any:
        """Model description of fmpy, whatever is wrong with it."""
        return read_model_description(str(self.folder), validate=False)

    @cached_property
    def version(self) -> int:
        """Major version of FMI, 2 or 3."""
        return int(self.model.fmiMajorVersion)

    @property
    def can(self) -> Any:
        """Capability flags of the co-simulation."""
        return self.model.coSimulation

    @cached_property
    def has_directional_derivatives(self) -> bool:
        """Tell whether directional derivatives are provided; fmpy has no such flag of FMI 3.0."""
        if self.version == 2:
            return bool(self.can.providesDirectionalDerivative)
        element = ElementTree.parse(self.folder / "modelDescription.xml").find("CoSimulation")
        flag = "" if element is None else element.get("providesDirectionalDerivatives", "")
        return flag in ("true", "1")

    @cached_property
    def variables(self) -> list[Declared]:
        """All variables that can be moved at any time."""
        return declared(self.model)

    @cached_property
    def readable(self) -> list[Declared]:
        """Variables that are read and compared."""
        return [v for v in self.variables if v.causality != "independent" and v.size > 0]

    @cached_property
    def outputs(self) -> list[Declared]:
        """Outputs, and where there are none, all variables."""
        found = [v for v in self.readable if v.causality == "output"]
        return found or self.readable

    def inputs(self, real: bool = False) -> list[Declared]:
        """Return the inputs, or the real ones alone."""
        found = [v for v in self.readable if v.causality == "input"]
        return [v for v in found if v.is_real or not real]

    @property
    def start(self) -> float:
        """Start of the experiment (s)."""
        return self._experiment("startTime") or 0.0

    @property
    def stop(self) -> float | None:
        """End of the experiment (s), if there is one."""
        stop = self._experiment("stopTime")
        return stop if stop is not None and stop > self.start else None

    @property
    def horizon(self) -> float | None:
        """End (s) that instances are told; None where the experiment is shorter than a probe."""
        return self.stop if self.steps >= STEPS else None

    @cached_property
    def step(self) -> float:
        """Communication step (s) of ordinary simulations."""
        told = self._step or self._experiment("stepSize") or 0.0
        fixed = float(self.can.fixedInternalStepSize or 0.0)
        if told > 0.0 or fixed > 0.0:
            return told if told > 0.0 else fixed
        if self.stop is None:
            return _NO_STEP
        return (self.stop - self.start) / _STEPS_OF_EXPERIMENT

    @property
    def has_step(self) -> bool:
        """Tell whether a communication step was asked for or stands in the description."""
        fixed = self.can.fixedInternalStepSize
        return bool(self._step or self._experiment("stepSize") or float(fixed or 0.0))

    @property
    def platform3(self) -> str:
        """Name of this machine's platform in FMI 3.0."""
        return this_machine().in_fmi3

    @cached_property
    def steps(self) -> int:
        """Number of steps of an ordinary simulation."""
        if self.stop is None:
            return STEPS
        return max(1, min(STEPS, int((self.stop - self.start) / self.step + 1e-6)))

    def _experiment(self, name: str) -> float | None:
        text = getattr(self.model.defaultExperiment, name, None)
        try:
            return None if text is None else float(text)
        except ValueError:
            return None

    # ------------------------------------------------------------------ instances

    @cached_property
    def dll(self) -> Any:
        """The library with its functions.

        Raises
        ------
        CannotLoad
            With the reason of the system.
        """
        kind = FMU3Slave if self.version == 3 else FMU2Slave
        self.trail.mark(LOADING)
        try:
            made = kind(
                guid=self.model.guid,
                unzipDirectory=str(self.folder),
                modelIdentifier=self.can.modelIdentifier,
                instanceName="check",
                libraryPath=str(self.library),
            )
        except NoBinaryError as error:
            raise CannotLoad(f"it {error}") from error
        except Exception as error:  # fmpy raises plain ones
            raise CannotLoad(str(error)) from error
        return made.dll

    @cached_property
    def library(self) -> Path:
        """File of the library for this machine.

        Raises
        ------
        NoBinaryError
            There is none.
        """
        files = {
            path.relative_to(self.folder).as_posix(): path
            for path in (self.folder / "binaries").rglob("*")
            if path.is_file()
        }

        def head(name: str) -> bytes:
            with files[name].open("rb") as file:
                return file.read(LONGEST_HEAD)

        return files[binary(self.can.modelIdentifier, self.version, files, head)]

    def instantiate(
        self,
        name: str = "instance",
        token: str | None = None,
        logging: bool = True,
        **asked: bool,
    ) -> Called:
        """Make an instance.

        Parameters
        ----------
        name : str
            Of the instance.
        token : str, optional
            GUID or instantiation token, by default the right one.
        logging : bool
            Whether messages are asked for.
        **asked : bool
            ``events`` and ``early`` of FMI 3.0.

        Returns
        -------
        Called
            The instance.

        Raises
        ------
        NoInstance
            The FMU made none.
        """
        token = self.model.guid if token is None else token
        if self.version == 3:
            place = f"{self.folder / 'resources'}/"
            return Called3(self.dll, self.trail, name, token, place, logging, **asked)
        place = (self.folder / "resources").as_uri()
        return Called2(self.dll, self.trail, name, token, place, logging)

    def begun(self, name: str = "instance", **asked: bool) -> Called:
        """Return a new instance that is initialised, ready for its first step."""
        instance = self.instantiate(name, None, True, **asked)
        instance.initialise(self.start, self.horizon)
        return instance

    def has_instance(self, token: str) -> bool:
        """Tell whether the FMU makes an instance for a token."""
        try:
            self.instantiate("with another token", token)
        except NoInstance:
            return False
        return True

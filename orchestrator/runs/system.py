"""A co-simulation made in steps: from a case, a file or nothing, then changed, shown and run."""

import os
from collections.abc import Container, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

from rockshed.components.common.component import Component, ComponentError

from ..cases.registry import case as case_of
from ..cases.registry import is_case
from ..core.errors import InputRefused, Problem
from ..core.fmu.slave import Source
from ..core.run import sources_of
from ..core.system.fields import Value
from ..core.system.names import split_name
from ..core.system.other_values import with_values
from ..core.system.parts import ComponentSpec, PowerBond
from ..core.system.planning import make_plan
from ..core.system.reading import system_from
from ..core.system.system import SystemSpec
from ..ssp.package import is_ssp
from ..tables import Table
from .building import Note, silent
from .export import export_ssp, export_system, is_ssp_name, refuse_place
from .inspection import Overview, describe_system
from .job import Job, plan_problems, prepare
from .request import Request, plain, with_keys
from .scenario import read_inputs, told
from .subsystem import Subsystem, component_of, whole_sizes
from .target import SYSTEM
from .values_in_si import source_in, values_in_si

_OF_REQUEST = ("load_cell", "runtime", "in_process")
"""Options of a case that are no keys of its system."""


@dataclass(frozen=True, repr=False, eq=False)
class System:
    """A co-simulation, ready to run; every change gives another system.

    Attributes
    ----------
    job : Job
        Components, connections, values, and how they are run.
    request : Request or None
        The request from which the system is made again when values or sizes change; None of a
        system that was built or connected by hand.
    """

    job: Job
    request: Request | None = None

    # ------------------------------------------------------------------ made

    @classmethod
    def load(cls, path: str | Path) -> "System":
        """Read a system file, or an SSP.

        Parameters
        ----------
        path : str or Path
            A TOML file, as ``rockshed export`` writes one, or a folder that :meth:`save` wrote.
            Relative paths of FMUs count from the folder of the file. Or an SSP: its archive
            (``.ssp``), its description (``.ssd``) or its folder.

        Returns
        -------
        System
            The system of the file.

        Raises
        ------
        InputRefused
            There is no such file, or its content is not in order; with every reason.
        """
        file = Path(path)
        if os.path.isdir(file) and not is_ssp(file):
            file = file / SYSTEM
        is_named = file.suffix == ".toml" or is_ssp(file)
        return cls.prepared(Request(str(file if is_named else file.absolute())))

    @classmethod
    def prepared(
        cls, request: Request, note: Note = silent, problems: Sequence[Problem] = ()
    ) -> "System":
        """Make the system of a request.

        Parameters
        ----------
        request : Request
            A case or a system file, and what is to be other than it is there.
        note : callable
            Called with a line for each FMU that is built.
        problems : sequence of Problem
            Problems that the caller has with the request, refused together with those seen here.

        Returns
        -------
        System
            The system, ready to run.

        Raises
        ------
        InputRefused
            Everything that is wrong with the request.
        """
        request = _with_model(request)
        return cls(prepare(request, note, problems), request)

    @classmethod
    def new(
        cls, name: str, *, exchange_step: float | str, stop_time: float | str, **options: Any
    ) -> "System":
        """Begin a system that has no component yet.

        Parameters
        ----------
        name : str
            Name of the system and of the folder of its results.
        exchange_step : float or str
            Time between two exchanges: s, or with a unit, ``"10 us"``.
        stop_time : float or str
            End of the run, likewise.
        **options
            Other keys of a system file: ``description``, ``master``, ``output_interval``, ...

        Returns
        -------
        System
            To be filled by :meth:`add`, :meth:`connect` and :meth:`bond`.

        Raises
        ------
        InputRefused
            Options that do not exist or do not fit.

        Examples
        --------
        >>> import rockshed
        >>> fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.1)
        >>> fall = fall.add("rock", "FallingRock", {"velocity0.y": -1.0})
        >>> run = rockshed.simulate(fall)
        >>> round(float(run["rock.velocity.y"][-1]), 3)
        -1.981
        """
        keys = {"name": name, "exchange_step": exchange_step, "stop_time": stop_time, **options}
        checked = system_from({**keys, "components": {"nothing": ComponentSpec(fmu="")}}, name)
        return cls(Job(name, checked.model_copy(update={"components": {}}), {}, {}))

    # ------------------------------------------------------------------ changed

    def with_values(self, values: Mapping[str, Value]) -> "System":
        """Return the system with other values of parameters.

        Parameters
        ----------
        values : mapping of str to Value
            By ``component.parameter`` or by the name of a shared value: numbers in the unit of the
            variable, texts with a unit of their own, or items of an enumeration by their words.
            ``component.parameter[*]`` sets a whole array.

        Returns
        -------
        System
            Of a case, values that follow from these are adapted too.

        Raises
        ------
        InputRefused
            There is no such component, or a shared value is given several values.
        """
        if self.request is not None:
            merged = {**self.request.values, **plain(values)}
            return System.prepared(replace(self.request, values=merged))
        problems: list[Problem] = []
        numbers = values_in_si(plain(values), self.spec, self.job.sources, problems)
        if problems:
            raise InputRefused(problems)
        return self._with(with_values(self.spec, numbers), numbers)

    def with_sizes(self, sizes: Mapping[str, int]) -> "System":
        """Return the case of this system, made again in other sizes.

        Parameters
        ----------
        sizes : mapping of str to int
            By ``component.size``.

        Returns
        -------
        System
            With FMUs of these sizes; those that are missing are built.

        Raises
        ------
        InputRefused
            Sizes that do not exist or are out of range, or a system that is no case.
        """
        if self.request is None or self.request.is_file:
            reason = "is not made from a case, and only cases are made again in other sizes"
            remedy = "give the sizes when a component is added, or build its FMU in them"
            raise InputRefused([Problem(self.name, reason, remedy)])
        merged = {**self.request.sizes, **plain(sizes)}
        return System.prepared(replace(self.request, sizes=merged))

    def with_options(self, **options: Any) -> "System":
        """Return the system with other keys: steps, times, master, what is recorded.

        Parameters
        ----------
        **options
            Keys of a system file: ``stop_time``, ``exchange_step``, ``output_interval``,
            ``state_interval`` (s), ``master`` (``sequential``, ``jacobi`` or ``implicit``),
            ``iteration``, ``order``, ``record``, ``watch``, ``energy_alarm``, ...

        Returns
        -------
        System
            With these keys replaced; of ``iteration`` and ``adaptive`` the entries that are named.

        Raises
        ------
        InputRefused
            Keys that do not exist, values that do not fit.
        """
        if self.request is not None:
            merged = with_keys(self.request.options, plain(options))
            return System.prepared(replace(self.request, options=merged))
        return self._with(self._checked(plain(options)), plain(options))

    def add(
        self,
        name: str,
        component: str | Path | Component | Subsystem,
        values: Mapping[str, Value] | None = None,
        *,
        sizes: Mapping[str, int] | None = None,
        step: float | str | None = None,
        extrapolation: int | None = None,
    ) -> "System":
        """Return the system with one more component.

        Parameters
        ----------
        name : str
            Name of the component in the system.
        component : str, Path, Component or Subsystem
            Name of a component of the catalogue, a component of one's own, or the path of an FMU
            file (``.fmu``). Components run in this process, without an FMU. Of a subsystem its
            component is taken in its sizes, not its values and state.
        values : mapping of str to Value, optional
            Parameters that differ from the component's start values: numbers in the unit of the
            variable, SI in ours, or texts with a unit.
        sizes : mapping of str to int, optional
            Sizes that differ from the component's defaults; not for FMU files.
        step : float or str, optional
            Communication step: s, or with a unit; by default the exchange step.
        extrapolation : int, optional
            Order of the polynomials that its inputs follow between exchanges, 0 to 2; by default
            that of the system.

        Returns
        -------
        System
            No longer tied to the case or file that it came from.

        Raises
        ------
        InputRefused
            The name is taken or no name, or sizes that do not fit or go with an FMU file.
        UnknownName
            The catalogue has no component of this name.
        """
        if name in self.spec.components:
            remedy = "choose another name"
            raise InputRefused([Problem(name, "is there already", remedy)])
        sources: dict[str, Source] = {}
        if isinstance(component, Subsystem):
            sizes = {**component.instance.sizes, **(sizes or {})}
            component = component.component
        if str(component).endswith(".fmu") and not isinstance(component, Component):
            fmu = str(component)
            if sizes:
                reason = "are those with which an FMU file was built"
                raise InputRefused([Problem(f"{name}: sizes", reason, "leave them out")])
        else:
            made = component_of(component if isinstance(component, Component) else str(component))
            sources[name] = _in_process(name, made, sizes)
            fmu = f"{made.name} (in process)"
        spec = {
            "fmu": fmu,
            "step": step,
            "extrapolation": extrapolation,
            "parameters": dict(values or {}),
        }
        entries: dict[str, Any] = {"components": {**self._data()["components"], name: spec}}
        if self.spec.order and name not in self.spec.order:  # it comes last
            entries["order"] = [*self.spec.order, name]
        return self._detached(entries, sources)

    def connect(self, *connections: str) -> "System":
        """Return the system with further connections of outputs with inputs.

        Parameters
        ----------
        *connections : str
            ``"sand.rock.force.y -> rock.force.y"`` each, or two names: an output and an input.
            The name of an array, or ``[*]`` behind it, stands for all its elements, ``[1..24]`` for
            some. ``"sand.rock <-> rock.rock"`` connects two terminals: all variables that they have
            in common, each in its direction.

        Returns
        -------
        System
            No longer tied to the case or file that it came from.

        Raises
        ------
        InputRefused
            A text that is no connection.
        """
        texts = connections
        if len(connections) == 2 and not any("->" in text for text in connections):
            texts = (" -> ".join(connections),)
        data = self._data()["connections"]
        return self._detached({"connections": [*data, *texts]})

    def bond(
        self,
        name: str,
        force: str | Sequence[str],
        position: str | Sequence[str],
        *,
        work: str | None = None,
        opposed: bool = False,
    ) -> "System":
        """Return the system with an interface whose energy is accounted for.

        Parameters
        ----------
        name : str
            Name of the interface in the results, ``coupling.NAME.energy``.
        force : str or sequence of str
            Outputs of the component that computes the forces or torques, ``component.output``.
        position : str or sequence of str
            Outputs of the component that moves under them: the position or angle at which each
            acts.
        work : str, optional
            Output, ``component.output``, with which the first component counts the energy that
            this interface brings into it.
        opposed : bool
            Force and position count in opposite directions.

        Returns
        -------
        System
            No longer tied to the case or file that it came from.

        Raises
        ------
        InputRefused
            Names that are not ``component.output`` of one component.
        """
        giver, forces = _ends(name, force, self.spec.components)
        taker, positions = _ends(name, position, self.spec.components)
        bond = PowerBond(
            giver=giver,
            force=forces,
            taker=taker,
            position=positions,
            work=work.removeprefix(f"{giver}.") if work else None,
            opposed=opposed,
        )
        return self._detached({"bonds": {**self._data()["bonds"], name: bond.model_dump()}})

    def share(self, name: str, value: Value, targets: str | Sequence[str]) -> "System":
        """Return the system with one value that several parameters take.

        Parameters
        ----------
        name : str
            Name of the value, for :meth:`with_values`.
        value : bool, int, float or str
            In the unit of the targets, or with one of its own.
        targets : str or sequence of str
            Parameters that take it, ``component.parameter``; they have no value of their own.

        Returns
        -------
        System
            No longer tied to the case or file that it came from.

        Raises
        ------
        InputRefused
            The name is taken or no name, or there is no target.
        """
        if name in self.spec.shared:
            raise InputRefused([Problem(name, "is shared already", "with_values changes it")])
        takers = [targets] if isinstance(targets, str) else list(targets)
        shared = {**self._data()["shared"], name: {"value": value, "targets": takers}}
        return self._detached({"shared": shared})

    def scenario(
        self,
        inputs: str | Path | Mapping[str, Sequence[float | str]] | None = None,
        *,
        values: Sequence[Mapping[str, Any]] = (),
        faults: Sequence[Mapping[str, Any]] = (),
    ) -> "System":
        """Return the system with what happens to it from outside during a run.

        It replaces an earlier scenario. All of it acts at exchanges.

        Parameters
        ----------
        inputs : str, Path or mapping, optional
            A CSV file with the column ``time`` (s) and one for each input ``component.input`` that
            nothing feeds, in its unit; or these columns, whose values may have units. Continuous
            inputs are interpolated linearly between two rows, others are held.
        values : sequence of mapping
            Values that change: ``port`` (such an input, or a tunable parameter), ``value``, and
            ``at`` (s, time of an exchange) or ``when`` (``"rock.position.y < 1.0"``, from the first
            exchange on at which it is true).
        faults : sequence of mapping
            What connections deliver: ``port`` (the input), ``kind`` (``frozen``, ``noise`` or
            ``cut``), ``from`` and ``to`` (s, times of exchanges), of noise ``deviation`` (in the
            unit of the input) and ``seed``. All quantities may have units.

        Returns
        -------
        System
            With this scenario.

        Raises
        ------
        InputRefused
            The form is wrong; what does not fit the FMUs is found by :meth:`validate` or the run.

        Examples
        --------
        >>> import rockshed
        >>> fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.1)
        >>> fall = fall.add("rock", "FallingRock", {"mass": 2.0, "velocity0.y": 0.0})
        >>> push = {"port": "rock.force.y", "value": 19.6133, "at": 0.05}  # N, its weight
        >>> run = rockshed.simulate(fall.scenario(values=[push]))
        >>> round(float(run["rock.velocity.y"][-1]), 4)
        -0.4903
        """
        table: Any = inputs
        if isinstance(inputs, str | Path):
            table = read_inputs(Path(inputs))
        elif inputs is not None:
            table = {name: [*map(_plain_number, column)] for name, column in inputs.items()}
        listed = {"set": [plain(entry) for entry in values], "fault": [plain(f) for f in faults]}
        return self.with_options(scenario={"inputs": table, **listed})

    def _detached(
        self, entries: Mapping[str, Any], sources: Mapping[str, Source] | None = None
    ) -> "System":
        """Return the system with other entries, no longer compared with what others found."""
        sources = {**self.job.sources, **(sources or {})}
        facts = dict(self.job.facts)
        if "references" in facts:
            facts["references"] = {"remarks": ["not compared: the system was put together anew"]}
        made = self._checked(entries, sources)
        job = replace(self.job, system=made, sources=sources, facts=facts, ssp=None, file=None)
        return System(job)

    def _with(self, spec: SystemSpec, differing: Mapping[str, Any]) -> "System":
        """Return the system with this content; provenance names what differs."""
        known = self.job.facts.get("differences", {})
        facts = {**self.job.facts, "differences": {**known, **told(differing, spec)}}
        return System(replace(self.job, system=spec, facts=facts), self.request)

    def _checked(
        self, entries: Mapping[str, Any], sources: Mapping[str, Source] | None = None
    ) -> SystemSpec:
        makers = source_in(self.job.sources if sources is None else sources)
        return system_from(with_keys(self._data(), entries), self.name, makers)

    def _data(self) -> dict[str, Any]:
        return self.spec.model_dump()

    # ------------------------------------------------------------------ shown

    @property
    def name(self) -> str:
        """Name under which the results go."""
        return self.job.name

    @property
    def spec(self) -> SystemSpec:
        """The system as data, as a system file has it."""
        return self.job.system

    def validate(self) -> list[Problem]:
        """Check the system against its FMUs.

        Returns
        -------
        list of Problem
            Everything that is wrong with it; empty if it can be run.
        """
        try:
            self.refuse_empty()
        except InputRefused as refusal:
            return refusal.problems
        return self.job.placed(plan_problems(self.spec, self.job.sources))

    def refuse_empty(self) -> None:
        """Refuse a system without components.

        Raises
        ------
        InputRefused
            There is no component yet.
        """
        if not self.spec.components:
            raise InputRefused([Problem(self.name, "has no component", "add one")])

    def describe(self) -> Overview:
        """Describe components, values that differ from the components' own, and connections.

        Returns
        -------
        Overview
            Texts and tables, to be shown as they are.

        Raises
        ------
        InputRefused
            There is no component, or the system does not fit its FMUs.
        """
        self.refuse_empty()
        return describe_system(self.job)

    def save(self, place: str | Path, *, ssp: str | None = None) -> Path:
        """Write the system with its FMUs: as ``system.toml`` in a folder, or as an SSP.

        Parameters
        ----------
        place : str or Path
            A new or empty folder, or a new file whose name ends in ``.ssp``. Components without
            FMUs become FMUs with Python inside.
        ssp : str, optional
            Version of an SSP, ``1.0`` or ``2.0``; by default that of the SSP that the system was
            read from, else 1.0.

        Returns
        -------
        Path
            The file, for :meth:`load` and ``rockshed run``.

        Raises
        ------
        InputRefused
            There is no component, or the place holds something or cannot be written.
        """
        self.refuse_empty()
        path = Path(place)
        if is_ssp_name(path):
            return export_ssp(self.job, path, ssp)
        refuse_place(path, ssp)
        return export_system(self.spec, path, self.job.sources)

    def __repr__(self) -> str:
        parts = ", ".join(self.spec.components) or "no component"
        return (
            f"<System {self.name}: {parts}; {self.spec.stop_time:g} s in exchanges of "
            f"{self.spec.exchange_step:g} s>"
        )

    def diagram(self) -> str:
        """Draw components, their steps, what goes from one to another, power bonds and loops.

        Algebraic loops are marked as far as the FMUs can be read and fit together.

        Returns
        -------
        str
            An SVG picture, as text; a notebook shows it with the system.
        """
        from ..pictures.diagram import system_diagram  # the room of pictures imports matplotlib

        self.refuse_empty()
        loops: tuple[str, ...] = ()
        with suppress(InputRefused):
            sources = {**sources_of(self.spec, to_run=False), **self.job.sources}
            loops = make_plan(self.spec, sources).loops
        return system_diagram(self.spec, loops, self.job.fmus)

    def _repr_svg_(self) -> str | None:
        return self.diagram() if self.spec.components else None

    def _repr_html_(self) -> str:
        table = Table(("component", "FMU", "values"))
        for name, spec in self.spec.components.items():
            values = (f"{key} = {value}" for key, value in spec.parameters.items())
            table.add(name, Path(spec.fmu).name, ", ".join(values))
        shared = Table(("shared value", "", "set in"))
        for name, entry in self.spec.shared.items():
            shared.add(name, str(entry.value), ", ".join(entry.targets))
        more = shared._repr_html_() if len(shared) else ""
        drawn = self._repr_svg_() or ""
        return f"<p>{escape(repr(self)[1:-1])}</p>{drawn}{table._repr_html_()}{more}"


def _in_process(name: str, made: Component, sizes: Mapping[str, int] | None) -> Source:
    from rockshed.fmus.in_process import InProcess  # imports pythonfmu, which FMU files do not need

    try:
        return InProcess(made, whole_sizes(made, sizes))
    except ComponentError as error:
        problems = [Problem(f"{name}: sizes", text) for text in error.problems]
        raise InputRefused(problems) from error


def _plain_number(value: Any) -> Any:
    """Return a number of numpy, or a whole one, as a float; a text as it is."""
    return value if isinstance(value, str) else float(value)


def _with_model(request: Request) -> Request:
    """Return a request with the model of the sand that its case is best run with."""
    if request.model is not None or not is_case(request.target):
        return request
    return replace(request, model=case_of(request.target).model)


def _ends(
    bond: str, names: str | Sequence[str], components: Container[str]
) -> tuple[str, list[str]]:
    """Return the component that outputs belong to, and their names without it.

    Raises
    ------
    InputRefused
        They are not of one component.
    """
    listed = [names] if isinstance(names, str) else list(names)
    owners = {split_name(name, components)[0] for name in listed}
    if len(owners) != 1 or not all("." in name for name in listed):
        reason = f"{', '.join(listed)} are not outputs of one component"
        raise InputRefused([Problem(f"bond {bond}", reason, "write component.output")])
    (owner,) = owners
    return owner, [name.removeprefix(f"{owner}.") for name in listed]


def case(
    name: str,
    *,
    model: str | None = None,
    coupling: str | None = None,
    values: Mapping[str, Value] | None = None,
    sizes: Mapping[str, int] | None = None,
    **options: Any,
) -> System:
    """Make a ready-made system; its FMUs are built where they are missing.

    Parameters
    ----------
    name : str
        Name of a case, as ``rockshed list`` shows them.
    model : str, optional
        Model of the sand: ``calibrated``, ``literal`` or ``one-law``. By default that of the case:
        ``one-law`` on girders, else ``calibrated``.
    coupling : str, optional
        Scheme of exchange, by default the first of the case.
    values : mapping of str to Value, optional
        By ``component.parameter`` or by the name of a shared value (SI units).
    sizes : mapping of str to int, optional
        By ``component.size``.
    **options
        Keys of the system (``stop_time``, ``exchange_step``, ``output_interval``, ``master``, ...)
        and ``runtime`` (``auto``, ``native`` or ``python``), ``in_process`` (True: without FMUs),
        ``load_cell`` (Hz: show the transmitted force also through a load cell with this cut-off).

    Returns
    -------
    System
        Ready for :func:`rockshed.simulate`.

    Raises
    ------
    InputRefused
        Everything that is wrong with what is asked for.

    Examples
    --------
    >>> import rockshed
    >>> rockshed.case("lab-impact", in_process=True, stop_time=0.01)
    <System lab-impact: sand, rock, beam; 0.01 s in exchanges of 1e-05 s>
    """
    own = {key: options.pop(key) for key in _OF_REQUEST if key in options}
    request = Request(
        name,
        plain(values or {}),
        plain(sizes or {}),
        coupling,
        plain(options),
        model=model,
        **own,
    )
    if request.is_file:
        remedy = "System.load reads system files"
        raise InputRefused([Problem(name, "is a file, and not the name of a case", remedy)])
    return System.prepared(request)

"""Native FMUs with one fault each, seeded into a copy of the slave in C, its shim or its kernels."""

import shutil
import subprocess
import zipfile
from dataclasses import dataclass

from rockshed.components.catalogue import component
from rockshed.fmus.build import Fmi
from rockshed.fmus.native.fmu import (
    _OPTIONS,
    compiler,
    library_sources,
    own_binary,
    own_platform,
    stamp,
)

SLAVE = "slave.h"
SHIM2 = "shim_fmi2.c"
SHIM3 = "shim_fmi3.c"
XML = "modelDescription.xml"
STEP = "static Status advance(Slave *m, double time, double step, double end, Status failure) {\n"
KERNEL = "int64_t status = rockshed_step(time, step, m->s.w, m->s.x, m->s.k);"


@dataclass(frozen=True)
class Seed:
    """A fault: the probe that finds it, and pieces of text with what stands in their place."""

    name: str
    probe: str
    edits: tuple[tuple[str, str, str], ...]
    fmi: Fmi = Fmi.TWO
    model: str = "FallingRock"


def seed(name, probe, *edits, **rest):
    return Seed(name, probe, edits, **rest)


SEEDS = (
    seed(
        "GUID not compared",
        "library/token",
        (SLAVE, "if (!token || strcmp(token, GUID))", "if (!token)"),
    ),
    seed(
        "step before the initialisation",
        "conduct/step-first",
        (SLAVE, "if (!is_legal(m, CALL_STEP)) strcpy(s.text, REMEDIES[m->s.phase]);", "if (0) ;"),
        (SLAVE, "if (!(fabs(time - m->s.time) <= tolerance))", "if (0)"),
        (SLAVE, "else if (!(fabs(time - m->s.time) <= tolerance))", "else if (0)"),
    ),
    seed(
        "reset keeps the values",
        "life/reset",
        (
            SHIM2,
            "SLAVE; start_anew(m); return OK; }",
            "SLAVE; m->s.phase = INSTANTIATED; return OK; }",
        ),
    ),
    seed(
        "state without the outputs and inputs",
        "state/rollback",
        (
            SLAVE,
            "  memcpy(&m->s, state, sizeof(State));\n  m->stale",
            "  memcpy(&m->s, state, offsetof(State, w));\n  m->stale",
        ),
    ),
    seed(
        "state without the time",
        "state/rollback",
        (
            SLAVE,
            "  memcpy(&m->s, state, sizeof(State));\n  m->stale",
            "  double now = m->s.time; memcpy(&m->s, state, sizeof(State)); m->s.time = now;\n  m->stale",
        ),
    ),
    seed(
        "all states in one place",
        "state/kept",
        (
            SLAVE,
            "if (!*state && !(*state = malloc(sizeof(State))))",
            "static State kept; *state = &kept;\n  if (0)",
        ),
        (SLAVE, "{ if (state) { free(*state); *state = NULL; } }", "{ if (state) *state = NULL; }"),
    ),
    seed(
        "checksum not compared",
        "state/damaged",
        (
            SLAVE,
            " || memcmp(bytes + 8, &sum, 4)) return refuse(m, SAYS_DAMAGED);\n  if (n != SERIALIZED",
            ") return refuse(m, SAYS_DAMAGED);\n  if (n != SERIALIZED",
        ),
    ),
    seed(
        "number of bytes not compared",
        "state/shortened",
        (
            SLAVE,
            'if (n < SEAL + CLOCK || memcmp(bytes, "rockslav", 8) || memcmp(bytes + 8, &sum, 4)) return',
            "if (0) return",
        ),
        (
            SLAVE,
            "if (n != SERIALIZED || memcmp(bytes + SEAL + CLOCK, HEADER, sizeof HEADER)) return",
            "if (0) return",
        ),
        (SLAVE, "if (!is_possible(m, s))", "if (0)"),
    ),
    seed(
        "an address in the serialized state",
        "state/other-process",
        (SLAVE, 'memcpy(bytes, "rockslav", 8);', "memcpy(bytes, &m, 8);"),
        (SLAVE, 'memcmp(bytes, "rockslav", 8)', "*(void **)bytes == NULL"),
        (
            SLAVE,
            "  s->mark = MARK;\n",
            "  s->mark = MARK;\n  if (!m || **(char **)bytes == 99) return ERROR;\n",
        ),
    ),
    seed(
        "unknown references",
        "values/unknown",
        (SLAVE, "  if (r >= NW) {\n", "  if (r >= NW) return 1;\n  if (0) {\n"),
        (
            SLAVE,
            "outputs |= VARIABLES[VARIABLE_OF[r[i]]].causality == OUTPUT;",
            "outputs |= r[i] < NW && VARIABLES[VARIABLE_OF[r[i]]].causality == OUTPUT;",
        ),
    ),
    seed(
        "calls of another type",
        "values/other-type",
        (SLAVE, "  if (type == CALL_OF(its)) return 1;", "  if (its >= 0) return 1;"),
    ),
    seed(
        "outputs can be set",
        "values/read-only",
        (
            SLAVE,
            "  if (v->causality == OUTPUT)\n    because(m, SAYS_OUTPUT_SET",
            "  if (0)\n    because(m, SAYS_OUTPUT_SET",
        ),
    ),
    seed(
        "fixed parameters can be set",
        "values/fixed",
        (
            SLAVE,
            "else if (v->causality == PARAMETER)\n    because(m, SAYS_FIXED",
            "else if (0)\n    because(m, SAYS_FIXED",
        ),
    ),
    seed(
        "NaN is taken and given",
        "values/not-finite",
        (
            SLAVE,
            "static int are_finite(const double v[], size_t n) {\n",
            "static int are_finite(const double v[], size_t n) {\n  return 1;\n",
        ),
        (
            SLAVE,
            "return v->low <= value && value <= v->high; }",
            "return !(value < v->low) && !(value > v->high); }",
        ),
        (SLAVE, KERNEL, KERNEL + " status = OK;"),
    ),
    seed(
        "values beyond the range",
        "values/range",
        (SLAVE, "return v->low <= value && value <= v->high; }", "return isfinite(value); }"),
    ),
    seed(
        "wrong start value",
        "values/starts",
        (
            SLAVE,
            "  memcpy(m->s.w, START, sizeof START);\n",
            "  memcpy(m->s.w, START, sizeof START);\n  m->s.w[0] += 0.5;\n",
        ),
    ),
    seed(
        "references taken for consecutive",
        "values/order",
        (SHIM2, "  return !different;", "  return 1;"),
    ),
    seed(
        "an output that follows an input at once",
        "values/dependencies",
        (
            SHIM2,
            "  memcpy(m->s.w + r[0], v, n * sizeof *v);\n  return 1;",
            "  memcpy(m->s.w + r[0], v, n * sizeof *v);\n"
            "  for (int i = 0; i < NW; i++) if (VARIABLES[VARIABLE_OF[i]].causality == OUTPUT) { m->s.w[i] = v[0]; break; }\n  return 1;",
        ),
    ),
    seed(
        "negative steps",
        "stepping/negative",
        (SLAVE, STEP, STEP + "  if (!(step > 0.0)) { m->s.time = end; return OK; }\n"),
        (SLAVE, "else if (!(step > 0.0 && isfinite(step)))", "else if (0)"),
        (
            SLAVE,
            "double tolerance = 1e-6 * step + 4.0",
            "double tolerance = 1e-6 * fabs(step) + 4.0",
        ),
    ),
    seed(
        "gaps in time",
        "stepping/gap",
        (SLAVE, "else if (!(fabs(time - m->s.time) <= tolerance))", "else if (0)"),
    ),
    seed(
        "times compared to the last bit",
        "stepping/rounding",
        (
            SLAVE,
            "  Long reason = against_step(m, time, step);\n",
            '  Long reason = against_step(m, time, step);\n  if (time != m->s.time) strcpy(reason.text, "another time");\n',
        ),
        (
            SLAVE,
            "fabs(time - m->s.time) <= tolerance && time + step",
            "time == m->s.time && time + step",
        ),
    ),
    seed(
        "steps past the stop time",
        "stepping/stop",
        (
            SLAVE,
            "  m->stop = with_stop ? stop : INFINITY;\n  return OK;",
            "  m->stop = INFINITY;\n  return OK;",
        ),
    ),
    seed(
        "a tiny step never ends",
        "stepping/tiny",
        (
            SLAVE,
            STEP,
            STEP + "  volatile int more = 1; while (step < 1e-8 && step > 0.0 && more) ;\n",
        ),
    ),
    seed(
        "no state for a kernel of its own: all instances share it",
        "life/two",
        (SLAVE, KERNEL, "static int steps; " + KERNEL + " m->s.w[NW - 1] += 1e-9 * steps++;"),
    ),
    seed(
        "a kernel that depends on the process",
        "life/repetition",
        (SLAVE, "#include <math.h>\n", "#include <math.h>\n#include <unistd.h>\n"),
        (SLAVE, KERNEL, KERNEL + " m->s.w[NW - 1] += 1e-9 * getpid();"),
    ),
    seed(
        "a kernel that loses its numbers",
        "life/simulation",
        (
            SLAVE,
            "static int are_finite(const double v[], size_t n) {\n",
            "static int are_finite(const double v[], size_t n) {\n  return 1;\n",
        ),
        (SLAVE, KERNEL, KERNEL + " m->s.w[NW - 1] = NAN;"),
    ),
    seed(
        "memory is not given back",
        "life/memory",
        (SLAVE, "{ if (m) { free(m->name); free(m->block); } }", "{ (void)m; }"),
    ),
    seed(
        "memory is given back twice",
        "life/simulation",
        (
            SLAVE,
            "{ if (m) { free(m->name); free(m->block); } }",
            "{ if (m) { free(m->name); free(m->name); free(m->block); } }",
        ),
    ),
    seed(
        "ends the process",
        "life/simulation",
        (SLAVE, "  m->s.phase = TERMINATED;\n", "  exit(0);\n"),
    ),
    seed("prints", "environment/printing", (SLAVE, STEP, STEP + '  puts("step");\n')),
    seed(
        "writes a file",
        "environment/files",
        (SLAVE, STEP, STEP + '  FILE *log = fopen("log.txt", "a"); if (log) fclose(log);\n'),
    ),
    seed(
        "catches Ctrl-C",
        "environment/process",
        (SLAVE, "#include <math.h>\n", "#include <math.h>\n#include <signal.h>\n"),
        (SLAVE, STEP, "static void caught(int s) {}\n" + STEP + "  signal(SIGUSR1, caught);\n"),
    ),
    seed(
        "refuses without a word",
        "environment/messages",
        (
            SLAVE,
            "  if (m->told[status == DISCARD ? WARNING : status]) deliver(m, status, CATEGORIES[status]);\n",
            "",
        ),
    ),
    seed(
        "a wrong number of values",
        "values/length",
        (SHIM3, "  if (expected == values) return;", "  if (expected) return;"),
        (
            SHIM3,
            "  if (at != values) return 0;\n  for (size_t i = at = 0; i < n; at += length_of(r[i++])) memcpy(v",
            "  for (size_t i = at = 0; i < n; at += length_of(r[i++])) memcpy(v",
        ),
        fmi=Fmi.THREE,
    ),
    seed(
        "event mode",
        "conduct/events",
        (
            SHIM3,
            '#define NO_EVENTS(Name) HAS_NOT(Name, "this FMU has no event mode")',
            "#define NO_EVENTS(Name) EXPORT Status fmi3##Name(void *c) { return OK; }",
        ),
        fmi=Fmi.THREE,
    ),
    seed(
        "a unit of another size",
        "description/units",
        (XML, '<BaseUnit kg="1" m="1" s="-2"/>', '<BaseUnit kg="1" m="1" s="-2" factor="1000"/>'),
    ),
    seed(
        "a dependency at the start that is not declared",
        "values/initial",
        (XML, '<Unknown index="17" dependencies="7"/>', '<Unknown index="17" dependencies=""/>'),
    ),
    seed(
        "an output that ModelStructure has not",
        "description/structure",
        (XML, '<Unknown index="1', '<Unknown index="2'),
    ),
)


def seeded(fault, fmu, folder):
    """Write a copy of a native FMU with a fault into a folder; return its file."""
    kind = component(fault.model)
    sizes, platform = kind.with_sizes(), own_platform()
    token = stamp(kind, sizes, fault.fmi)
    sources = library_sources(kind, sizes, [platform], token, fault.fmi)[platform]
    with zipfile.ZipFile(fmu) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    for name, old, new in fault.edits:
        place = files if name == XML else sources
        text = place[name].decode()
        assert old in text or new in text, f"{fault.name}: {name} has no {old}"
        place[name] = text.replace(old, new).encode()
    if any(name != XML for name, _, _ in fault.edits):
        files[own_binary(kind, fault.fmi)] = _compiled(sources, folder, fault.fmi)
    file = folder / f"{fault.model}.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return file


def _compiled(sources, folder, fmi):
    for name, content in sources.items():
        (folder / name).write_bytes(content)
    shim = SHIM2 if fmi is Fmi.TWO else SHIM3
    chosen = ["cc"] if shutil.which("cc") else compiler(own_platform())
    options = [option for option in _OPTIONS if option != "-O3"]
    command = [*chosen, "-w", *options, "-o", "seeded.so", shim, "kernels.o", "-lm", "-lpthread"]
    subprocess.run(command, cwd=folder, check=True)
    return (folder / "seeded.so").read_bytes()

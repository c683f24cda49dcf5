"""FMUs in C that do something odd, for tests of what a run makes of it."""

import os
import re
import signal
import subprocess
import sys
import zipfile

SOURCE = r"""
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
typedef void (*logger)(void *, const char *, int, const char *, const char *, ...);
static struct { logger log; void *allocate, *release, *finished, *environment; } *callbacks;
static double time_reached;
static int steps, self, ended;
#define SAY(status, text) callbacks->log(callbacks->environment, "m", status, "x", text)
void *fmi2Instantiate(void *n, int t, void *g, void *l, void *c, int v, int d) {
  callbacks = c; AT_START; return &self; }
void fmi2FreeInstance(void *c) { AT_FREE; }
int fmi2SetupExperiment(void *c, int d, double t, double s, int e, double p) { return 0; }
int fmi2GetReal(void *c, const unsigned r[], size_t n, double v[]) {
  for (size_t i = 0; i < n; i++) v[i] = time_reached;
  return 0; }
int fmi2DoStep(void *c, double t, double h, int k) {
  steps++; IN_STEP; time_reached = t + h; return STATUS; }
int fmi2Terminate(void *c) { AT_END; return 0; }
int fmi2GetBooleanStatus(void *c, int kind, int *value) { *value = ended; return 0; }
int fmi2GetRealStatus(void *c, int kind, double *value) { *value = time_reached; return 0; }
"""
REST = re.findall(
    r"\w+",
    """
    GetTypesPlatform GetVersion SetDebugLogging EnterInitializationMode ExitInitializationMode
    Reset GetInteger GetBoolean GetString SetReal SetInteger SetBoolean SetString GetFMUstate
    SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate
    GetDirectionalDerivative SetRealInputDerivatives GetRealOutputDerivatives CancelStep GetStatus
    GetIntegerStatus GetStringStatus""",
)
XML = """<?xml version='1.0'?><fmiModelDescription fmiVersion='2.0' modelName='Odd' guid='odd'>
  <CoSimulation modelIdentifier='Odd'/><ModelVariables>
  <ScalarVariable name='x' valueReference='1' causality='output'><Real/></ScalarVariable>
  </ModelVariables><ModelStructure><Outputs><Unknown index='1'/></Outputs></ModelStructure>
  </fmiModelDescription>"""
SYSTEM = """
name = "odd"
stop_time = 1.0
exchange_step = 0.1
[components.m]
fmu = "Odd.fmu"
"""


def make(folder, xml=XML, system=SYSTEM, **code):
    """Write Odd.fmu and system.toml into a folder; ``code`` replaces the names in the source."""
    parts = {"AT_START": "", "AT_FREE": "", "AT_END": "", "IN_STEP": "", "STATUS": "0"} | code
    source = SOURCE
    for name, text in parts.items():
        source = re.sub(rf"\b{name}\b", lambda _, text=text: text, source)
    source += "".join(f"int fmi2{name}(void) {{ return 0; }}\n" for name in REST)
    (folder / "odd.c").write_text(source)
    command = ["cc", "-w", "-shared", "-fPIC", "-o", "Odd.so", "odd.c"]
    subprocess.run(command, cwd=folder, check=True)
    with zipfile.ZipFile(folder / "Odd.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", xml)
        archive.write(folder / "Odd.so", "binaries/linux64/Odd.so")
    (folder / "system.toml").write_text(system)
    (folder / "tmp").mkdir(exist_ok=True)


def program(folder, *words, **rest):
    """Start the command in a folder, with a folder of temporary files of its own."""
    environment = {**os.environ, "TMPDIR": str(folder / "tmp")}
    command = [sys.executable, "-m", "rockshed", *words]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    options = {"cwd": folder, "env": environment, "text": True} | pipes | rest
    return subprocess.Popen(command, **options)


def run(folder, *words):
    """Run system.toml and return (exit code, stdout, stderr)."""
    words = words or ("run", "system.toml", "--output-dir", "out", "--no-figures")
    process = program(folder, *words)
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err


def end(process, *signals, pause=0.3):
    """Send signals to a process and return (exit code, stdout, stderr)."""
    import time

    for number in signals:
        process.send_signal(number)
        time.sleep(pause)
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err


CTRL_C = signal.SIGINT

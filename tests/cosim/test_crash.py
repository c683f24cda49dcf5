"""A foreign FMU whose native code crashes: the command says which component it was and when, and keeps what was computed."""

import re
import shutil
import subprocess
import sys
import zipfile

import pytest

from rockshed.core.results.reading import read_run

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or not shutil.which("cc"), reason="needs Linux and a C compiler"
)

SOURCE = r"""
#include <stddef.h>
static double x, crash_at = 1e9;
static int self;
void *fmi2Instantiate(void *n, int t, void *g, void *l, void *c, int v, int d) { return CRASH_AT_START ? *(void **)8 : &self; }
void fmi2FreeInstance(void *c) {}
int fmi2SetupExperiment(void *c, int d, double t, double s, int e, double p) { return 0; }
int fmi2GetReal(void *c, const unsigned r[], size_t n, double v[]) {
  for (size_t i = 0; i < n; i++) v[i] = r[i] ? x : crash_at;
  return 0;
}
int fmi2SetReal(void *c, const unsigned r[], size_t n, const double v[]) { crash_at = v[0]; return 0; }
int fmi2DoStep(void *c, double t, double h, int k) { if (t + h > crash_at) *(volatile int *)8 = 1; x = t + h; return 0; }
"""
REST = re.findall(
    r"\w+",
    """
    GetTypesPlatform GetVersion SetDebugLogging EnterInitializationMode ExitInitializationMode Terminate Reset GetInteger GetBoolean
    GetString SetInteger SetBoolean SetString GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate
    DeSerializeFMUstate GetDirectionalDerivative SetRealInputDerivatives GetRealOutputDerivatives CancelStep GetStatus GetRealStatus
    GetIntegerStatus GetBooleanStatus GetStringStatus""",
)
XML = """<?xml version='1.0'?><fmiModelDescription fmiVersion='2.0' modelName='Crash' guid='crash'>
  <CoSimulation modelIdentifier='Crash'/><ModelVariables>
  <ScalarVariable name='crash_at' valueReference='0' causality='parameter' variability='fixed'><Real start='1e9'/></ScalarVariable>
  <ScalarVariable name='x' valueReference='1' causality='output' initial='exact'><Real start='0'/></ScalarVariable></ModelVariables>
  <ModelStructure><Outputs><Unknown index='2'/></Outputs></ModelStructure></fmiModelDescription>"""


def fmu(folder, at_start=0):
    source = SOURCE + "".join(f"int fmi2{name}(void) {{ return 0; }}\n" for name in REST)
    (folder / "crash.c").write_text(source)
    subprocess.run(
        ["cc", f"-DCRASH_AT_START={at_start}", "-shared", "-fPIC", "-o", "Crash.so", "crash.c"],
        cwd=folder,
        check=True,
    )
    with zipfile.ZipFile(folder / "Crash.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", XML)
        archive.write(folder / "Crash.so", "binaries/linux64/Crash.so")


def run(folder, **parameters):
    (folder / "system.toml").write_text(f"""
        name = "crash"
        stop_time = 1.0
        exchange_step = 0.001
        [components.calm]
        fmu = "Crash.fmu"
        [components.wild]
        fmu = "Crash.fmu"
        step = 0.0005
        parameters = {{ {", ".join(f"{name} = {value}" for name, value in parameters.items())} }}
    """)
    return subprocess.run(
        [
            sys.executable,
            "-m",
            "rockshed.commands.app",
            "run",
            "system.toml",
            "--output-dir",
            "out",
        ],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_a_crash_in_a_step_is_reported_with_component_and_time(tmp_path):
    fmu(tmp_path)
    done = run(tmp_path, crash_at=0.5)
    said = "wild at t = 0.5 s: its code crashed (SIGSEGV) in the step by 0.0005 s"
    assert f"failed: {said}" in done.stderr
    said += f"; `rockshed check {tmp_path / 'Crash.fmu'}` looks for the reason"
    assert done.returncode == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "Crash.fmu",
        "Crash.so",
        "crash.c",
        "out",
        "system.toml",
    ]
    kept = read_run(tmp_path / "out")
    assert (kept.status, kept.provenance["error"]) == ("failed", said)
    assert not list(kept.folder.glob("journal*"))
    assert kept.series["wild.x"].tolist() == kept.series["time"].tolist()


def test_a_crash_before_the_first_step_leaves_nothing(tmp_path):
    fmu(tmp_path, at_start=1)
    done = run(tmp_path)
    assert "failed: calm: its code crashed (SIGSEGV) while it was made ready" in done.stderr
    remedy = f"`rockshed check {tmp_path / 'Crash.fmu'}` looks for the reason"
    assert remedy.replace(" ", "") in "".join(done.stderr.split())
    assert done.returncode == 1
    assert not (tmp_path / "out").exists()
    assert not list(tmp_path.glob("*.running"))


def test_a_run_without_a_crash_leaves_no_journal(tmp_path):
    fmu(tmp_path)
    done = run(tmp_path)
    assert done.returncode == 0, done.stderr
    assert not list((tmp_path / "out").glob("journal*"))

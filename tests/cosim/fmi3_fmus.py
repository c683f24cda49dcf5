"""An FMU of FMI 3.0 in C with one of everything, for tests of what a run makes of it.

Every input of a simple type passes to the output of that type. ``y`` is twice ``u``, both of the
size ``n``; ``sum`` is that of the matrix ``m``. Steps return early at every multiple of ``period``
(where that is positive), count them in ``events``, and end the run at ``end``; ``said`` is ``text``
with the number of events behind it.
"""

import os
import re
import subprocess
import zipfile

import fmpy

SIMPLE = {
    "Float32": "float",
    "Int8": "signed char",
    "UInt8": "unsigned char",
    "Int16": "short",
    "UInt16": "unsigned short",
    "Int32": "int",
    "UInt32": "unsigned",
    "Int64": "long long",
    "UInt64": "unsigned long long",
    "Boolean": "bool",
}
"""Types that have an input and an output, and their types in C."""
REFERENCES = {name: 10 + 2 * place for place, name in enumerate(SIMPLE)}

HEAD = r"""
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
typedef unsigned long long size;
typedef struct {
  double time, u[8], m[6], period, end; int events; long long option; size n; char text[64], said[80];
  void *environment; void (*log)(void *, int, const char *, const char *); bool early; int mode;
  FIELDS
} Thing;
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *where, bool v,
    bool l, bool events, bool early, const unsigned *r, size_t n, void *environment, void *log,
    void *update) {
  Thing *t = calloc(1, sizeof *t);
  t->n = 2; t->environment = environment; t->log = log; t->early = early; t->option = 1;
  t->end = 1e9; strcpy(t->text, "nothing"); t->mode = 0;
  for (int k = 0; k < 8; k++) t->u[k] = 0.5;
  for (int k = 0; k < 6; k++) t->m[k] = k + 1;
  return strcmp(token, "thing") || events ? NULL : t; }
void fmi3FreeInstance(void *c) { free(c); }
int fmi3EnterConfigurationMode(void *c) { ((Thing *)c)->mode = 1; return 0; }
int fmi3ExitConfigurationMode(void *c) { ((Thing *)c)->mode = 0; return 0; }
int fmi3EnterInitializationMode(void *c, bool d, double tolerance, double t, bool e, double stop) {
  ((Thing *)c)->time = t; return 0; }
static int said(Thing *t, const char *text) { t->log(t->environment, 3, "error", text); return 3; }
static size_t length(Thing *t, unsigned r) { return r == 3 || r == 4 ? t->n : r == 5 ? 6 : 1; }
static double *place(Thing *t, unsigned r) {
  return r == 3 ? t->u : r == 5 ? t->m : r == 7 ? &t->period : r == 8 ? &t->end : NULL; }
int fmi3SetFloat64(void *c, const unsigned *r, size_t n, const double *v, size_t values) {
  Thing *t = c; size_t all = 0;
  for (size_t i = 0; i < n; i++) all += length(t, r[i]);
  if (all != values) return said(t, "another number of values");
  for (size_t i = 0; i < n; v += length(t, r[i++])) {
    if (!place(t, r[i])) return said(t, "no such input");
    memcpy(place(t, r[i]), v, length(t, r[i]) * sizeof *v); }
  return 0; }
int fmi3GetFloat64(void *c, const unsigned *r, size_t n, double *v, size_t values) {
  Thing *t = c; size_t all = 0;
  for (size_t i = 0; i < n; i++) all += length(t, r[i]);
  if (all != values) return said(t, "another number of values");
  for (size_t i = 0; i < n; v += length(t, r[i++])) {
    double sum = 0.0; for (int k = 0; k < 6; k++) sum += t->m[k];
    if (place(t, r[i])) memcpy(v, place(t, r[i]), length(t, r[i]) * sizeof *v);
    else if (r[i] == 4) for (size k = 0; k < t->n; k++) v[k] = 2.0 * t->u[k];
    else *v = r[i] == 6 ? sum : t->time; }
  return 0; }
#define MOVES(Name, type, SET, GET) \
  int fmi3Set##Name(void *c, const unsigned *r, size_t n, const type *v, size_t values) { \
    Thing *t = c; for (size_t i = 0; i < n; i++) { SET } return n == values ? 0 : 3; } \
  int fmi3Get##Name(void *c, const unsigned *r, size_t n, type *v, size_t values) { \
    Thing *t = c; for (size_t i = 0; i < n; i++) { GET } return n == values ? 0 : 3; }
int fmi3SetString(void *c, const unsigned *r, size_t n, const char **v, size_t values) {
  for (size_t i = 0; i < n; i++) strncpy(((Thing *)c)->text, v[i], 63); return 0; }
int fmi3GetString(void *c, const unsigned *r, size_t n, const char **v, size_t values) {
  Thing *t = c; snprintf(t->said, sizeof t->said, "%s %d", t->text, t->events);
  for (size_t i = 0; i < n; i++) v[i] = r[i] == 42 ? t->text : t->said; return 0; }
int fmi3DoStep(void *c, double time, double step, bool forgets, bool *event, bool *end,
    bool *early, double *reached) {
  Thing *t = c; double stop = time + step;
  *event = *end = *early = false;
  if (fabs(time - t->time) > 1e-12) return said(t, "not where it is");
  if (t->period > 0.0 && t->early) {
    double next = t->period * (t->events + 1);
    if (next <= stop) { stop = next; t->events++; *early = true; } }
  if (t->end <= stop) { stop = t->end; *end = true; }
  t->time = *reached = stop;
  return STATUS; }
int fmi3GetFMUState(void *c, void **s) {
  if (!*s) *s = malloc(sizeof(Thing)); memcpy(*s, c, sizeof(Thing)); return 0; }
int fmi3SetFMUState(void *c, void *s) {
  void *environment = ((Thing *)c)->environment;
  memcpy(c, s, sizeof(Thing)); ((Thing *)c)->environment = environment; return 0; }
int fmi3FreeFMUState(void *c, void **s) { free(*s); *s = NULL; return 0; }
int fmi3SerializedFMUStateSize(void *c, void *s, size_t *n) { *n = sizeof(Thing); return 0; }
int fmi3SerializeFMUState(void *c, void *s, char *b, size_t n) { memcpy(b, s, n); return 0; }
int fmi3DeserializeFMUState(void *c, const char *b, size_t n, void **s) {
  if (n != sizeof(Thing)) return said(c, "no state of mine");
  *s = malloc(n); memcpy(*s, b, n); return 0; }
"""
OF_INT32 = "if (r[i] == 9) v[i] = t->events; else v[i] = t->of_Int32;"
OF_INT64 = "if (r[i] >= 40) v[i] = t->option; else v[i] = t->of_Int64;"
SET_INT64 = "if (r[i] >= 40) t->option = v[i]; else t->of_Int64 = v[i];"
OF_UINT64 = "if (r[i] == 2) v[i] = t->n; else v[i] = t->of_UInt64;"
SET_UINT64 = (
    "if (r[i] != 2) t->of_UInt64 = v[i]; else if (t->mode != 1) return said(t, "
    '"a size is set in configuration mode only"); else t->n = v[i];'
)
SPECIAL = {
    "Int32": ("t->of_Int32 = v[i];", OF_INT32),
    "Int64": (SET_INT64, OF_INT64),
    "UInt64": (SET_UINT64, OF_UINT64),
}
"""Setter and getter of the types that have other variables too."""
REST = re.findall(
    r"\w+",
    """
    GetVersion SetDebugLogging InstantiateModelExchange InstantiateScheduledExecution
    ExitInitializationMode EnterEventMode Terminate Reset GetBinary GetClock SetBinary SetClock
    GetNumberOfVariableDependencies GetVariableDependencies GetDirectionalDerivative
    GetAdjointDerivative GetIntervalDecimal GetIntervalFraction GetShiftDecimal GetShiftFraction
    SetIntervalDecimal SetIntervalFraction SetShiftDecimal SetShiftFraction EvaluateDiscreteStates
    UpdateDiscreteStates EnterContinuousTimeMode CompletedIntegratorStep SetTime
    SetContinuousStates GetContinuousStateDerivatives GetEventIndicators GetContinuousStates
    GetNominalsOfContinuousStates GetNumberOfEventIndicators GetNumberOfContinuousStates
    EnterStepMode GetOutputDerivatives ActivateModelPartition""",
)


def variables():
    """XML of the variables of all simple types."""
    made = ""
    for name, reference in REFERENCES.items():
        start = "false" if name == "Boolean" else "0"
        made += (
            f"<{name} name='{name}_in' valueReference='{reference}' causality='input' "
            f"variability='discrete' start='{start}'/>"
            f"<{name} name='{name}_out' valueReference='{reference + 1}' causality='output' "
            "variability='discrete'/>"
        )
    return made


XML = f"""<?xml version='1.0'?>
<fmiModelDescription fmiVersion='3.0' modelName='Thing' instantiationToken='thing'>
<CoSimulation modelIdentifier='Thing' canGetAndSetFMUState='true' canSerializeFMUState='true'
 canHandleVariableCommunicationStepSize='true' mightReturnEarlyFromDoStep='true'/>
<UnitDefinitions><Unit name='m'><BaseUnit m='1'/></Unit></UnitDefinitions>
<TypeDefinitions><EnumerationType name='Option'><Item name='one' value='1'/>
<Item name='two' value='2'/></EnumerationType></TypeDefinitions>
<ModelVariables>
<Float64 name='time' valueReference='0' causality='independent' variability='continuous'/>
<UInt64 name='n' valueReference='2' causality='structuralParameter' variability='fixed' start='2'
 min='1' max='8'/>
<Float64 name='u' valueReference='3' causality='input' start='0.5'><Dimension valueReference='2'/>
</Float64>
<Float64 name='y' valueReference='4' causality='output'><Dimension valueReference='2'/></Float64>
<Float64 name='m' valueReference='5' causality='parameter' variability='fixed' unit='m'
 start='1 2 3 4 5 6'><Dimension start='2'/><Dimension start='3'/></Float64>
<Float64 name='sum' valueReference='6' causality='output'/>
<Float64 name='period' valueReference='7' causality='parameter' variability='fixed' start='0'/>
<Float64 name='end' valueReference='8' causality='parameter' variability='fixed' start='1e9'/>
<Int32 name='events' valueReference='9' causality='output' variability='discrete'/>
{variables()}
<Enumeration name='option' declaredType='Option' valueReference='40' causality='input'
 variability='discrete' start='1'/>
<Enumeration name='chosen' declaredType='Option' valueReference='41' causality='output'
 variability='discrete'/>
<String name='text' valueReference='42' causality='input'><Start value='nothing'/></String>
<String name='said' valueReference='43' causality='output'/>
<Binary name='bytes' valueReference='44' causality='input'><Start value='00'/></Binary>
<Binary name='given' valueReference='45' causality='output'/>
</ModelVariables><ModelStructure>
{"".join(f"<Output valueReference='{r}'/>" for r in (4, 6, 9, *(r + 1 for r in REFERENCES.values()), 41, 43, 45))}
{"".join(f"<InitialUnknown valueReference='{r}'/>" for r in (4, 6, 9, *(r + 1 for r in REFERENCES.values()), 41, 43, 45))}
</ModelStructure></fmiModelDescription>"""

TERMINALS = """<?xml version='1.0'?><fmiTerminalsAndIcons fmiVersion='3.0'><Terminals>
<Terminal name='front' matchingRule='plug'>
<TerminalMemberVariable variableName='u' memberName='there' variableKind='signal'/>
<TerminalMemberVariable variableName='y' memberName='back' variableKind='signal'/></Terminal>
<Terminal name='rear' matchingRule='plug'>
<TerminalMemberVariable variableName='y' memberName='there' variableKind='signal'/>
<TerminalMemberVariable variableName='u' memberName='back' variableKind='signal'/></Terminal>
<Terminal name='chosen' matchingRule='bus'>
<TerminalMemberVariable variableName='chosen' memberName='it' variableKind='signal'/></Terminal>
</Terminals></fmiTerminalsAndIcons>"""


def library(folder, status="0", getters=()):
    """Compile the library into a folder and return its path; every step ends with a status.

    ``getters`` by type get outputs otherwise.
    """
    fields = "".join(f"{kind} of_{name};" for name, kind in SIMPLE.items())
    source = HEAD.replace("FIELDS", fields).replace("STATUS", status)
    for name, kind in SIMPLE.items():
        plain = (f"t->of_{name} = v[i];", f"v[i] = t->of_{name};")
        setter, getter = SPECIAL.get(name, plain)
        getter = dict(getters).get(name, getter)
        source += f"MOVES({name}, {kind}, {setter}, {getter})\n"
    source += "".join(f"int fmi3{name}(void *c) {{ return 0; }}\n" for name in REST)
    (folder / "thing.c").write_text(source)
    command = ["cc", "-w", "-shared", "-fPIC", "-o", "Thing.so", "thing.c", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "Thing.so"


def pack(made, target, xml=XML, terminals=TERMINALS, platform=fmpy.platform_tuple):
    """Pack a library with a description to an FMU file."""
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr("modelDescription.xml", xml)
        archive.write(made, f"binaries/{platform}/Thing{os.path.splitext(made)[1]}")
        if terminals:
            archive.writestr("terminalsAndIcons/terminalsAndIcons.xml", terminals)
    return target

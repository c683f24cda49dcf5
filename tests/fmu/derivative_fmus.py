"""FMUs in C that provide partial derivatives, of FMI 2.0 and 3.0, right ones and faulty ones.

``y = s u + v v + c`` and ``z = sin(w) + p u`` follow their inputs ``u``, ``v`` and ``w`` at once,
``s`` is a state with ``ds/dt = v - s``. In FMI 3.0 the vectors ``a`` and ``b = [a1 a2, a1 + 3 a2]``
are there too.
"""

import re
import subprocess
import zipfile

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

SOURCE = r"""
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
enum { U = 1, V, W, Y, Z, S, D, P, A, B };
typedef struct { double now, u, v, w, s, p, a[2], y, z, b[2]; int running; } Thing;
static void follow(Thing *t) {
  t->y = t->s * t->u + t->v * t->v; t->z = OF_W + t->p * t->u;
  t->b[0] = t->a[0] * t->a[1]; t->b[1] = t->a[0] + 3 * t->a[1]; }
static double *place(Thing *t, unsigned r, double *rate) {
  *rate = t->v - t->s;
  return r == U ? &t->u : r == V ? &t->v : r == W ? &t->w : r == Y ? &t->y : r == Z ? &t->z :
    r == S ? &t->s : r == P ? &t->p : r == A ? t->a : r == B ? t->b : rate; }
static void begin(Thing *t) { memset(t, 0, sizeof *t); t->s = 0.7; t->p = 2.0; follow(t); }
static void *made(void) { Thing *t = malloc(sizeof *t); begin(t); return t; }
static size_t length(unsigned r) { return r == A || r == B ? 2 : 1; }
static int get(Thing *t, const unsigned *r, size_t n, double *v) {
  double rate;
  for (size_t i = 0; i < n; v += length(r[i++])) memcpy(v, place(t, r[i], &rate), length(r[i]) * 8);
  return 0; }
static int set(Thing *t, const unsigned *r, size_t n, const double *v) {
  double rate;
  for (size_t i = 0; i < n; v += length(r[i++])) memcpy(place(t, r[i], &rate), v, length(r[i]) * 8);
  if (!t->running || AT_ONCE) follow(t);
  return 0; }
static int step(Thing *t, double h) { t->s += h * (t->v - t->s); t->now += h; IN_STEP; follow(t); return 0; }
static double partial(Thing *t, unsigned f, size_t i, unsigned x, size_t j) {
  if (f == Y) return x == U ? t->s : x == V ? 2 * t->v : x == S ? t->u : HIDDEN;
  if (f == Z) return x == U ? t->p : x == W ? BY_W : x == P ? t->u : 0;
  if (f == D) return x == V ? 1 : x == S ? -1 : 0;
  if (f == B && x == A) return i == 0 ? t->a[1 - j] : j == 0 ? 1 : 3;
  return 0; }
static int directional(Thing *t, const unsigned *f, size_t nf, const unsigned *x, size_t nx,
                       const double *seed, double *out) {
  for (size_t k = 0; k < nf; k++) for (size_t i = 0; i < length(f[k]); i++) {
    double sum = 0; const double *s = seed;
    for (size_t l = 0; l < nx; l++) for (size_t j = 0; j < length(x[l]); j++, s++) ADDED;
    *out++ = SUM; }
  AFTER; return STATUS; }
static int adjoint(Thing *t, const unsigned *f, size_t nf, const unsigned *x, size_t nx,
                   const double *seed, double *out) {
  for (size_t l = 0; l < nx; l++) for (size_t j = 0; j < length(x[l]); j++) {
    double sum = 0; const double *s = seed;
    for (size_t k = 0; k < nf; k++) for (size_t i = 0; i < length(f[k]); i++, s++) WEIGHED;
    *out++ = sum; }
  return 0; }
"""
PARTS = {
    "AT_ONCE": "1",
    "OF_W": "sin(t->w)",
    "BY_W": "cos(t->w)",
    "IN_STEP": "",
    "HIDDEN": "0",
    "ADDED": "sum += *s * partial(t, f[k], i, x[l], j)",
    "WEIGHED": "sum += *s * partial(t, f[k], i, x[l], j)",
    "SUM": "sum",
    "AFTER": "",
    "STATUS": "0",
}
"""Places in the source and what stands there when all is right."""

FMI2 = r"""
void *fmi2Instantiate(void *n, int y, const char *g, void *l, void *c, int v, int d) {
  return strcmp(g, "partial") ? NULL : made(); }
void fmi2FreeInstance(void *c) { free(c); }
int fmi2Reset(void *c) { begin(c); return 0; }
int fmi2SetupExperiment(void *c, int d, double o, double s, int e, double p) {
  ((Thing *)c)->now = s; return 0; }
int fmi2ExitInitializationMode(void *c) { ((Thing *)c)->running = 1; return 0; }
int fmi2GetReal(void *c, const unsigned *r, size_t n, double *v) { return get(c, r, n, v); }
int fmi2SetReal(void *c, const unsigned *r, size_t n, const double *v) { return set(c, r, n, v); }
int fmi2DoStep(void *c, double t, double h, int k) { return step(c, h); }
int fmi2GetFMUstate(void *c, void **s) {
  if (!*s) *s = malloc(sizeof(Thing)); memcpy(*s, c, sizeof(Thing)); return 0; }
int fmi2SetFMUstate(void *c, void *s) { memcpy(c, s, sizeof(Thing)); return 0; }
int fmi2FreeFMUstate(void *c, void **s) { free(*s); *s = NULL; return 0; }
int fmi2GetDirectionalDerivative(void *c, const unsigned *f, size_t nf, const unsigned *x,
    size_t nx, const double *seed, double *out) {
  return directional(c, f, nf, x, nx, seed, out); }
"""
FMI3 = r"""
void *fmi3InstantiateCoSimulation(const char *n, const char *g, const char *w, bool v, bool l,
    bool events, bool early, const unsigned *r, size_t k, void *e, void *log, void *update) {
  return strcmp(g, "partial") || events ? NULL : made(); }
void fmi3FreeInstance(void *c) { free(c); }
int fmi3Reset(void *c) { begin(c); return 0; }
int fmi3EnterInitializationMode(void *c, bool d, double o, double t, bool e, double p) {
  ((Thing *)c)->now = t; return 0; }
int fmi3ExitInitializationMode(void *c) { ((Thing *)c)->running = 1; return 0; }
int fmi3GetFloat64(void *c, const unsigned *r, size_t n, double *v, size_t k) {
  return get(c, r, n, v); }
int fmi3SetFloat64(void *c, const unsigned *r, size_t n, const double *v, size_t k) {
  return set(c, r, n, v); }
int fmi3DoStep(void *c, double t, double h, bool k, bool *event, bool *end, bool *early,
    double *reached) {
  *event = *end = *early = false; *reached = t + h; return step(c, h); }
int fmi3GetFMUState(void *c, void **s) {
  if (!*s) *s = malloc(sizeof(Thing)); memcpy(*s, c, sizeof(Thing)); return 0; }
int fmi3SetFMUState(void *c, void *s) { memcpy(c, s, sizeof(Thing)); return 0; }
int fmi3FreeFMUState(void *c, void **s) { free(*s); *s = NULL; return 0; }
int fmi3GetDirectionalDerivative(void *c, const unsigned *f, size_t nf, const unsigned *x,
    size_t nx, const double *seed, size_t k, double *out, size_t l) {
  return directional(c, f, nf, x, nx, seed, out); }
int fmi3GetAdjointDerivative(void *c, const unsigned *f, size_t nf, const unsigned *x,
    size_t nx, const double *seed, size_t k, double *out, size_t l) {
  return adjoint(c, f, nf, x, nx, seed, out); }
"""

XML2 = """<?xml version='1.0'?>
<fmiModelDescription fmiVersion='2.0' modelName='Partial' guid='partial'>
<CoSimulation modelIdentifier='Partial' canHandleVariableCommunicationStepSize='true'
 canGetAndSetFMUstate='true' providesDirectionalDerivative='true'/>
<DefaultExperiment stopTime='1' stepSize='0.01'/>
<ModelVariables>
<ScalarVariable name='u' valueReference='1' causality='input'><Real start='0'/></ScalarVariable>
<ScalarVariable name='v' valueReference='2' causality='input'>
<Real start='0' nominal='10'/></ScalarVariable>
<ScalarVariable name='w' valueReference='3' causality='input'>
<Real start='0' min='0'/></ScalarVariable>
<ScalarVariable name='y' valueReference='4' causality='output'><Real/></ScalarVariable>
<ScalarVariable name='z' valueReference='5' causality='output'><Real/></ScalarVariable>
<ScalarVariable name='s' valueReference='6' causality='local' initial='exact'>
<Real start='0.7'/></ScalarVariable>
<ScalarVariable name='der(s)' valueReference='7' causality='local' initial='calculated'>
<Real derivative='6'/></ScalarVariable>
<ScalarVariable name='p' valueReference='8' causality='parameter' variability='fixed'>
<Real start='2'/></ScalarVariable>
</ModelVariables><ModelStructure>
<Outputs><Unknown index='4' dependencies='1 2 6'/><Unknown index='5' dependencies='1 3'/></Outputs>
<Derivatives><Unknown index='7' dependencies='2 6'/></Derivatives>
<InitialUnknowns><Unknown index='4' dependencies='1 2 6'/>
<Unknown index='5' dependencies='1 3 8'/><Unknown index='7' dependencies='2 6'/></InitialUnknowns>
</ModelStructure></fmiModelDescription>"""
XML3 = """<?xml version='1.0'?>
<fmiModelDescription fmiVersion='3.0' modelName='Partial' instantiationToken='partial'>
<CoSimulation modelIdentifier='Partial' canHandleVariableCommunicationStepSize='true'
 canGetAndSetFMUState='true' providesDirectionalDerivatives='true'
 providesAdjointDerivatives='true'/>
<DefaultExperiment stopTime='1' stepSize='0.01'/>
<ModelVariables>
<Float64 name='time' valueReference='0' causality='independent' variability='continuous'/>
<Float64 name='u' valueReference='1' causality='input' start='0'/>
<Float64 name='v' valueReference='2' causality='input' start='0' nominal='10'/>
<Float64 name='w' valueReference='3' causality='input' start='0' min='0'/>
<Float64 name='y' valueReference='4' causality='output'/>
<Float64 name='z' valueReference='5' causality='output'/>
<Float64 name='s' valueReference='6' causality='local' initial='exact' start='0.7'/>
<Float64 name='der(s)' valueReference='7' causality='local' initial='calculated' derivative='6'/>
<Float64 name='p' valueReference='8' causality='parameter' variability='fixed' start='2'/>
<Float64 name='a' valueReference='9' causality='input' start='0 0'><Dimension start='2'/></Float64>
<Float64 name='b' valueReference='10' causality='output'><Dimension start='2'/></Float64>
</ModelVariables><ModelStructure>
<Output valueReference='4' dependencies='1 2 6'/><Output valueReference='5' dependencies='1 3'/>
<Output valueReference='10' dependencies='9'/>
<ContinuousStateDerivative valueReference='7' dependencies='2 6'/>
<InitialUnknown valueReference='4' dependencies='1 2 6'/>
<InitialUnknown valueReference='5' dependencies='1 3 8'/>
<InitialUnknown valueReference='7' dependencies='2 6'/>
<InitialUnknown valueReference='10' dependencies='9'/>
</ModelStructure></fmiModelDescription>"""


def make(folder, version, xml=None, **parts):
    """Write Partial.fmu into a folder and return it; ``parts`` replace those of the source."""
    slave = {2: FMU2Slave, 3: FMU3Slave}[version]
    source = SOURCE + {2: FMI2, 3: FMI3}[version]
    for name, text in (PARTS | parts).items():
        source = re.sub(rf"\b{name}\b", lambda _, text=text: text, source)
    names = [name for name in dir(slave) if re.fullmatch(rf"fmi{version}[A-Z]\w+", name)]
    rest = [name for name in names if f" {name}(" not in source.replace("*", " ")]
    source += "".join(f"int {name}(void) {{ return 0; }}\n" for name in rest)
    (folder / "partial.c").write_text(source)
    command = ["cc", "-w", "-shared", "-fPIC", "-o", "Partial.so", "partial.c", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    place = {2: fmpy.platform, 3: fmpy.platform_tuple}[version]
    with zipfile.ZipFile(folder / "Partial.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", xml or {2: XML2, 3: XML3}[version])
        archive.write(folder / "Partial.so", f"binaries/{place}/Partial.so")
    return folder / "Partial.fmu"

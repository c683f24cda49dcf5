/* FMI 2.0 for co-simulation: its functions around the slave in slave.h. */
#define TOKEN "GUID"
#define TO_INITIALISE TO_INITIALISE_2
#define CALL_OF(type) ((type) == ENUMERATION ? INTEGER : (type))
#define HAS_TIME 0
#define TYPE_NAMES { "Real", "Integer", "Boolean", "String", "Enumeration" }
#include "slave.h"

typedef void Logger(void *, Text, Status, Text, Text, ...);
typedef struct { Logger *logger; void *(*allocate)(size_t, size_t); void (*release)(void *); void (*stepFinished)(void *, Status);
                 void *environment; } Callbacks;

static void deliver(Slave *m, Status status, Text category) {
  for (char *c = m->text; *c; c++) if (*c == '%') *c = ' '; /* hosts may take the text for a format */
  if (m->host.logger) ((Logger *)m->host.logger)(m->host.environment, m->name, status, category, m->text);
}

/* --- life cycle */

EXPORT Text fmi2GetTypesPlatform(void) { return "default"; }
EXPORT Text fmi2GetVersion(void) { return "2.0"; }
EXPORT void fmi2FreeInstance(void *c) { free_slave(c); }

EXPORT void *fmi2Instantiate(Text name, int type, Text guid, Text resources, const Callbacks *callbacks, int visible, int logging) {
  Slave *m = callbacks ? new_slave(name, (Host){ (void (*)(void))callbacks->logger, callbacks->environment, 0 }) : NULL;
  if (!m) return NULL;
  if (type != 1) because(m, "model exchange is asked for, and this FMU is for co-simulation");
  return checked(m, guid, logging);
}

EXPORT Status fmi2SetDebugLogging(void *c, int on, size_t n, const Text categories[]) {
  SLAVE;
  for (Status status = WARNING; status <= ERROR; status += ERROR - WARNING) {
    m->told[status] = on && !n;
    for (size_t i = 0; on && i < n; i++)
      m->told[status] |= !strcmp(categories[i], CATEGORIES[status]) || !strcmp(categories[i], "logAll");
  }
  return OK;
}

EXPORT Status fmi2SetupExperiment(void *c, int with_tolerance, double tolerance, double start, int with_stop, double stop) {
  SLAVE; return set_up(m, start, with_stop, stop); }
EXPORT Status fmi2EnterInitializationMode(void *c) { SLAVE; return enter_initialisation(m); }
EXPORT Status fmi2ExitInitializationMode(void *c) { SLAVE; return exit_initialisation(m); }
EXPORT Status fmi2Terminate(void *c) { SLAVE; return terminate(m); }
EXPORT Status fmi2Reset(void *c) { SLAVE; start_anew(m); return OK; }

EXPORT Status fmi2DoStep(void *c, double time, double step, int no_earlier_state) {
  SLAVE;
  if (!may_step(m, time, step)) { tell(m, ERROR); return ERROR; } /* nothing has changed, and the right step may follow */
  return advance(m, time, step, time + step, DISCARD); /* a shorter step from an earlier state may succeed */
}

/* --- values */

/* The ways of every exchange: a block of consecutive references to real variables that can be read as they are, or to inputs that
   may have any finite value. Whatever else there is, is for get and set. */
static int is_block(const Reference r[], size_t n, int trait) {
  Reference different = 0;
  if (!n || r[0] >= NW || !(TRAITS[r[0]] & trait) || n > ALIKE[r[0]]) return 0;
  for (size_t i = 0; i < n; i++) different |= r[i] ^ (r[0] + (Reference)i);
  return !different;
}

static int get_block(const Slave *m, const Reference r[], size_t n, double v[]) {
  if (m->s.phase == INITIALISING || m->s.phase == FAILED || !is_block(r, n, IS_REAL)) return 0;
  memcpy(v, m->s.w + r[0], n * sizeof *v);
  return 1;
}

static int set_block(Slave *m, const Reference r[], size_t n, const double v[]) {
  if (m->s.phase != RUNNING || !is_block(r, n, IS_FREE) || !are_finite(v, n)) return 0;
  memcpy(m->s.w + r[0], v, n * sizeof *v);
  return 1;
}

EXPORT Status fmi2GetReal(void *c, const Reference r[], size_t n, double v[]) {
  SLAVE; return get_block(m, r, n, v) ? OK : get(m, REAL, r, n, v, DOUBLES); }
EXPORT Status fmi2SetReal(void *c, const Reference r[], size_t n, const double v[]) {
  SLAVE; return set_block(m, r, n, v) ? OK : set(m, REAL, r, n, v, DOUBLES); }
EXPORT Status fmi2GetInteger(void *c, const Reference r[], size_t n, int v[]) { SLAVE; return get(m, INTEGER, r, n, v, INTS); }
EXPORT Status fmi2SetInteger(void *c, const Reference r[], size_t n, const int v[]) { SLAVE; return set(m, INTEGER, r, n, v, INTS); }
EXPORT Status fmi2GetBoolean(void *c, const Reference r[], size_t n, int v[]) { SLAVE; return get(m, BOOLEAN, r, n, v, INTS); }
EXPORT Status fmi2SetBoolean(void *c, const Reference r[], size_t n, const int v[]) { SLAVE; return set(m, BOOLEAN, r, n, v, INTS); }
EXPORT Status fmi2GetString(void *c, const Reference r[], size_t n, Text v[]) { SLAVE; return n ? refuse(m, "this FMU has no string") : OK; }
EXPORT Status fmi2SetString(void *c, const Reference r[], size_t n, const Text v[]) { SLAVE; return n ? refuse(m, "this FMU has no string") : OK; }

/* --- complete state */

EXPORT Status fmi2GetFMUstate(void *c, void **state) { SLAVE; return get_state(m, state); }
EXPORT Status fmi2SetFMUstate(void *c, void *state) { SLAVE; return set_state(m, state); }
EXPORT Status fmi2FreeFMUstate(void *c, void **state) { SLAVE; free_state(state); return OK; }
EXPORT Status fmi2SerializedFMUstateSize(void *c, void *state, size_t *n) { SLAVE; *n = SERIALIZED; return OK; }
EXPORT Status fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t n) { SLAVE; return serialize(m, state, bytes, n); }
EXPORT Status fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t n, void **state) {
  SLAVE; return deserialize(m, bytes, n, state); }

/* --- what this FMU has not, as its description says */

EXPORT Status fmi2GetDirectionalDerivative(void *c, const Reference u[], size_t nu, const Reference k[], size_t nk, const double dk[],
                                           double du[]) { SLAVE; return refuse(m, "this FMU has no directional derivatives"); }
EXPORT Status fmi2SetRealInputDerivatives(void *c, const Reference r[], size_t n, const int order[], const double v[]) {
  SLAVE; return refuse(m, "this FMU does not interpolate its inputs"); }
EXPORT Status fmi2GetRealOutputDerivatives(void *c, const Reference r[], size_t n, const int order[], double v[]) {
  SLAVE; return refuse(m, "this FMU has no derivatives of its outputs"); }
EXPORT Status fmi2CancelStep(void *c) { SLAVE; return refuse(m, "no step is under way: steps end before fmi2DoStep returns"); }
EXPORT Status fmi2GetStatus(void *c, int kind, Status *v) { return DISCARD; }
EXPORT Status fmi2GetIntegerStatus(void *c, int kind, int *v) { return DISCARD; }
EXPORT Status fmi2GetStringStatus(void *c, int kind, Text *v) { return DISCARD; }
EXPORT Status fmi2GetRealStatus(void *c, int kind, double *v) { /* 2: time of the last step that succeeded */
  SLAVE;
  if (kind == 2) *v = m->s.time;
  return kind == 2 ? OK : DISCARD;
}
EXPORT Status fmi2GetBooleanStatus(void *c, int kind, int *v) { /* 3: whether the slave wants to end */
  if (kind == 3) *v = 0;
  return kind == 3 ? OK : DISCARD;
}

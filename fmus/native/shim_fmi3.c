/* FMI 3.0 for co-simulation: its functions around the slave in slave.h. An array is one variable; its value reference is that of its
   first element in FMI 2.0. */
#include <stdbool.h>

#define TOKEN "instantiation token"
#define TO_INITIALISE TO_INITIALISE_3
#define CALL_OF(type) (type)
#define HAS_TIME 1
#define TYPE_NAMES { "Float64", "Int32", "Boolean", "String", "Enumeration (Int64)" }
#include "slave.h"

typedef void Logger(void *, Status, Text, Text);

static void deliver(Slave *m, Status status, Text category) {
  char escaped[2 * sizeof m->text], *to = escaped; /* # marks a value reference, ## is a # */
  for (const char *c = m->text; *c; c++) { if (*c == '#') *to++ = '#'; *to++ = *c; }
  *to = 0;
  if (m->host.logger) ((Logger *)m->host.logger)(m->host.environment, status, category, escaped);
}

/* --- life cycle */

EXPORT Text fmi3GetVersion(void) { return "3.0"; }
EXPORT void fmi3FreeInstance(void *c) { free_slave(c); }

static Slave *new_instance(Text name, void *environment, Logger *logger, int takes_early_return) {
  Slave *m = new_slave(name ? name : "", (Host){ (void (*)(void))logger, environment, takes_early_return });
  if (m && m->name[strspn(m->name, " \t\n")] == 0) because(m, "the instance has no name: give it one");
  return m;
}

EXPORT void *fmi3InstantiateCoSimulation(Text name, Text token, Text resources, bool visible, bool logging, bool events, bool early,
                                         const Reference intermediate[], size_t n, void *environment, Logger *logger, void *update) {
  Slave *m = new_instance(name, environment, logger, early);
  if (!m) return NULL;
  if (events) because(m, "event mode is asked for, and this FMU has none (hasEventMode = false): it handles its events in its steps");
  if (n) because(m, "intermediate values of %zu variables are asked for, and this FMU gives none", n);
  return checked(m, token, logging);
}

static void *no_instance(Text name, void *environment, Logger *logger, Text asked) {
  Slave *m = new_instance(name, environment, logger, 0);
  if (!m) return NULL;
  because(m, "%s is asked for, and this FMU is for co-simulation", asked);
  tell(m, ERROR);
  free_slave(m);
  return NULL;
}

EXPORT void *fmi3InstantiateModelExchange(Text name, Text token, Text resources, bool visible, bool logging, void *environment,
                                          Logger *logger) { return no_instance(name, environment, logger, "model exchange"); }
EXPORT void *fmi3InstantiateScheduledExecution(Text name, Text token, Text resources, bool visible, bool logging, void *environment,
                                               Logger *logger, void *update, void *lock, void *unlock) {
  return no_instance(name, environment, logger, "scheduled execution"); }

EXPORT Status fmi3SetDebugLogging(void *c, bool on, size_t n, const Text categories[]) {
  SLAVE;
  for (size_t i = 0; i < (n ? n : 1); i++) {
    int warnings = !n || !strcmp(categories[i], CATEGORIES[WARNING]), errors = !n || !strcmp(categories[i], CATEGORIES[ERROR]);
    if (warnings) m->told[WARNING] = on;
    if (errors) m->told[ERROR] = on;
    if (!warnings && !errors) because(m, "log category %s is unknown: there are %s and %s", categories[i], CATEGORIES[WARNING],
                                      CATEGORIES[ERROR]);
  }
  if (!m->length) return OK;
  tell(m, WARNING);
  return WARNING;
}

EXPORT Status fmi3EnterInitializationMode(void *c, bool with_tolerance, double tolerance, double start, bool with_stop, double stop) {
  SLAVE;
  if (!is_legal(m, CALL_ENTER)) return not_now(m, CALL_ENTER);
  Status status = set_up(m, start, with_stop, stop);
  return status ? status : enter_initialisation(m);
}
EXPORT Status fmi3ExitInitializationMode(void *c) { SLAVE; return exit_initialisation(m); }
EXPORT Status fmi3Terminate(void *c) { SLAVE; return terminate(m); }
EXPORT Status fmi3Reset(void *c) { SLAVE; start_anew(m); return OK; }

/* --- steps */

static int event_is_known(const Slave *m) { /* what the component tells of its next event holds while these inputs are zero */
  for (const int *r = ZERO_UNTIL_EVENT; *r >= 0; r++) if (m->s.w[*r] != 0.0) return 0;
  return EVENT_TIME >= 0;
}

static double stop_at(const Slave *m, double time, double end) { /* the next event if the importer may be told of it, or the end */
  if (!m->host.takes_early_return || !event_is_known(m)) return end;
  double event = m->s.w[EVENT_TIME < 0 ? 0 : EVENT_TIME] + (m->s.time == m->s.start ? m->s.start : 0.0); /* kernels do not know the start */
  double rounding = 4.0 * (nextafter(fabs(end), INFINITY) - fabs(end));
  return event > time && event < end - rounding ? event : end;
}

EXPORT Status fmi3DoStep(void *c, double time, double step, bool no_earlier_state, bool *event_handling, bool *terminated, bool *early,
                         double *reached) {
  SLAVE;
  double end = time + step;
  *event_handling = *terminated = *early = false;
  *reached = m->s.time;
  if (!may_step(m, time, step)) { tell(m, ERROR); return ERROR; } /* nothing has changed, and the right step may follow */
  double stop = stop_at(m, time, end);
  Status status = advance(m, time, stop < end ? stop - time : step, stop, ERROR);
  *early = status == OK && stop < end;
  *reached = m->s.time;
  return status;
}

/* --- values: a call names variables and gives the elements of all of them one after the other */

static size_t length_of(Reference r) { return r < NW && VARIABLES[VARIABLE_OF[r]].length ? (size_t)VARIABLES[VARIABLE_OF[r]].length : 1; }
static int is_first(Reference r) { return r < NW && VARIABLES[VARIABLE_OF[r]].first == (int)r; }

/* The ways of every exchange: real variables that can be read as they are, or inputs that may have any finite value. Whatever else
   there is, is for the functions below. */
static int get_slices(const Slave *m, const Reference r[], size_t n, double v[], size_t values) {
  size_t at = 0;
  if (m->s.phase == INITIALISING || m->s.phase == FAILED) return 0;
  for (size_t i = 0; i < n; at += length_of(r[i++])) if (!is_first(r[i]) || !(TRAITS[r[i]] & IS_REAL)) return 0;
  if (at != values) return 0;
  for (size_t i = at = 0; i < n; at += length_of(r[i++])) memcpy(v + at, m->s.w + r[i], length_of(r[i]) * sizeof *v);
  return 1;
}

static int set_slices(Slave *m, const Reference r[], size_t n, const double v[], size_t values) {
  size_t at = 0;
  if (m->s.phase != RUNNING) return 0;
  for (size_t i = 0; i < n; at += length_of(r[i++])) if (!is_first(r[i]) || !(TRAITS[r[i]] & IS_FREE)) return 0;
  if (at != values || !are_finite(v, values)) return 0;
  for (size_t i = at = 0; i < n; at += length_of(r[i++])) memcpy(m->s.w + r[i], v + at, length_of(r[i]) * sizeof *v);
  return 1;
}

static void check_variable(Slave *m, Reference r, int type) {
  if (is_read_only(r, type) || !is_known(m, r, type) || is_first(r)) return;
  const Variable *v = &VARIABLES[VARIABLE_OF[r]];
  because(m, "value reference %u is %s: an array is read and set as a whole, by the reference %d", r, name_of(r).text, v->first);
}

static void add_counted(Slave *m, Text before, Reference r) { /* a name; of an array, with the number of its elements */
  int length = r < NW ? VARIABLES[VARIABLE_OF[r]].length : 0;
  add(m, "%s%s", before, r < NW ? VARIABLES[VARIABLE_OF[r]].name : READ_ONLY[r - NW]);
  if (length) add(m, "[%d]", length);
}

static void check_number(Slave *m, const Reference r[], size_t n, size_t values) {
  size_t expected = 0;
  for (size_t i = 0; i < n; i++) expected += length_of(r[i]);
  if (expected == values) return;
  because(m, "%s", "");
  for (size_t i = 0; i < n; i++)
    add_counted(m, i ? ", " : "", r[i]);
  add(m, " %s %zu value%s, and %zu %s passed", n == 1 ? "takes" : "take", expected, expected == 1 ? "" : "s", values,
      values == 1 ? "is" : "are");
}

static Reference *elements(Slave *m, const Reference r[], size_t n, size_t values, int type) { /* NULL: refused */
  for (size_t i = 0; i < n; i++) check_variable(m, r[i], type);
  if (!m->length) check_number(m, r, n, values);
  Reference *all = m->length ? NULL : malloc((values + 1) * sizeof *all);
  if (!all && !m->length) because(m, "there is no memory for the references of %zu elements", values);
  for (size_t i = 0, at = 0; all && i < n; i++) for (size_t k = 0; k < length_of(r[i]); k++) all[at++] = r[i] + (Reference)k;
  return all;
}

static Status get_all(Slave *m, int type, const Reference r[], size_t n, void *v, size_t values, Form form) {
  Reference *all = elements(m, r, n, values, type);
  Status status = all ? get(m, type, all, values, v, form) : refused(m);
  free(all);
  return status;
}

static Status set_all(Slave *m, int type, const Reference r[], size_t n, const void *v, size_t values, Form form) {
  for (size_t i = 0; i < n; i++)
    if (is_read_only(r[i], type)) because(m, "%s is refused: it is %s", READ_ONLY[r[i] - NW],
                                          r[i] == TIME ? "set by the steps" : "fixed when the FMU is built");
  Reference *all = elements(m, r, n, values, type);
  Status status = all && !m->length ? set(m, type, all, values, v, form) : refused(m);
  free(all);
  return status;
}

EXPORT Status fmi3GetFloat64(void *c, const Reference r[], size_t n, double v[], size_t values) {
  SLAVE; return get_slices(m, r, n, v, values) ? OK : get_all(m, REAL, r, n, v, values, DOUBLES); }
EXPORT Status fmi3SetFloat64(void *c, const Reference r[], size_t n, const double v[], size_t values) {
  SLAVE; return set_slices(m, r, n, v, values) ? OK : set_all(m, REAL, r, n, v, values, DOUBLES); }

#define MOVES(Name, kind, type, form) \
  EXPORT Status fmi3Get##Name(void *c, const Reference r[], size_t n, kind v[], size_t values) { \
    SLAVE; return get_all(m, type, r, n, v, values, form); } \
  EXPORT Status fmi3Set##Name(void *c, const Reference r[], size_t n, const kind v[], size_t values) { \
    SLAVE; return set_all(m, type, r, n, v, values, form); }
MOVES(Int32, int32_t, INTEGER, INTS)
MOVES(Int64, int64_t, ENUMERATION, LONGS)
MOVES(Boolean, bool, BOOLEAN, BYTES)

static Status none_of(Slave *m, const Reference r[], size_t n, Text type) {
  for (size_t i = 0; i < n; i++)
    if (r[i] < NW) because(m, SAYS_OTHER_TYPE, VARIABLES[VARIABLE_OF[r[i]]].name,
                           TYPES[VARIABLES[VARIABLE_OF[r[i]]].type], type);
    else because(m, "value reference %u: this FMU has no variable of type %s", r[i], type);
  return n ? refused(m) : OK;
}

#define HAS_NONE(Name) \
  EXPORT Status fmi3Get##Name(void *c, const Reference r[], size_t n, void *v, size_t values) { SLAVE; return none_of(m, r, n, #Name); } \
  EXPORT Status fmi3Set##Name(void *c, const Reference r[], size_t n, const void *v, size_t values) { \
    SLAVE; return none_of(m, r, n, #Name); }
HAS_NONE(Float32) HAS_NONE(Int8) HAS_NONE(UInt8) HAS_NONE(Int16) HAS_NONE(UInt16) HAS_NONE(UInt32) HAS_NONE(UInt64) HAS_NONE(String)
EXPORT Status fmi3GetBinary(void *c, const Reference r[], size_t n, size_t sizes[], void *v, size_t values) {
  SLAVE; return none_of(m, r, n, "Binary"); }
EXPORT Status fmi3SetBinary(void *c, const Reference r[], size_t n, const size_t sizes[], const void *v, size_t values) {
  SLAVE; return none_of(m, r, n, "Binary"); }
EXPORT Status fmi3GetClock(void *c, const Reference r[], size_t n, bool v[]) { SLAVE; return none_of(m, r, n, "Clock"); }
EXPORT Status fmi3SetClock(void *c, const Reference r[], size_t n, const bool v[]) { SLAVE; return none_of(m, r, n, "Clock"); }

/* --- complete state */

EXPORT Status fmi3GetFMUState(void *c, void **state) { SLAVE; return get_state(m, state); }
EXPORT Status fmi3SetFMUState(void *c, void *state) { SLAVE; return set_state(m, state); }
EXPORT Status fmi3FreeFMUState(void *c, void **state) { SLAVE; free_state(state); return OK; }
EXPORT Status fmi3SerializedFMUStateSize(void *c, void *state, size_t *n) { SLAVE; *n = SERIALIZED; return OK; }
EXPORT Status fmi3SerializeFMUState(void *c, void *state, char bytes[], size_t n) { SLAVE; return serialize(m, state, bytes, n); }
EXPORT Status fmi3DeserializeFMUState(void *c, const char bytes[], size_t n, void **state) {
  SLAVE; return deserialize(m, bytes, n, state); }

/* --- what this FMU has not, as its description says. Their arguments are left alone. */

#define HAS_NOT(Name, reason) EXPORT Status fmi3##Name(void *c) { SLAVE; return refuse(m, "fmi3" #Name ": " reason); }
#define NO_EVENTS(Name) HAS_NOT(Name, "this FMU has no event mode")
#define NO_CLOCKS(Name) HAS_NOT(Name, "this FMU has no clocks")
#define NO_EXCHANGE(Name) HAS_NOT(Name, "this FMU is for co-simulation, not for model exchange")
NO_EVENTS(EnterEventMode) NO_EVENTS(EnterStepMode) NO_EVENTS(EvaluateDiscreteStates) NO_EVENTS(UpdateDiscreteStates)
NO_CLOCKS(GetIntervalDecimal) NO_CLOCKS(GetIntervalFraction) NO_CLOCKS(GetShiftDecimal) NO_CLOCKS(GetShiftFraction)
NO_CLOCKS(SetIntervalDecimal) NO_CLOCKS(SetIntervalFraction) NO_CLOCKS(SetShiftDecimal) NO_CLOCKS(SetShiftFraction)
NO_CLOCKS(ActivateModelPartition)
NO_EXCHANGE(EnterContinuousTimeMode) NO_EXCHANGE(CompletedIntegratorStep) NO_EXCHANGE(SetTime) NO_EXCHANGE(SetContinuousStates)
NO_EXCHANGE(GetContinuousStateDerivatives) NO_EXCHANGE(GetEventIndicators) NO_EXCHANGE(GetContinuousStates)
NO_EXCHANGE(GetNominalsOfContinuousStates) NO_EXCHANGE(GetNumberOfEventIndicators) NO_EXCHANGE(GetNumberOfContinuousStates)
HAS_NOT(EnterConfigurationMode, "its sizes are fixed when the FMU is built")
HAS_NOT(ExitConfigurationMode, "its sizes are fixed when the FMU is built")
HAS_NOT(GetDirectionalDerivative, "this FMU has no directional derivatives")
HAS_NOT(GetAdjointDerivative, "this FMU has no adjoint derivatives")
HAS_NOT(GetOutputDerivatives, "this FMU has no derivatives of its outputs")
HAS_NOT(GetNumberOfVariableDependencies, "the dependencies stand in modelDescription.xml, there are none of single elements")
HAS_NOT(GetVariableDependencies, "the dependencies stand in modelDescription.xml, there are none of single elements")

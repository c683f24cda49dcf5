/* FMI-LS-WASM for co-simulation: the functions of FMI 3.0 in shim_fmi3.c, under the names and in the form in which the WebAssembly
   component model calls them. A list comes as address and number, an option as flag and value, as FMI's own arguments do; whatever
   is more than one number comes back as an address. What a caller has laid into the memory is the callee's to free. */
#define rockshed_initialise sized_initialise /* kernels are for buffers of any size */
#define rockshed_evaluate sized_evaluate
#define rockshed_step sized_step
#include "shim_fmi3.c"

int64_t any_initialise(double *, double *, int64_t *, int64_t, int64_t, int64_t) __asm__("rockshed_initialise");
int64_t any_evaluate(double *, double *, int64_t *, int64_t, int64_t, int64_t) __asm__("rockshed_evaluate");
int64_t any_step(double, double, double *, double *, int64_t *, int64_t, int64_t, int64_t) __asm__("rockshed_step");
int64_t sized_initialise(double *w, double *x, int64_t *k) { return any_initialise(w, x, k, NW, NX, NK); }
int64_t sized_evaluate(double *w, double *x, int64_t *k) { return any_evaluate(w, x, k, NW, NX, NK); }
int64_t sized_step(double t, double h, double *w, double *x, int64_t *k) { return any_step(t, h, w, x, k, NW, NX, NK); }

#include "fma.h"

/* There are no threads: the kernel does all parts of its work itself. */
int thread_create(int64_t *thread, const void *attributes, void *(*work)(void *), void *share) { return 1; }
int thread_join(int64_t thread, void **returned) { return 0; }

#define NAMED(name) __attribute__((export_name(name)))
#define FROM(module, name) __attribute__((import_module(module), import_name(name)))
#define INTERFACE "fmi:fmi3/co-simulation@3.0.0"
#define RESOURCE "co-simulation-instance"
#define METHOD(name) NAMED(INTERFACE "#[method]" RESOURCE "." name)

FROM("fmi:fmi3/callbacks@3.0.0", "log-message")
void log_message(Text name, size_t, int status, Text category, size_t, Text message, size_t);
FROM("[export]" INTERFACE, "[resource-new]" RESOURCE) int new_handle(Slave *);

/* --- memory that crosses the border */

typedef struct Block { struct Block *next; uint64_t content[]; } Block;
static Block *lent; /* what the caller has laid here for the call that comes or runs */

NAMED("cabi_realloc") void *cabi_realloc(void *old, size_t before, size_t alignment, size_t size) { /* alignment is at most 8 */
  Block **at = &lent;
  while (old && *at && (void *)(*at)->content != old) at = &(*at)->next;
  Block *block = malloc(sizeof *block + size);
  if (!block) __builtin_trap();
  if (before) memcpy(block->content, old, before < size ? before : size);
  if (before && *at) { Block *gone = *at; *at = gone->next; free(gone); }
  block->next = lent;
  lent = block;
  return block->content;
}

static int ended(int status) { /* what was lent is given back at the end of a call */
  while (lent) { Block *next = lent->next; free(lent); lent = next; }
  return status;
}

typedef struct { Text at; size_t length; } String;

static char *text(Text at, size_t length) { /* with the zero at its end that strings of the component model have not */
  char *copy = calloc(length + 1, 1);
  if (!copy) __builtin_trap();
  memcpy(copy, at, length);
  return copy;
}

/* What a call returns lies here until the next one. */
typedef struct { unsigned char failed; union { struct { void *at; size_t length; } list; unsigned char status; }; } ListResult;
typedef struct { double reached; bool event_handling, terminated, early; } Step;
typedef struct { unsigned char failed; union { Step step; unsigned char status; }; } StepResult;
static struct { unsigned char there; int handle; } optional_instance;
static ListResult list_result;
static StepResult step_result;
static void *values; /* of the list in it */

static void *room(Slave *m, size_t size) {
  void *larger = realloc(values, size ? size : 1);
  if (larger) values = larger;
  else because(m, "there is no memory for %zu bytes of values", size);
  return larger;
}

static ListResult *as_list(Status status, size_t length) { /* a warning has been told; there are values all the same */
  ended(0);
  list_result.failed = status > WARNING;
  if (status > WARNING) list_result.status = (unsigned char)status;
  else { list_result.list.at = values; list_result.list.length = length; }
  return &list_result;
}

static StepResult *as_step(Status status, Step step) {
  ended(0);
  step_result.failed = status > WARNING;
  if (status > WARNING) step_result.status = (unsigned char)status;
  else step_result.step = step;
  return &step_result;
}

/* --- life cycle */

static void tell_host(void *name, Status status, Text category, Text message) {
  log_message(name, strlen(name), status, category, strlen(category), message, strlen(message));
}

NAMED("fmi:fmi3/common@3.0.0#get-version") String *version(void) {
  static String s;
  s = (String){ fmi3GetVersion(), strlen(fmi3GetVersion()) };
  return &s;
}

NAMED(INTERFACE "#[static]" RESOURCE ".instantiate-co-simulation")
void *instantiate(Text name, size_t name_length, Text token, size_t token_length, Text resources, size_t resources_length, bool visible,
                  bool logging, bool events, bool early, const Reference intermediate[], size_t n) {
  char *own_name = text(name, name_length), *its_token = text(token, token_length);
  Slave *m = fmi3InstantiateCoSimulation(own_name, its_token, NULL, visible, logging, events, early, intermediate, n, own_name,
                                         tell_host, NULL);
  free(its_token);
  if (!m) free(own_name);
  optional_instance.there = m != NULL;
  if (m) optional_instance.handle = new_handle(m);
  ended(0);
  return &optional_instance;
}

NAMED(INTERFACE "#[dtor]" RESOURCE) void drop(Slave *m) { free(m->host.environment); fmi3FreeInstance(m); }

METHOD("set-debug-logging") int set_debug_logging(Slave *m, bool on, const String categories[], size_t n) {
  Text *texts = calloc(n + 1, sizeof *texts);
  if (!texts) __builtin_trap();
  for (size_t i = 0; i < n; i++) texts[i] = text(categories[i].at, categories[i].length);
  Status status = fmi3SetDebugLogging(m, on, n, texts);
  for (size_t i = 0; i < n; i++) free((void *)texts[i]);
  free(texts);
  return ended(status);
}

METHOD("enter-initialization-mode")
int enter_initialization(Slave *m, bool with_tolerance, double tolerance, double start, bool with_stop, double stop) {
  return ended(fmi3EnterInitializationMode(m, with_tolerance, tolerance, start, with_stop, stop)); }
METHOD("do-step") StepResult *do_step(Slave *m, double time, double step, bool no_earlier_state) {
  Step s;
  Status status = fmi3DoStep(m, time, step, no_earlier_state, &s.event_handling, &s.terminated, &s.early, &s.reached);
  return as_step(status, s);
}
METHOD("get-fmu-state") ListResult *fmu_state(Slave *m) {
  void *state = NULL;
  Status status = fmi3GetFMUState(m, &state);
  if (!status) status = room(m, SERIALIZED) ? fmi3SerializeFMUState(m, state, values, SERIALIZED) : refused(m);
  free_state(&state);
  return as_list(status, SERIALIZED);
}
METHOD("set-fmu-state") int set_fmu_state(Slave *m, const char bytes[], size_t n) {
  void *state = NULL;
  Status status = fmi3DeserializeFMUState(m, bytes, n, &state);
  if (!status) status = fmi3SetFMUState(m, state);
  free_state(&state);
  return ended(status);
}

/* --- values */

static size_t number_of(const Reference r[], size_t n) {
  size_t all = 0;
  for (size_t i = 0; i < n; i++) all += length_of(r[i]);
  return all;
}

#define GETS(name, Name, kind) METHOD("get-" name) ListResult *get_##Name(Slave *m, const Reference r[], size_t n) { \
    size_t all = number_of(r, n); \
    return as_list(room(m, all * sizeof(kind)) ? fmi3Get##Name(m, r, n, values, all) : refused(m), all); }
#define SETS(name, Name, kind) METHOD("set-" name) int set_##Name(Slave *m, const Reference r[], size_t n, const kind v[], size_t all) { \
    return ended(fmi3Set##Name(m, r, n, v, all)); }
#define MOVED(name, Name, kind) GETS(name, Name, kind) SETS(name, Name, kind)
MOVED("float32", Float32, float) MOVED("float64", Float64, double)
MOVED("int8", Int8, int8_t) MOVED("int16", Int16, int16_t) MOVED("int32", Int32, int32_t) MOVED("int64", Int64, int64_t)
MOVED("uint8", UInt8, uint8_t) MOVED("uint16", UInt16, uint16_t) MOVED("uint32", UInt32, uint32_t) MOVED("uint64", UInt64, uint64_t)
MOVED("boolean", Boolean, bool) MOVED("string", String, String)
METHOD("get-binary") ListResult *get_binary(Slave *m, const Reference r[], size_t n) {
  return as_list(fmi3GetBinary(m, r, n, NULL, NULL, 0), 0); }
METHOD("set-binary") int set_binary(Slave *m, const Reference r[], size_t n, const String v[], size_t all) {
  return ended(fmi3SetBinary(m, r, n, NULL, NULL, all)); }
METHOD("get-clock") ListResult *get_clock(Slave *m, const Reference r[], size_t n) { return as_list(fmi3GetClock(m, r, n, NULL), 0); }
METHOD("set-clock") int set_clock(Slave *m, const Reference r[], size_t n, const bool v[], size_t all) {
  return ended(fmi3SetClock(m, r, n, v)); }

/* --- calls of an instance alone, and those that this FMU has not; their arguments are left alone */

#define CALL(name, Name) METHOD(name) int call_##Name(Slave *m) { return ended(fmi3##Name(m)); }
CALL("exit-initialization-mode", ExitInitializationMode) CALL("terminate", Terminate) CALL("reset", Reset)
CALL("enter-event-mode", EnterEventMode) CALL("enter-step-mode", EnterStepMode)
CALL("enter-configuration-mode", EnterConfigurationMode) CALL("exit-configuration-mode", ExitConfigurationMode)
CALL("evaluate-discrete-states", EvaluateDiscreteStates)

typedef const void *Any;
#define NO_SET(name, Name) METHOD(name) int no_##Name(Slave *m, Any r, size_t n, Any v, size_t all) { return ended(fmi3##Name(m)); }
#define NO_LIST(name, Name) METHOD(name) ListResult *no_##Name(Slave *m, Any r, size_t n) { return as_list(fmi3##Name(m), 0); }
#define NO_DERIVATIVE(name, Name) METHOD(name) \
  ListResult *no_##Name(Slave *m, Any of, size_t n, Any by, size_t k, Any seed, size_t all) { return as_list(fmi3##Name(m), 0); }
NO_SET("set-interval-decimal", SetIntervalDecimal) NO_SET("set-interval-fraction", SetIntervalFraction)
NO_SET("set-shift-decimal", SetShiftDecimal) NO_SET("set-shift-fraction", SetShiftFraction)
NO_LIST("get-interval-decimal", GetIntervalDecimal) NO_LIST("get-interval-fraction", GetIntervalFraction)
NO_LIST("get-shift-decimal", GetShiftDecimal) NO_LIST("get-shift-fraction", GetShiftFraction)
NO_LIST("get-output-derivatives", GetOutputDerivatives)
NO_DERIVATIVE("get-directional-derivative", GetDirectionalDerivative) NO_DERIVATIVE("get-adjoint-derivative", GetAdjointDerivative)
METHOD("set-input-derivatives") int no_input_derivatives(Slave *m, Any r, size_t n, Any v, size_t all) {
  return ended(refuse(m, "this FMU takes no derivatives of its inputs")); }
METHOD("get-variable-dependencies") ListResult *no_dependencies(Slave *m, Reference r) {
  return as_list(fmi3GetVariableDependencies(m), 0); }
METHOD("get-number-of-variable-dependencies") StepResult *no_number(Slave *m, Reference r) { /* 64 bits: laid out as a step */
  return as_step(fmi3GetNumberOfVariableDependencies(m), (Step){ 0 }); }
METHOD("update-discrete-states") StepResult *no_discrete_states(Slave *m) {
  return as_step(fmi3UpdateDiscreteStates(m), (Step){ 0 }); }

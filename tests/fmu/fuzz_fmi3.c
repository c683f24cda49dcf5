/* The calls of FMI 3.0 for fuzz.h. */
#include "shim_fmi3.c"
#define fmi_reset fmi3Reset
#include "fuzz.h"

static void heard(void *environment, Status status, Text category, Text text) {
  if (strlen(category) + strlen(text) == (size_t)-1) abort();
}

static Slave *instantiated(Text name, Text token) {
  if (one_in(20) && fmi3InstantiateModelExchange(name, token, "", 0, 1, NULL, heard)) fail("an instance for model exchange");
  if (one_in(20) && fmi3InstantiateCoSimulation(name, token, "", 0, 1, 1, 0, NULL, 0, NULL, heard, NULL)) fail("an event mode");
  return fmi3InstantiateCoSimulation(name, token, "", 0, below(4) > 0, 0, one_in(2), NULL, 0, NULL, heard, NULL);
}

static void release(Slave *m) { fmi3FreeInstance(m); }
static Status begin(Slave *m) { return fmi3EnterInitializationMode(m, 0, 0.0, 0.0, 0, 0.0); }
static Status finish(Slave *m) { return fmi3ExitInitializationMode(m); }

static Status stepped(Slave *m, double time, double step) {
  bool event, terminated, early;
  double reached;
  return fmi3DoStep(m, time, step, 1, &event, &terminated, &early, &reached);
}

static size_t values_of(Reference r) { return length_of(r); }
static Reference proper(Reference r) { return (Reference)VARIABLES[VARIABLE_OF[r]].first; }

static size_t size_of_value(int type) {
  return type == INTEGER ? sizeof(int32_t) : type == BOOLEAN ? sizeof(bool) : type == STRING ? sizeof(Text) : sizeof(int64_t);
}

static void put(void *v, int type, size_t i, double value) {
  int64_t whole = one_in(4) ? any_integer(1) : fabs(value) < 1e9 ? (int64_t)value : 0;
  if (type == REAL) ((double *)v)[i] = value;
  else if (type == INTEGER) ((int32_t *)v)[i] = (int32_t)whole;
  else if (type == BOOLEAN) ((bool *)v)[i] = whole & 1;
  else if (type == STRING) ((Text *)v)[i] = "text";
  else ((int64_t *)v)[i] = whole;
}

static Status read_values(Slave *m, int type, const Reference r[], size_t n, void *v, size_t values) {
  return type == REAL ? fmi3GetFloat64(m, r, n, v, values) : type == INTEGER ? fmi3GetInt32(m, r, n, v, values)
       : type == BOOLEAN ? fmi3GetBoolean(m, r, n, v, values) : type == ENUMERATION ? fmi3GetInt64(m, r, n, v, values)
       : type == STRING ? fmi3GetString(m, r, n, v, values) : fmi3GetUInt64(m, r, n, v, values);
}

static Status write_values(Slave *m, int type, const Reference r[], size_t n, const void *v, size_t values) {
  return type == REAL ? fmi3SetFloat64(m, r, n, v, values) : type == INTEGER ? fmi3SetInt32(m, r, n, v, values)
       : type == BOOLEAN ? fmi3SetBoolean(m, r, n, v, values) : type == ENUMERATION ? fmi3SetInt64(m, r, n, v, values)
       : type == STRING ? fmi3SetString(m, r, n, v, values) : fmi3SetUInt64(m, r, n, v, values);
}

static Status saved(Slave *m, void **state) { return fmi3GetFMUState(m, state); }
static Status restored(Slave *m, void *state) { return fmi3SetFMUState(m, state); }
static Status freed(Slave *m, void **state) { return fmi3FreeFMUState(m, state); }
static Status written(Slave *m, void *state, char bytes[], size_t n) {
  size_t size = 0;
  if (fmi3SerializedFMUStateSize(m, state, &size) || size != SERIALIZED) fail("another size of a state");
  return fmi3SerializeFMUState(m, state, bytes, n);
}
static Status taken_in(Slave *m, const char bytes[], size_t n, void **state) { return fmi3DeserializeFMUState(m, bytes, n, state); }

static void odd_call(Slave *m) {
  static const Text categories[] = { "logStatusWarning", "nonsense", "logStatusError" };
  switch (below(12)) {
    case 0: count(fmi3EnterInitializationMode(m, 0, 0.0, below(4) ? 0.0 : any_number(0.0), below(2), any_number(1.0))); break;
    case 1: if (one_in(5)) count(fmi3Terminate(m)); break;
    case 2: count(fmi3SetDebugLogging(m, below(2), below(4), categories)); break;
    case 3: count(fmi3EnterEventMode(m)); break;
    case 4: count(fmi3EnterStepMode(m)); break;
    case 5: count(fmi3UpdateDiscreteStates(m)); break;
    case 6: count(fmi3EnterConfigurationMode(m)); break;
    case 7: count(fmi3GetDirectionalDerivative(m)); break;
    case 8: count(fmi3GetOutputDerivatives(m)); break;
    case 9: count(fmi3GetIntervalDecimal(m)); break;
    case 10: count(fmi3SetTime(m)); break;
    default: count(fmi3GetNumberOfVariableDependencies(m));
  }
}

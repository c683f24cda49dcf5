/* The calls of FMI 2.0 for fuzz.h. */
#include "shim_fmi2.c"
#define fmi_reset fmi2Reset
#include "fuzz.h"

static void heard(void *environment, Text name, Status status, Text category, Text text, ...) {
  if (strlen(name) + strlen(category) + strlen(text) == (size_t)-1) abort();
}
static const Callbacks CALLBACKS = { heard, calloc, free, NULL, NULL };

static Slave *instantiated(Text name, Text token) {
  if (one_in(20) && fmi2Instantiate(name, 0, token, "", &CALLBACKS, 0, 1)) fail("an instance for model exchange");
  return fmi2Instantiate(name, 1, token, "", &CALLBACKS, 0, below(4) > 0);
}

static void release(Slave *m) { fmi2FreeInstance(m); }

static Status begin(Slave *m) {
  Status status = fmi2SetupExperiment(m, 0, 0.0, 0.0, 0, 0.0);
  return status ? status : fmi2EnterInitializationMode(m);
}

static Status finish(Slave *m) { return fmi2ExitInitializationMode(m); }
static Status stepped(Slave *m, double time, double step) { return fmi2DoStep(m, time, step, 1); }

static size_t values_of(Reference r) { return 1; }
static Reference proper(Reference r) { return r; }
static size_t size_of_value(int type) { return type == REAL ? sizeof(double) : type < STRING ? sizeof(int) : sizeof(Text); }

static void put(void *v, int type, size_t i, double value) {
  if (type == REAL) ((double *)v)[i] = value;
  else if (type < STRING) ((int *)v)[i] = one_in(4) ? (int)any_integer(1) : fabs(value) < 1e9 ? (int)value : 0;
  else ((Text *)v)[i] = "text";
}

static Status read_values(Slave *m, int type, const Reference r[], size_t n, void *v, size_t values) {
  if (n > values) n = values;
  return type == REAL ? fmi2GetReal(m, r, n, v) : type == INTEGER ? fmi2GetInteger(m, r, n, v)
       : type == BOOLEAN ? fmi2GetBoolean(m, r, n, v) : fmi2GetString(m, r, n, v);
}

static Status write_values(Slave *m, int type, const Reference r[], size_t n, const void *v, size_t values) {
  if (n > values) n = values;
  return type == REAL ? fmi2SetReal(m, r, n, v) : type == INTEGER ? fmi2SetInteger(m, r, n, v)
       : type == BOOLEAN ? fmi2SetBoolean(m, r, n, v) : fmi2SetString(m, r, n, v);
}

static Status saved(Slave *m, void **state) { return fmi2GetFMUstate(m, state); }
static Status restored(Slave *m, void *state) { return fmi2SetFMUstate(m, state); }
static Status freed(Slave *m, void **state) { return fmi2FreeFMUstate(m, state); }
static Status written(Slave *m, void *state, char bytes[], size_t n) {
  size_t size = 0;
  if (fmi2SerializedFMUstateSize(m, state, &size) || size != SERIALIZED) fail("another size of a state");
  return fmi2SerializeFMUstate(m, state, bytes, n);
}
static Status taken_in(Slave *m, const char bytes[], size_t n, void **state) { return fmi2DeSerializeFMUstate(m, bytes, n, state); }

static void odd_call(Slave *m) {
  static const Text categories[] = { "logAll", "nonsense", "logStatusError" };
  Reference r[2] = { (Reference)below(NW), (Reference)next() };
  double v[2] = { any_number(1.0), any_number(1.0) };
  int whole[2] = { (int)any_integer(1), 1 };
  Text text = NULL;
  switch (below(12)) {
    case 0: count(fmi2SetupExperiment(m, 0, 0.0, below(4) ? 0.0 : any_number(0.0), (int)below(2), any_number(1.0))); break;
    case 1: count(fmi2EnterInitializationMode(m)); break;
    case 2: if (one_in(5)) count(fmi2Terminate(m)); break;
    case 3: count(fmi2SetDebugLogging(m, (int)below(2), below(4), categories)); break;
    case 4: count(fmi2GetDirectionalDerivative(m, r, 2, r, 2, v, v)); break;
    case 5: count(fmi2SetRealInputDerivatives(m, r, 2, whole, v)); break;
    case 6: count(fmi2GetRealOutputDerivatives(m, r, 2, whole, v)); break;
    case 7: count(fmi2CancelStep(m)); break;
    case 8: count(fmi2GetStatus(m, (int)below(6) - 1, (Status *)whole)); break;
    case 9: count(fmi2GetRealStatus(m, (int)below(6) - 1, v)); count(fmi2GetIntegerStatus(m, (int)below(6) - 1, whole)); break;
    case 10: count(fmi2GetBooleanStatus(m, (int)below(6) - 1, whole)); break;
    default: count(fmi2GetStringStatus(m, (int)below(6) - 1, &text));
  }
}

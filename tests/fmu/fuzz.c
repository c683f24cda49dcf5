/* A native FMU and a host that means it harm, in one program that a sanitizer watches.
   fuzz calls SEED COUNT: random calls of FMI 2.0, legal and illegal. fuzz states SEED COUNT: states with one hostile field and a
   repaired checksum; what is accepted must lead to finite outputs or be refused by the step. */
#include "shim_fmi2.c"
#include <signal.h>
#include <unistd.h>

static uint64_t seed;
static uint64_t next(void) { /* SplitMix64 */
  uint64_t z = seed += 0x9E3779B97F4A7C15ull;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ z >> 27) * 0x94D049BB133111EBull;
  return z ^ z >> 31;
}
static uint64_t below(uint64_t n) { return next() % n; }

static double any_number(double now) {
  static const double odd[] = { NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-300, 5e-324, 0.0, -0.0, -1.0, 1e9, -1e9, 0.5, 1e18, 3.0, 1e6 };
  uint64_t bits = next();
  double value;
  memcpy(&value, &bits, 8);
  switch (below(4)) {
    case 0: return value;
    case 1: return now * (below(2) ? -1.0 : 2.0);
    default: return odd[below(sizeof odd / sizeof *odd)];
  }
}

static int64_t any_integer(int64_t now) {
  static const int64_t odd[] = { -1, 0, 1, 7, 1 << 20, INT32_MAX, INT64_MAX, INT64_MIN, 1ll << 62, 1ll << 32, -1000 };
  switch (below(4)) {
    case 0: return (int64_t)next();
    case 1: return (int64_t)((uint64_t)now + below(1 << 16) - (1 << 15));
    case 2: return (int64_t)((uint64_t)now ^ 1ull << below(64));
    default: return odd[below(sizeof odd / sizeof *odd)];
  }
}

static void heard(void *environment, Text name, Status status, Text category, Text text, ...) {
  if (strlen(name) + strlen(text) == (size_t)-1) abort();
}
static const Callbacks CALLBACKS = { heard, calloc, free, NULL, NULL };

static Slave *instance(size_t letters) {
  char *name = malloc(letters + 1);
  memset(name, 'n', letters);
  name[letters] = 0;
  Slave *m = fmi2Instantiate(name, 1, GUID, "", &CALLBACKS, 0, 1);
  free(name);
  if (!m) exit(3);
  return m;
}

static char hostile[200]; /* where and what the present state's hostile field is */

static void hang(int signal) {
  (void)signal;
  (void)!write(2, "hangs: ", 7);
  (void)!write(2, hostile, strlen(hostile));
  _exit(4);
}

/* --- calls */

enum { MOST = 40, PATIENCE = 300 }; /* values in a call; seconds for a call, on a machine with much else to do */

static void one_call(Slave *m, void **state) {
  Reference r[MOST];
  double v[MOST];
  int integers[MOST];
  Text texts[MOST];
  size_t n = below(MOST), size = 0;
  Reference first = (Reference)below(NW + 4);
  for (size_t i = 0; i < n; i++) {
    r[i] = below(8) ? (first + (Reference)i) % (NW + 2) : below(2) ? (Reference)next() : (Reference)below(NW + 8);
    v[i] = below(3) ? 0.0 : any_number(1.0);
    integers[i] = (int)any_integer(1);
    texts[i] = "text";
  }
  switch (below(20)) {
    case 0: fmi2SetupExperiment(m, 0, 0.0, below(4) ? 0.0 : any_number(0.0), below(2), any_number(1.0)); break;
    case 1: fmi2EnterInitializationMode(m); break;
    case 2: fmi2ExitInitializationMode(m); break;
    case 3: if (!below(20)) fmi2Terminate(m); break;
    case 4: if (!below(3)) fmi2Reset(m); break;
    case 5: case 6: case 7: fmi2GetReal(m, r, n, v); break;
    case 8: case 9: fmi2SetReal(m, r, n, v); break;
    case 10: fmi2GetInteger(m, r, n, integers); fmi2GetBoolean(m, r, n, integers); fmi2GetString(m, r, n, texts); break;
    case 11: fmi2SetInteger(m, r, n, integers); fmi2SetBoolean(m, r, n, integers); fmi2SetString(m, r, n, texts); break;
    case 12: fmi2GetFMUstate(m, state); break;
    case 13: if (*state) fmi2SetFMUstate(m, *state); break;
    case 14: fmi2FreeFMUstate(m, state); break;
    case 15: {
      fmi2SerializedFMUstateSize(m, *state, &size);
      if (!below(10)) size = below(2 * size);
      char *bytes = calloc(size + 1, 1);
      fmi2SerializeFMUstate(m, *state, bytes, size);
      fmi2DeSerializeFMUstate(m, bytes, size, state);
      free(bytes);
      break; }
    case 16: { Text categories[] = { "logAll", "nonsense", "logStatusError" }; fmi2SetDebugLogging(m, (int)below(2), below(4), categories); break; }
    case 17: fmi2GetStatus(m, 3, (Status *)integers); fmi2GetRealStatus(m, (int)below(4), v); fmi2GetBooleanStatus(m, 3, integers); break;
    default: {
      Status status = fmi2DoStep(m, below(10) ? m->s.time : any_number(1.0), below(10) ? 1e-6 : any_number(1e-3) , 1);
      if (status == OK && !are_finite(m->s.w, NW)) { fprintf(stderr, "OK with a value that is not finite\n"); exit(5); }
    }
  }
}

static void call(uint64_t count) {
  Slave *m = NULL;
  void *state = NULL;
  for (uint64_t i = 0; i < count; i++) {
    if (!m || !below(500)) {
      if (state) fmi2FreeFMUstate(m, &state);
      if (m) fmi2FreeInstance(m);
      m = instance(below(4) ? 5 : below(70000));
      if (below(2)) { fmi2SetupExperiment(m, 0, 0.0, 0.0, 0, 0.0); fmi2EnterInitializationMode(m); if (below(2)) fmi2ExitInitializationMode(m); }
    }
    alarm(PATIENCE);
    one_call(m, &state);
  }
  if (state) fmi2FreeFMUstate(m, &state);
  if (m) fmi2FreeInstance(m);
}

/* --- states */

static char *state_after(Slave *m, int steps, double step) {
  void *state = NULL;
  char *bytes = malloc(SERIALIZED);
  fmi2Reset(m);
  if (steps >= 0) {
    fmi2SetupExperiment(m, 0, 0.0, 0.0, 0, 0.0);
    fmi2EnterInitializationMode(m);
  }
  if (steps > 0 && fmi2ExitInitializationMode(m) > WARNING) exit(6);
  for (int i = 0; i < steps; i++) if (fmi2DoStep(m, i * step, step, 1) != OK) exit(6);
  if (fmi2GetFMUstate(m, &state) || fmi2SerializeFMUstate(m, state, bytes, SERIALIZED)) exit(7);
  fmi2FreeFMUstate(m, &state);
  return bytes;
}

static void make_hostile(char *bytes) {
  size_t numbers = NW + NX, words = numbers + NK, which = below(5);
  char *begin = bytes + SEAL + CLOCK + sizeof HEADER, *at = begin + 8 * below(words);
  if (which == 1) at = begin + 8 * below(NW);
  if (which == 2 && NK) at = begin + 8 * (numbers + below(NK));
  if (which == 3 && !below(4)) {
    uint32_t phase = below(2) ? (uint32_t)below(12) : (uint32_t)next();
    memcpy(bytes + SEAL, &phase, 4);
  } else if (which == 3 && !below(8)) {
    double time = any_number(1.0);
    memcpy(bytes + SEAL + 4, &time, 8);
  } else if (at < begin + 8 * numbers) {
    double value;
    memcpy(&value, at, 8);
    value = any_number(value);
    memcpy(at, &value, 8);
    snprintf(hostile, sizeof hostile, "number %zu = %g\n", (size_t)(at - begin) / 8, value);
  } else {
    int64_t value;
    memcpy(&value, at, 8);
    value = any_integer(value);
    memcpy(at, &value, 8);
    snprintf(hostile, sizeof hostile, "integer %zu = %lld\n", (size_t)(at - begin) / 8, (long long)value);
  }
}

static int is_accepted(Slave *m, char *bytes, double step) {
  void *state = NULL;
  uint32_t sum = checksum((unsigned char *)bytes + SEAL, SERIALIZED - SEAL);
  memcpy(bytes + 8, &sum, 4);
  if (fmi2DeSerializeFMUstate(m, bytes, SERIALIZED, &state) != OK) {
    if (state) { fprintf(stderr, "refused, but there is a state\n"); exit(5); }
    return 0;
  }
  Status status = fmi2SetFMUstate(m, state);
  fmi2FreeFMUstate(m, &state);
  if (m->s.phase == INITIALISING) fmi2ExitInitializationMode(m);
  for (int i = 0; i < 3 && status == OK; i++) {
    status = fmi2DoStep(m, m->s.time, step, 1);
    if (status == OK && !are_finite(m->s.w, NW)) { fprintf(stderr, "OK with a value that is not finite\n"); exit(5); }
  }
  Reference r;
  double v;
  for (r = 0; r < NW && m->s.phase != FAILED; r++)
    if (VARIABLES[VARIABLE_OF[r]].type == REAL && fmi2GetReal(m, &r, 1, &v) == OK && !isfinite(v)) { fprintf(stderr, "%s\n", name_of(r).text); exit(5); }
  return 1;
}

static void restore(uint64_t count, double step) {
  static const int after[] = { 5, 40, 3, 0, -1 };
  enum { KINDS = sizeof after / sizeof *after };
  Slave *m = instance(5);
  char *good[KINDS], *bytes = malloc(SERIALIZED);
  uint64_t accepted = 0;
  for (size_t i = 0; i < KINDS; i++) {
    good[i] = state_after(m, after[i], step);
    memcpy(bytes, good[i], SERIALIZED);
    if (!is_accepted(m, bytes, step)) { fprintf(stderr, "a good state is refused\n"); exit(5); }
  }
  for (uint64_t i = 0; i < count; i++) {
    alarm(PATIENCE);
    memcpy(bytes, good[below(below(4) ? 3 : KINDS)], SERIALIZED);
    make_hostile(bytes);
    accepted += (uint64_t)is_accepted(m, bytes, step);
  }
  for (size_t i = 0; i < KINDS; i++) free(good[i]);
  free(bytes);
  fmi2FreeInstance(m);
  printf("%llu accepted\n", (unsigned long long)accepted);
}

int main(int n, char **arguments) {
  signal(SIGALRM, hang);
  seed = strtoull(arguments[2], NULL, 10);
  uint64_t count = strtoull(arguments[3], NULL, 10);
  if (!strcmp(arguments[1], "calls")) call(count); else restore(count, n > 4 ? strtod(arguments[4], NULL) : 1e-5);
  return 0;
}

/* A native FMU and a host that means it harm, in one program that a sanitizer watches. The file that includes this one has the calls
   of one version of FMI. STEP: an ordinary length of a step (s).
   fuzz calls SEED COUNT STEP: calls, legal and illegal. Half of the instances are led through their life, so that kernels run, with
   an illegal call now and then; the other half get calls at random.
   fuzz states SEED COUNT STEP: states with one hostile field and a repaired checksum; what is accepted must lead to finite outputs
   or be refused by the step. */
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
static int one_in(uint64_t n) { return !below(n); }

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

static double usual_step = 1e-5; /* s */

static double any_step(void) { /* Many thousand internal steps in one step show nothing more, and are waited for. */
  enum { LONGEST = 10, REFUSED_AT_ONCE = 1000000000 };
  double step = any_number(usual_step);
  return step > LONGEST * usual_step && step < REFUSED_AT_ONCE ? fmod(step, LONGEST * usual_step) : step;
}

static char hostile[200]; /* where and what the present state's hostile field is */

static void hang(int signal) {
  (void)signal;
  (void)!write(2, "hangs: ", 7);
  (void)!write(2, hostile, strlen(hostile));
  _exit(4);
}

static void fail(Text reason) { fprintf(stderr, "%s\n", reason); exit(5); }

/* --- what the file that includes this one has: calls of its version of FMI, with arguments as they should be */

static Slave *instantiated(Text name, Text token); /* NULL: refused */
static void release(Slave *m);
static Status begin(Slave *m); /* enters the initialization mode */
static Status finish(Slave *m); /* exits it */
static Status stepped(Slave *m, double time, double step);
static Status read_values(Slave *m, int type, const Reference r[], size_t n, void *v, size_t values);
static Status write_values(Slave *m, int type, const Reference r[], size_t n, const void *v, size_t values);
static Status saved(Slave *m, void **state);
static Status restored(Slave *m, void *state);
static Status freed(Slave *m, void **state);
static Status written(Slave *m, void *state, char bytes[], size_t n);
static Status taken_in(Slave *m, const char bytes[], size_t n, void **state);
static size_t values_of(Reference r); /* that a call passes for a reference */
static Reference proper(Reference r); /* the nearest one that a call may name */
static size_t size_of_value(int type);
static void put(void *v, int type, size_t i, double value);
static void odd_call(Slave *m); /* any other function, or one of these in any order with any arguments */

static Slave *instance(size_t letters, int clean) {
  char *name = malloc(letters + 1);
  for (size_t i = 0; i < letters; i++) name[i] = clean ? 'n' : (char)(1 + below(255));
  name[letters] = 0;
  if (one_in(4) && instantiated(name, "{another}")) fail("an instance of another FMU");
  Slave *m = instantiated(name, GUID);
  free(name);
  return m;
}

/* --- calls */

enum { MOST = 40, PATIENCE = 300 }; /* references in a call; seconds for a call, on a machine with much else to do */
static struct { uint64_t calls, taken, starts, steps; } done;

static Status count(Status status) {
  done.calls++;
  done.taken += status <= WARNING;
  return status;
}

static double fair_value(const Slave *m, Reference r) { /* within its bounds, near the present one */
  const Variable *v = &VARIABLES[VARIABLE_OF[r]];
  double now = m->s.w[r], share = (double)below(1001) / 1000.0;
  if (v->type != REAL) return v->low > -1e9 && v->high < 1e9 ? v->low + floor(share * (v->high - v->low)) : now;
  double value = now + (share - 0.5) * 1e-2 * (one_in(4) ? fabs(now) + 1e-3 : fabs(now));
  return value < v->low || value > v->high ? now : value;
}

static void move_values(Slave *m, int out, int fair) { /* arrays are exactly as long as they must be, so that nothing beyond is readable */
  int type = fair ? REAL : (int)below(ENUMERATION + 2);
  size_t n = below(MOST), values = 0, at = 0;
  Reference *r = malloc(n * sizeof *r + 1), first = (Reference)below(NW);
  for (size_t i = 0; i < n; i++) {
    r[i] = proper((first + (Reference)i) % NW);
    if (!fair && one_in(8)) r[i] = one_in(2) ? (Reference)next() : (Reference)below(NW + 8);
    if (fair && !out && VARIABLES[VARIABLE_OF[r[i]]].causality == PARAMETER && m->s.phase == RUNNING) n = i;
    if (fair && (VARIABLES[VARIABLE_OF[r[i]]].type != REAL || (!out && VARIABLES[VARIABLE_OF[r[i]]].causality == OUTPUT))) n = i;
  }
  for (size_t i = 0; i < n; i++) values += values_of(r[i]);
  if (!fair && one_in(8)) values = below(2 * values + 2);
  char *v = calloc(values * size_of_value(type) + 1, 1);
  for (size_t i = 0; !out && i < n; i++)
    for (size_t k = 0; k < values_of(r[i]) && at < values; k++, at++)
      put(v, type, at, fair || (one_in(2) && r[i] + k < NW) ? fair_value(m, r[i] + (Reference)k) : one_in(3) ? 0.0 : any_number(1.0));
  count(out ? read_values(m, type, r, n, v, values) : write_values(m, type, r, n, v, values));
  free(v);
  free(r);
}

static void step(Slave *m, double time, double length) {
  Status status = count(stepped(m, time, length));
  done.steps += status == OK;
  if (status == OK && !are_finite(m->s.w, NW)) fail("OK with a value that is not finite");
}

static void pass_on(Slave *m, void **state) { /* a state through bytes */
  if (!*state && count(saved(m, state))) return;
  size_t size = one_in(10) ? below(2 * SERIALIZED) : SERIALIZED;
  char *bytes = calloc(size + 1, 1);
  count(written(m, *state, bytes, size));
  if (one_in(10)) bytes[below(size + 1)] ^= (char)(1 << below(8));
  count(taken_in(m, bytes, size, state));
  free(bytes);
}

static void state_call(Slave *m, void **state) {
  switch (below(4)) {
    case 0: count(saved(m, state)); break;
    case 1: if (*state) count(restored(m, *state)); break;
    case 2: count(freed(m, state)); break;
    default: pass_on(m, state);
  }
}

static void next_call(Slave *m, void **state) { /* what an importer does in this phase */
  switch (m->s.phase) {
    case INSTANTIATED: if (below(3)) move_values(m, 0, 1); else count(begin(m)); break;
    case INITIALISING:
      if (below(3)) move_values(m, one_in(2), 1);
      else done.starts += count(finish(m)) <= WARNING;
      break;
    case RUNNING:
      if (below(3)) step(m, m->s.time, usual_step * (double)(1 + below(8)) / 4.0);
      else if (below(4)) move_values(m, one_in(2), 1);
      else state_call(m, state);
      break;
    default: if (*state && one_in(2)) count(restored(m, *state)); else count(fmi_reset(m));
  }
}

static void any_call(Slave *m, void **state) {
  switch (below(20)) {
    case 0: count(begin(m)); break;
    case 1: done.starts += count(finish(m)) <= WARNING; break;
    case 2: if (one_in(3)) count(fmi_reset(m)); break;
    case 3: case 4: case 5: case 6: move_values(m, 1, 0); break;
    case 7: case 8: case 9: case 10: move_values(m, 0, 0); break;
    case 11: case 12: case 13: state_call(m, state); break;
    case 14: case 15: case 16: odd_call(m); break;
    default: step(m, below(10) ? m->s.time : any_number(1.0), below(10) ? usual_step : any_step());
  }
}

static void call(uint64_t number) {
  Slave *m = NULL;
  void *state = NULL;
  int is_led = 0;
  while (done.calls < number) {
    if (!m || one_in(500)) {
      if (state) freed(m, &state);
      if (m) release(m);
      while (!(m = instance(one_in(4) ? below(70000) : 1 + below(20), one_in(2)))) continue; /* a name of spaces is none */
      is_led = one_in(2);
    }
    alarm(PATIENCE);
    if (is_led && below(25)) next_call(m, &state); else any_call(m, &state);
  }
  if (state) freed(m, &state);
  if (m) release(m);
  printf("%llu calls, %llu taken, %llu initialised, %llu steps done\n", (unsigned long long)done.calls,
         (unsigned long long)done.taken, (unsigned long long)done.starts, (unsigned long long)done.steps);
}

/* --- states */

static char *state_after(Slave *m, int steps, double length) {
  void *state = NULL;
  char *bytes = malloc(SERIALIZED);
  fmi_reset(m);
  if (steps >= 0) begin(m);
  if (steps > 0 && finish(m) > WARNING) exit(6);
  for (int i = 0; i < steps; i++) if (stepped(m, i * length, length) != OK) exit(6);
  if (saved(m, &state) || written(m, state, bytes, SERIALIZED)) exit(7);
  freed(m, &state);
  return bytes;
}

static void make_hostile(char *bytes) {
  size_t numbers = NW + NX, words = numbers + NK, which = below(5);
  char *start = bytes + SEAL + CLOCK + sizeof HEADER, *at = start + 8 * below(words);
  if (which == 1) at = start + 8 * below(NW);
  if (which == 2 && NK) at = start + 8 * (numbers + below(NK));
  if (which == 3 && one_in(4)) {
    uint32_t phase = below(2) ? (uint32_t)below(12) : (uint32_t)next();
    memcpy(bytes + SEAL, &phase, 4);
    snprintf(hostile, sizeof hostile, "phase = %u\n", phase);
  } else if (which == 3 && one_in(8)) {
    double time = any_number(1.0);
    memcpy(bytes + SEAL + 4, &time, 8);
    snprintf(hostile, sizeof hostile, "time = %g\n", time);
  } else if (at < start + 8 * numbers) {
    double value;
    memcpy(&value, at, 8);
    value = any_number(value);
    memcpy(at, &value, 8);
    snprintf(hostile, sizeof hostile, "number %zu = %g\n", (size_t)(at - start) / 8, value);
  } else {
    int64_t value;
    memcpy(&value, at, 8);
    value = any_integer(value);
    memcpy(at, &value, 8);
    snprintf(hostile, sizeof hostile, "integer %zu = %lld\n", (size_t)(at - start) / 8, (long long)value);
  }
}

static int is_accepted(Slave *m, char *bytes, double length) {
  void *state = NULL;
  uint32_t sum = checksum((unsigned char *)bytes + SEAL, SERIALIZED - SEAL);
  memcpy(bytes + 8, &sum, 4);
  if (taken_in(m, bytes, SERIALIZED, &state) != OK) {
    if (state) fail("refused, but there is a state");
    return 0;
  }
  Status status = restored(m, state);
  freed(m, &state);
  if (m->s.phase == INITIALISING) finish(m);
  for (int i = 0; i < 3 && status == OK; i++) {
    status = stepped(m, m->s.time, length);
    if (status == OK && !are_finite(m->s.w, NW)) fail("OK with a value that is not finite");
  }
  Reference r;
  double v;
  for (r = 0; r < NW && m->s.phase != FAILED; r++)
    if (VARIABLES[VARIABLE_OF[r]].type == REAL && get(m, REAL, &r, 1, &v, DOUBLES) == OK && !isfinite(v)) fail(name_of(r).text);
  return 1;
}

static void restore(uint64_t number, double length) {
  static const int after[] = { 5, 40, 3, 0, -1 };
  enum { KINDS = sizeof after / sizeof *after };
  Slave *m = instance(5, 1);
  char *good[KINDS], *bytes = malloc(SERIALIZED);
  uint64_t accepted = 0;
  for (size_t i = 0; i < KINDS; i++) {
    good[i] = state_after(m, after[i], length);
    memcpy(bytes, good[i], SERIALIZED);
    if (!is_accepted(m, bytes, length)) fail("a good state is refused");
  }
  for (uint64_t i = 0; i < number; i++) {
    alarm(PATIENCE);
    memcpy(bytes, good[below(below(4) ? 3 : KINDS)], SERIALIZED);
    make_hostile(bytes);
    accepted += (uint64_t)is_accepted(m, bytes, length);
  }
  for (size_t i = 0; i < KINDS; i++) free(good[i]);
  free(bytes);
  release(m);
  printf("%llu states, %llu taken\n", (unsigned long long)number, (unsigned long long)accepted);
}

int main(int n, char **arguments) {
  signal(SIGALRM, hang);
  seed = strtoull(arguments[2], NULL, 10);
  uint64_t number = strtoull(arguments[3], NULL, 10);
  usual_step = strtod(arguments[4], NULL);
  if (!strcmp(arguments[1], "calls")) call(number); else restore(number, usual_step);
  return 0;
}

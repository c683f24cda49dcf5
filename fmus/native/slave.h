/* The slave of native FMUs around the kernels of one component, for every version of FMI. model.h, generated from the component's
   declarations and from the rules of conduct of both runtimes (python/conduct.py), has the tables of its variables, when a call is
   legal, and the sentences in which it refuses one. It takes and gives the serialized states of the slave in Python; but a call that
   is refused returns an error itself. Compiled for every processor of its kind; on x86-64 it looks whether the kernels can run on this one. The file
   that includes it has the functions of one version of FMI, and defines the words of that version before:
   TOKEN, TYPE_NAMES, TO_INITIALISE, CALL_OF(type of a variable): the type whose call moves it, HAS_TIME: whether that can be read. */
#ifdef __x86_64__
#include <cpuid.h>
#endif
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef const char *Text;
typedef uint32_t Reference;
typedef enum { OK, WARNING, DISCARD, ERROR } Status;
enum { REAL, INTEGER, BOOLEAN, STRING, ENUMERATION };
enum { PARAMETER, INPUT, OUTPUT };
enum { IS_REAL = 1, IS_FREE = 2 }; /* traits of a reference; free: a real input without bounds */

/* length: 0 for a scalar. low, high: largest finite numbers where there is no bound. range: both in words. */
typedef struct { Text name; int first, length, type, causality; double low, high; Text unit, range, description; } Variable;
typedef struct { int64_t status; Text text; } Fault; /* {5} in the text: the value of reference 5 */
typedef struct { Text array; int is_integer; size_t begin, end, every; int lowest; uint64_t mask; int64_t low, high, multiple;
                 int ascending; } Indices;
#include "model.h"
enum { TIME = NW + NC }; /* value reference of the time, behind those of the sizes */

enum { LINE = 64 }; /* bytes of a cache line. x begins with one in a slave, because its rows are read faster so */
typedef struct { uint64_t mark; uint32_t phase, settled; double start, time, unused[4], x[NX + 1], w[NW]; int64_t k[NK + 1]; } State;
_Static_assert(offsetof(State, x) == LINE, "x does not begin with a cache line");
typedef struct { void (*logger)(void); void *environment; int takes_early_return; } Host; /* what the importer gave to an instance */
typedef struct { State s; Host host; void *block; char *name; double stop, longest; int stale, previewed, told[ERROR + 1];
                 size_t length, begin; char text[16384]; } Slave; /* begin: of the reasons, behind the name */
enum { LONGEST_NAME = 1024 }; /* bytes of an instance's name that messages show */

extern int64_t rockshed_initialise(double *w, double *x, int64_t *k);
extern int64_t rockshed_evaluate(double *w, double *x, int64_t *k);
extern int64_t rockshed_step(double t, double h, double *w, double *x, int64_t *k);

#ifdef _WIN32 /* has no POSIX threads; kernels to whom a thread is refused do its part themselves */
int pthread_create(void *thread, const void *traits, void *(*work)(void *), void *share) { return 1; }
int pthread_join(uint64_t thread, void **result) { return 1; }
#endif

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#define SLAVE Slave *m = c; if (!m) return ERROR

static void deliver(Slave *m, Status status, Text category); /* the message m->text to the importer */

static const Text TYPES[] = TYPE_NAMES;
static const Text CATEGORIES[] = { "", "logStatusWarning", "logStatusWarning", "logStatusError" };

/* --- messages: the reasons of one call are collected in m->text and told together */

static void add_all(Slave *m, Text format, va_list values) {
  int n = vsnprintf(m->text + m->length, sizeof m->text - m->length, format, values);
  m->length += n < 0 ? 0 : (size_t)n;
  if (m->length < sizeof m->text) return;
  m->length = sizeof m->text - 1;
  strcpy(m->text + m->length - 4, " ...");
}

static void add(Slave *m, Text format, ...) {
  va_list values;
  va_start(values, format);
  add_all(m, format, values);
  va_end(values);
}

static void because(Slave *m, Text format, ...) {
  va_list values;
  va_start(values, format);
  if (m->length) add(m, "; ");
  else {
    add(m, "%.*s (" NAME "): ", LONGEST_NAME, m->name);
    m->begin = m->length;
  }
  add_all(m, format, values);
  va_end(values);
}

static void take_reasons(Slave *m, char reasons[], size_t n) { /* without the name before them; none are left */
  snprintf(reasons, n, "%s", m->text + m->begin);
  m->length = 0;
}

static void tell(Slave *m, Status status) {
  if (m->told[status == DISCARD ? WARNING : status]) deliver(m, status, CATEGORIES[status]);
  m->length = 0;
  m->text[0] = 0;
}

static Status refused(Slave *m) { m->s.phase = FAILED; tell(m, ERROR); return ERROR; }
static Status refuse(Slave *m, Text reason) { because(m, "%s", reason); return refused(m); }
static int is_legal(const Slave *m, Call call) { return CALLS[call].phases >> m->s.phase & 1; }
static Status not_now(Slave *m, Call call) { because(m, SAYS_NOT_NOW, CALLS[call].name, REMEDIES[m->s.phase]); return refused(m); }

typedef struct { char text[256]; } Short;
typedef struct { char text[4096]; } Long;
static Short number(double value) { /* as Python writes it */
  Short s;
  if (isnan(value)) strcpy(s.text, "nan"); else snprintf(s.text, sizeof s.text, "%.6g", value);
  return s;
}

static Long formatted(Text format, Text value) {
  Long s;
  snprintf(s.text, sizeof s.text, format, value);
  return s;
}

static Short name_of(Reference r) {
  const Variable *v = &VARIABLES[VARIABLE_OF[r]];
  Short s;
  if (v->length) snprintf(s.text, sizeof s.text, "%s[%d]", v->name, (int)r - v->first + 1);
  else snprintf(s.text, sizeof s.text, "%s", v->name);
  return s;
}

/* --- what the declarations allow */

static int are_finite(const double v[], size_t n) {
  const uint64_t exponent = 0x7FFull << 52, last = 1ull << 52; /* all bits of the exponent are set: the sum reaches the first bit */
  uint64_t sums = 0, bits;
  for (size_t i = 0; i < n; i++) { memcpy(&bits, v + i, 8); sums |= (bits & exponent) + last; }
  return !(sums >> 63);
}

static int in_range(const Variable *v, double value) { return v->low <= value && value <= v->high; } /* false for NaN and inf */

static int is_whole(const Variable *v, double value) { return v->type == REAL || value == floor(value); }

static Long problem(Reference r, double value) {
  const Variable *v = &VARIABLES[VARIABLE_OF[r]];
  Long s;
  if (isfinite(value) && in_range(v, value))
    snprintf(s.text, sizeof s.text, SAYS_NOT_WHOLE, name_of(r).text, number(value).text, v->description);
  else
  if (isfinite(value))
    snprintf(s.text, sizeof s.text, SAYS_OUT_OF_RANGE, name_of(r).text, number(value).text, v->unit, v->range, v->description);
  else snprintf(s.text, sizeof s.text, SAYS_NOT_FINITE, name_of(r).text, number(value).text, v->description);
  return s;
}

static int is_known(Slave *m, Reference r, int type) {
  if (r >= NW) {
    because(m, SAYS_NO_REFERENCE, r, NW - 1);
    return 0;
  }
  int its = VARIABLES[VARIABLE_OF[r]].type;
  if (type == CALL_OF(its)) return 1;
  because(m, SAYS_OTHER_TYPE, name_of(r).text, TYPES[its], TYPES[type]);
  return 0;
}

static void check_set(Slave *m, Reference r, int type, double value) {
  if (!is_known(m, r, type)) return;
  const Variable *v = &VARIABLES[VARIABLE_OF[r]];
  if (v->causality == OUTPUT)
    because(m, SAYS_OUTPUT_SET, name_of(r).text, number(value).text);
  else if (m->s.phase != RUNNING)
    return; /* checked all together when the initialization mode ends */
  else if (v->causality == PARAMETER)
    because(m, SAYS_FIXED, name_of(r).text, number(value).text);
  else if (!in_range(v, value))
    because(m, SAYS_BAD_INPUT, m->s.time, problem(r, value).text);
}

static int values_are_wrong(Slave *m) {
  for (Reference r = 0; r < NW; r++) {
    const Variable *v = &VARIABLES[VARIABLE_OF[r]];
    if (v->causality != OUTPUT && !in_range(v, m->s.w[r])) because(m, "%s", problem(r, m->s.w[r]).text);
  }
  return m->length > 0;
}

static Long fault(const Slave *m, int64_t status) { /* the message of a kernel's status, with the present values in it */
  Long s;
  size_t n = 0;
  Text text = NULL;
  for (size_t i = 0; i < sizeof FAULTS / sizeof *FAULTS; i++) if (FAULTS[i].text && FAULTS[i].status == status) text = FAULTS[i].text;
  if (!text) snprintf(s.text, sizeof s.text, SAYS_UNKNOWN_STATUS, (int)status);
  for (; text && *text && n + sizeof(Short) < sizeof s.text; text++)
    if (*text != '{') s.text[n++] = *text;
    else n += (size_t)snprintf(s.text + n, sizeof(Short), "%s", number(m->s.w[strtol(text + 1, (char **)&text, 10)]).text); /* to the } */
  if (text) s.text[n] = 0;
  return s;
}

static int has_failed(Slave *m, int64_t status) {
  if (status) because(m, "%s", fault(m, status).text);
  return status != 0;
}

static int is_lost(Slave *m) { /* whether a value is no finite number; tells the first one */
  Reference r = 0;
  if (are_finite(m->s.w, NW)) return 0;
  while (isfinite(m->s.w[r])) r++;
  because(m, SAYS_LOST, name_of(r).text, number(m->s.w[r]).text);
  return 1;
}

/* --- life cycle */

#ifdef __x86_64__
static int cpu_fits(void) {
  unsigned a, b, c, d, low, high;
  if (!__get_cpuid(1, &a, &b, &c, &d) || (c & CPU_1C) != CPU_1C) return 0; /* OSXSAVE is among them */
  __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  if ((low & 6) != 6) return 0; /* the system does not save the wide registers */
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || (b & CPU_7B) != CPU_7B) return 0;
  return __get_cpuid(0x80000001, &a, &b, &c, &d) && (c & CPU_81C) == CPU_81C;
}
#else
static int cpu_fits(void) { return 1; } /* kernels keep to what every processor of this kind has */
#endif

static void start_anew(Slave *m) {
  memset(&m->s, 0, sizeof m->s);
  memcpy(m->s.w, START, sizeof START);
  memcpy(m->s.k, TABLE, sizeof TABLE);
  m->s.mark = MARK;
  m->s.phase = INSTANTIATED;
  m->s.time = NAN;
  m->stop = m->longest = INFINITY;
  m->stale = STATE;
  m->previewed = 0;
}

static int64_t deferred(int64_t status) { /* the status, if it blames inputs only, which may change before the first step */
  for (const int64_t *s = DEFERRED; *s; s++) if (*s == status) return status;
  return 0;
}

static int64_t evaluated(Slave *m) { /* a deferred status; otherwise, what is wrong becomes a reason */
  int64_t status = rockshed_evaluate(m->s.w, m->s.x, m->s.k);
  if (deferred(status)) return status;
  if (!has_failed(m, status)) is_lost(m);
  return 0;
}

static int compute(Slave *m, int64_t *put_off) { /* outputs at the start; the state, which may be expensive, only if a parameter has changed */
  *put_off = 0;
  if (m->stale != NOTHING && values_are_wrong(m)) return 0;
  if (m->stale == STATE && has_failed(m, rockshed_initialise(m->s.w, m->s.x, m->s.k))) return 0;
  if (m->stale != NOTHING) *put_off = evaluated(m);
  if (m->length) return 0;
  m->stale = *put_off ? OUTPUTS : NOTHING;
  return 1;
}

static void free_slave(Slave *m) { if (m) { free(m->name); free(m->block); } }

static Slave *new_slave(Text name, Host host) { /* why it cannot be used is told in any case */
  void *block = calloc(1, sizeof(Slave) + LINE);
  Slave *m = (Slave *)(((uintptr_t)block + LINE - 1) / LINE * LINE);
  if (!block || !name || !(m->name = malloc(strlen(name) + 1))) { free(block); return NULL; }
  m->block = block;
  strcpy(m->name, name);
  m->host = host;
  m->told[WARNING] = m->told[ERROR] = 1;
  return m;
}

static Slave *checked(Slave *m, Text token, int logging) { /* NULL if there is any reason against it */
  if (!token || strcmp(token, GUID)) because(m, "the " TOKEN " is %s, and this FMU has " GUID ": read its own modelDescription.xml",
                                             token ? token : "missing");
  if (!cpu_fits()) because(m, "this processor lacks instructions of " CPU ", for which this FMU was compiled: "
                           "use the FMU of this component that runs in Python");
  if (m->length) { tell(m, ERROR); free_slave(m); return NULL; }
  m->told[WARNING] = m->told[ERROR] = logging;
  start_anew(m);
  return m;
}

static Status set_up(Slave *m, double start, int with_stop, double stop) {
  if (!is_legal(m, CALL_SET_UP)) return not_now(m, CALL_SET_UP);
  if (!isfinite(start) || (with_stop && !(stop >= start))) {
    because(m, SAYS_TIMES, number(start).text, with_stop ? number(stop).text : "none");
    return refused(m);
  }
  m->s.start = m->s.time = start;
  m->stop = with_stop ? stop : INFINITY;
  return OK;
}

static Status enter_initialisation(Slave *m) {
  if (!is_legal(m, CALL_ENTER)) return not_now(m, CALL_ENTER);
  if (isnan(m->s.time)) return refuse(m, SAYS_NO_START);
  m->s.phase = INITIALISING;
  return OK;
}

static double longest_stable_step(const Slave *m) { /* internal steps are never longer than the communication step, unless a component has its own */
  int used = OWN_STEP < 0 ? INTERNAL_STEP : OWN_STEP;
  if (used < 0 || STABLE_STEP < 0 || !(m->s.w[used] > m->s.w[STABLE_STEP])) return INFINITY;
  return OWN_STEP < 0 ? m->s.w[STABLE_STEP] : 0.0;
}

static void warn_of_unstable_step(Slave *m) { /* once */
  Short stable = number(m->s.w[STABLE_STEP]);
  because(m, SAYS_UNSTABLE, number(m->s.w[INTERNAL_STEP]).text, stable.text, stable.text);
  tell(m, WARNING);
  m->longest = INFINITY;
}

static Status exit_initialisation(Slave *m) {
  if (!is_legal(m, CALL_EXIT)) return not_now(m, CALL_EXIT);
  int64_t put_off;
  if (!compute(m, &put_off)) return refused(m);
  m->stale = NOTHING;
  m->s.phase = RUNNING;
  if (put_off) {
    because(m, SAYS_DEFERRED, fault(m, put_off).text);
    tell(m, DISCARD);
  }
  m->longest = longest_stable_step(m);
  return OK;
}

static Status terminate(Slave *m) {
  if (m->s.phase == FAILED) return OK;
  if (!is_legal(m, CALL_TERMINATE)) return not_now(m, CALL_TERMINATE);
  m->s.phase = TERMINATED;
  return OK;
}

static Long against_step(const Slave *m, double time, double step) { /* why a step is refused, or nothing */
  double tolerance = 1e-6 * step + 4.0 * (nextafter(fabs(m->s.time), INFINITY) - fabs(m->s.time));
  Long s = { "" };
  if (!is_legal(m, CALL_STEP)) strcpy(s.text, REMEDIES[m->s.phase]);
  else if (!(step > 0.0 && isfinite(step))) strcpy(s.text, SAYS_NO_LENGTH);
  else if (!(fabs(time - m->s.time) <= tolerance)) snprintf(s.text, sizeof s.text, SAYS_ELSEWHERE, m->s.time);
  else if (time + step > m->stop + tolerance) snprintf(s.text, sizeof s.text, SAYS_BEYOND_STOP, m->stop);
  return s;
}

static int may_step(Slave *m, double time, double step) {
  double tolerance = 1e-6 * step;
  if (is_legal(m, CALL_STEP) && step > 0.0 && isfinite(step) && fabs(time - m->s.time) <= tolerance && time + step <= m->stop
      && step <= m->longest) return 1;
  Long reason = against_step(m, time, step);
  if (!*reason.text && step > m->longest) warn_of_unstable_step(m);
  if (!*reason.text) return 1;
  because(m, SAYS_STEP_REFUSED, number(step).text, time, reason.text);
  return 0;
}

static Status advance(Slave *m, double time, double step, double end, Status failure) {
  int64_t status = rockshed_step(time, step, m->s.w, m->s.x, m->s.k);
  if (!status && are_finite(m->s.w, NW)) { m->s.time = end; return OK; }
  if (status) because(m, SAYS_STEP_FAILED, time, fault(m, status).text);
  else {
    char reason[sizeof(Long)];
    is_lost(m);
    take_reasons(m, reason, sizeof reason);
    because(m, SAYS_STEP_FAILED, time, reason);
  }
  refused(m);
  return failure;
}

/* --- values */

static void forget_lost(Slave *m) { /* outputs that are no finite numbers count as not yet computed ones, which are 0 */
  for (Reference r = 0; r < NW; r++)
    if (VARIABLES[VARIABLE_OF[r]].causality == OUTPUT && !isfinite(m->s.w[r])) m->s.w[r] = 0.0;
}

static void preview(Slave *m) { /* what is wrong with the inputs may still be put right */
  int64_t put_off = 0;
  if (!m->previewed && (!compute(m, &put_off) || put_off)) {
    char reasons[sizeof m->text];
    if (put_off) because(m, "%s", fault(m, put_off).text);
    take_reasons(m, reasons, sizeof reasons);
    forget_lost(m);
    because(m, SAYS_NOT_VALID_YET, reasons);
    tell(m, WARNING);
  }
  m->previewed = 1;
}

typedef enum { DOUBLES, INTS, LONGS, BYTES } Form; /* how a call holds its values */

static double taken(const void *v, Form form, size_t i) {
  return form == DOUBLES ? ((const double *)v)[i] : form == INTS ? ((const int32_t *)v)[i]
       : form == LONGS ? (double)((const int64_t *)v)[i] : ((const unsigned char *)v)[i];
}

static void give(void *v, Form form, size_t i, double value) {
  if (form == DOUBLES) ((double *)v)[i] = value;
  else if (form == INTS) ((int32_t *)v)[i] = (int32_t)value;
  else if (form == LONGS) ((int64_t *)v)[i] = (int64_t)value;
  else ((unsigned char *)v)[i] = value != 0.0;
}

static int is_read_only(Reference r, int type) { /* a size, or the time */
  return (type == INTEGER && r >= NW && r < TIME) || (HAS_TIME && type == REAL && r == TIME);
}

static Status get(Slave *m, int type, const Reference r[], size_t n, void *v, Form form) {
  int outputs = 0, lost = 0;
  for (size_t i = 0; i < n; i++)
    if (!is_read_only(r[i], type) && is_known(m, r[i], type)) outputs |= VARIABLES[VARIABLE_OF[r[i]]].causality == OUTPUT;
  if (m->length) return refused(m);
  if (outputs && m->s.phase == INITIALISING) preview(m);
  for (size_t i = 0; i < n; i++)
    if (m->s.phase == FAILED && r[i] < NW && !isfinite(m->s.w[r[i]])) lost = 1;
  if (lost) { is_lost(m); tell(m, WARNING); return DISCARD; }
  for (size_t i = 0; i < n; i++)
    give(v, form, i, r[i] < NW ? type == BOOLEAN ? m->s.w[r[i]] != 0.0 : m->s.w[r[i]] : r[i] < TIME ? SIZES[r[i] - NW] : m->s.time);
  return OK;
}

static Status set(Slave *m, int type, const Reference r[], size_t n, const void *v, Form form) {
  int stale = NOTHING;
  if (!is_legal(m, CALL_SET)) return not_now(m, CALL_SET);
  for (size_t i = 0; i < n; i++) check_set(m, r[i], type, taken(v, form, i));
  if (m->length) return refused(m);
  for (size_t i = 0; i < n; i++) {
    double value = type == BOOLEAN ? taken(v, form, i) != 0.0 : taken(v, form, i);
    int needs = VARIABLES[VARIABLE_OF[r[i]]].causality == PARAMETER ? STATE : OUTPUTS;
    if (m->s.w[r[i]] != value && needs > stale) stale = needs;
    m->s.w[r[i]] = value;
  }
  if (m->s.phase != RUNNING && stale) {
    m->previewed = 0;
    if (stale > m->stale) m->stale = stale;
  }
  return OK;
}

/* --- complete state; without the start serialized as seal (mark, checksum), clock (phase, time), header of the component, w, x, k */

enum { SEAL = 12, CLOCK = 12, BUFFERS = 8 * (NW + NX + NK), SERIALIZED = SEAL + CLOCK + sizeof HEADER + BUFFERS };

static uint32_t checksum(const unsigned char *bytes, size_t n) { /* the CRC-32 of zlib, eight bytes at a time */
  uint32_t table[8][256], sum = ~0u;
  for (uint32_t i = 0; i < 256; i++) {
    table[0][i] = i;
    for (int bit = 0; bit < 8; bit++) table[0][i] = table[0][i] >> 1 ^ (table[0][i] & 1 ? 0xEDB88320u : 0);
  }
  for (int ahead = 1; ahead < 8; ahead++)
    for (int i = 0; i < 256; i++) table[ahead][i] = table[ahead - 1][i] >> 8 ^ table[0][table[ahead - 1][i] & 255];
  for (; n >= 8; n -= 8, bytes += 8) {
    uint64_t word;
    memcpy(&word, bytes, 8);
    word ^= sum;
    sum = 0;
    for (int i = 0; i < 8; i++) sum ^= table[7 - i][word >> 8 * i & 255];
  }
  for (; n; n--, bytes++) sum = sum >> 8 ^ table[0][(sum ^ *bytes) & 255];
  return ~sum;
}

static void carry(void *field, char **at, size_t n, int out) { /* one field of a state, out into bytes or in from them */
  if (out) memcpy(*at, field, n); else memcpy(field, *at, n);
  *at += n;
}

static void carry_fields(State *s, char *at, int out) {
  uint32_t phase = s->phase | s->settled;
  carry(&phase, &at, sizeof phase, out);
  if (!out) {
    s->settled = phase == (INITIALISING | SETTLED) ? SETTLED : 0;
    s->phase = s->settled ? INITIALISING : phase;
  }
  carry(&s->time, &at, sizeof s->time, out);
  if (out) memcpy(at, HEADER, sizeof HEADER);
  at += sizeof HEADER;
  carry(s->w, &at, 8 * NW, out);
  carry(s->x, &at, 8 * NX, out);
  carry(s->k, &at, 8 * NK, out);
}

static State *as_state(void *state) { State *s = state; return s && s->mark == MARK ? s : NULL; }

static Status get_state(Slave *m, void **state) {
  if (!*state && !(*state = malloc(sizeof(State)))) return refuse(m, "there is no memory for another state");
  memcpy(*state, &m->s, sizeof(State));
  as_state(*state)->settled = m->s.phase == INITIALISING && m->stale == NOTHING ? SETTLED : 0;
  return OK;
}

static Status set_state(Slave *m, void *state) {
  if (!as_state(state)) return refuse(m, SAYS_DAMAGED);
  memcpy(&m->s, state, sizeof(State));
  m->stale = m->s.phase > INITIALISING ? NOTHING : m->s.settled ? OUTPUTS : STATE;
  m->previewed = 0;
  return OK;
}

static void free_state(void **state) { if (state) { free(*state); *state = NULL; } }

static Status serialize(Slave *m, void *state, char bytes[], size_t n) {
  if (!as_state(state)) return refuse(m, SAYS_DAMAGED);
  if (n < SERIALIZED) { because(m, "a serialized state has %d bytes; there is room for %zu", (int)SERIALIZED, n); return refused(m); }
  carry_fields(state, bytes + SEAL, 1);
  uint32_t sum = checksum((unsigned char *)bytes + SEAL, SERIALIZED - SEAL);
  memcpy(bytes, "rockslav", 8);
  memcpy(bytes + 8, &sum, 4);
  return OK;
}

static int is_index(const Indices *c, double number, int64_t index) { /* number: of a real array, which must be whole */
  return number == (double)index && c->low <= index && index <= c->high && index % c->multiple == 0;
}

static int are_indices(const State *s, const Indices *c) {
  int64_t before = INT64_MIN;
  for (size_t i = c->begin; i < c->end; i += c->every) {
    double number = c->is_integer ? 0.0 : s->x[i];
    if (!(fabs(number) < 1e15)) return 0;
    int64_t index = c->is_integer ? (int64_t)(((uint64_t)s->k[i] >> c->lowest) & c->mask) : (int64_t)number;
    if (!is_index(c, c->is_integer ? (double)index : number, index) || (c->ascending && index < before)) return 0;
    before = index;
  }
  return 1;
}

static int values_are_possible(Slave *m, const State *s) {
  for (const Indices *c = INDICES; c->array; c++)
    if (!are_indices(s, c)) { because(m, SAYS_IMPOSSIBLE, formatted(SAYS_INDEX_WRONG, c->array).text); return 0; }
  for (Reference r = 0; r < NW; r++) {
    const Variable *v = &VARIABLES[VARIABLE_OF[r]];
    if (v->causality == OUTPUT || (in_range(v, s->w[r]) && is_whole(v, s->w[r]))) continue;
    because(m, SAYS_IMPOSSIBLE, problem(r, s->w[r]).text);
    return 0;
  }
  return 1;
}

static int clock_is_possible(Slave *m, const State *s) {
  int unknown = (s->phase == INSTANTIATED || s->phase == FAILED) && isnan(s->time);
  if (s->phase < INSTANTIATED || s->phase > FAILED) {
    char phase[64];
    snprintf(phase, sizeof phase, SAYS_IMPOSSIBLE_PHASE, s->phase);
    because(m, SAYS_IMPOSSIBLE, phase);
  } else if (!isfinite(s->time) && !unknown)
    because(m, SAYS_IMPOSSIBLE, formatted(SAYS_IMPOSSIBLE_TIME, number(s->time).text).text);
  return !m->length;
}

static int is_possible(Slave *m, const State *s) { /* kernels do not look again at what they use as an index */
  if (!clock_is_possible(m, s)) return 0;
  if (memcmp(s->k, TABLE, 8 * TABLE_LENGTH)) { because(m, SAYS_IMPOSSIBLE, SAYS_TABLE_DIFFERS); return 0; }
  if (!are_finite(s->w, NW) || !are_finite(s->x, NX)) { because(m, SAYS_IMPOSSIBLE, SAYS_NUMBER_NOT_FINITE); return 0; }
  return (s->phase != RUNNING && s->phase != TERMINATED && !s->settled) || values_are_possible(m, s);
}

static Status deserialize(Slave *m, const char bytes[], size_t n, void **state) {
  uint32_t sum = n < SEAL + CLOCK ? 0 : checksum((unsigned char *)bytes + SEAL, n - SEAL);
  if (n < SEAL + CLOCK || memcmp(bytes, "rockslav", 8) || memcmp(bytes + 8, &sum, 4)) return refuse(m, SAYS_DAMAGED);
  if (n != SERIALIZED || memcmp(bytes + SEAL + CLOCK, HEADER, sizeof HEADER)) return refuse(m, SAYS_FOREIGN);
  State *s = calloc(1, sizeof(State));
  if (!s) return refuse(m, "there is no memory for another state");
  s->mark = MARK;
  carry_fields(s, (char *)bytes + SEAL, 0);
  if (!is_possible(m, s)) { free(s); return refused(m); }
  if (*state) { memcpy(*state, s, sizeof *s); free(s); }
  else *state = s;
  return OK;
}

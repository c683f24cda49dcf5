/* Couples FMUs of FMI 2.0 on Linux without any library, one after the other, inputs held.

   coupled_host STEP COUNT < ORDER prints the bits of real variables after COUNT exchanges. Lines of ORDER:
   fmu LIBRARY GUID, set FMU REFERENCE VALUE, choose FMU REFERENCE VALUE (an integer),
   wire FMU REFERENCE FMU REFERENCE, get FMU REFERENCE. FMUs are counted from 0, in the order of their steps. */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 4096 };
typedef int (*Move)(void *, const unsigned *, size_t, double *);
typedef int (*Call)(void *);
static struct {
  void *m;
  Move set, get;
  int (*choose)(void *, const unsigned *, size_t, const int *), (*step)(void *, double, double, int);
  Call enter, leave;
} part[9];
static struct { int source, target; unsigned from, to; } wire[MOST];
static struct { int part; unsigned reference; } shown[MOST];
static int parts, wires, shows;

static void say(void *e, const char *name, int status, const char *category, const char *message, ...) {
  fprintf(stderr, "said %d: %s\n", status, message);
}

static void check(const char *call, int status) {
  if (status <= 1) return;
  printf("%s returned %d\n", call, status);
  exit(1);
}

static void load(const char *library, const char *guid) {
  static struct { void *log, *(*allocate)(size_t, size_t); void (*release)(void *), *finished, *environment; } callbacks;
  void *opened = dlopen(library, RTLD_NOW);
  if (!opened) { printf("%s\n", dlerror()); exit(1); }
  void *(*make)(const char *, int, const char *, const char *, void *, int, int) = dlsym(opened, "fmi2Instantiate");
  int (*set_up)(void *, int, double, double, int, double) = dlsym(opened, "fmi2SetupExperiment");
  callbacks.log = (void *)say;
  callbacks.allocate = calloc;
  callbacks.release = free;
  void *m = make("m", 1, guid, "file:///", &callbacks, 0, 1);
  if (!m) exit(1);
  check("fmi2SetupExperiment", set_up(m, 0, 0.0, 0.0, 0, 0.0));
  part[parts].m = m;
  part[parts].set = (Move)dlsym(opened, "fmi2SetReal");
  part[parts].get = (Move)dlsym(opened, "fmi2GetReal");
  part[parts].choose = dlsym(opened, "fmi2SetInteger");
  part[parts].step = dlsym(opened, "fmi2DoStep");
  part[parts].enter = (Call)dlsym(opened, "fmi2EnterInitializationMode");
  part[parts].leave = (Call)dlsym(opened, "fmi2ExitInitializationMode");
  parts++;
}

static void read_order(void) {
  char line[4096], library[2048], guid[512];
  int i, j;
  unsigned r, q;
  double value;
  while (fgets(line, sizeof line, stdin)) {
    if (sscanf(line, "fmu %2047s %511s", library, guid) == 2) load(library, guid);
    else if (sscanf(line, "set %d %u %lf", &i, &r, &value) == 3) check("fmi2SetReal", part[i].set(part[i].m, &r, 1, &value));
    else if (sscanf(line, "choose %d %u %d", &i, &r, &j) == 3) check("fmi2SetInteger", part[i].choose(part[i].m, &r, 1, &j));
    else if (sscanf(line, "wire %d %u %d %u", &i, &r, &j, &q) == 4) {
      wire[wires].source = i;
      wire[wires].target = j;
      wire[wires].from = r;
      wire[wires++].to = q;
    } else if (sscanf(line, "get %d %u", &i, &r) == 2) {
      shown[shows].part = i;
      shown[shows++].reference = r;
    }
  }
}

static void give(int p) { /* all connected inputs of a part get their newest values */
  for (int i = 0; i < wires; i++) {
    double value;
    int source = wire[i].source;
    if (wire[i].target != p) continue;
    check("fmi2GetReal", part[source].get(part[source].m, &wire[i].from, 1, &value));
    check("fmi2SetReal", part[p].set(part[p].m, &wire[i].to, 1, &value));
  }
}

int main(int count, char **words) {
  double h = atof(words[1]), value;
  read_order();
  for (int i = 0; i < parts; i++) check("fmi2EnterInitializationMode", part[i].enter(part[i].m));
  for (int round = 0; round < 2; round++) for (int i = parts - 1; i >= 0; i--) give(i);
  for (int i = 0; i < parts; i++) check("fmi2ExitInitializationMode", part[i].leave(part[i].m));
  for (int i = parts - 1; i >= 0; i--) give(i);
  for (int n = 0; n < atoi(words[2]); n++) {
    for (int i = 0; i < parts; i++) {
      give(i);
      check("fmi2DoStep", part[i].step(part[i].m, n * h, h, 1));
    }
  }
  for (int i = 0; i < shows; i++) {
    uint64_t bits;
    void *m = part[shown[i].part].m;
    check("fmi2GetReal", part[shown[i].part].get(m, &shown[i].reference, 1, &value));
    memcpy(&bits, &value, sizeof bits);
    printf("%016llx\n", (unsigned long long)bits);
  }
  return 0;
}

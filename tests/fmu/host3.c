/* A host without Python: loads the library of an FMU of FMI 3.0, runs it, prints the values of variables as exact hexadecimal numbers.
   host3 LIBRARY TOKEN STEP COUNT INPUT LENGTH VALUE...  REFERENCE LENGTH...   (INPUT is set to the VALUEs before the start) */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void say(void *environment, int status, const char *category, const char *text) { fprintf(stderr, "%s\n", text); }
static void must(int status, const char *what) { if (status) { fprintf(stderr, "%s returned %d\n", what, status); exit(1); } }

static void *library;
static void *function(const char *name) {
  void *found = dlsym(library, name);
  if (!found) { fprintf(stderr, "there is no %s\n", name); exit(1); }
  return found;
}

int main(int argc, char **argv) {
  double step = atof(argv[3]), values[10000], reached = 0.0;
  unsigned input = atoi(argv[5]), length = atoi(argv[6]);
  bool event, end, early;
  library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
  if (!library) { fprintf(stderr, "%s\n", dlerror()); return 1; }
  void *(*instantiate)(const char *, const char *, const char *, bool, bool, bool, bool, const unsigned *, size_t, void *, void *, void *)
    = function("fmi3InstantiateCoSimulation");
  int (*enter)(void *, bool, double, double, bool, double) = function("fmi3EnterInitializationMode");
  int (*leave)(void *) = function("fmi3ExitInitializationMode"), (*terminate)(void *) = function("fmi3Terminate");
  int (*advance)(void *, double, double, bool, bool *, bool *, bool *, double *) = function("fmi3DoStep");
  int (*set)(void *, const unsigned *, size_t, const double *, size_t) = function("fmi3SetFloat64");
  int (*get)(void *, const unsigned *, size_t, double *, size_t) = function("fmi3GetFloat64");
  void (*release)(void *) = function("fmi3FreeInstance");
  void *slave = instantiate("alone", argv[2], NULL, false, true, false, false, NULL, 0, NULL, say, NULL);
  if (!slave) return 1;
  for (unsigned i = 0; i < length; i++) values[i] = atof(argv[7 + i]);
  must(set(slave, &input, 1, values, length), "fmi3SetFloat64");
  must(enter(slave, false, 0.0, 0.0, false, 0.0), "fmi3EnterInitializationMode");
  must(leave(slave), "fmi3ExitInitializationMode");
  for (int i = 0; i < atoi(argv[4]); i++) must(advance(slave, i * step, step, true, &event, &end, &early, &reached), "fmi3DoStep");
  for (int i = 7 + length; i + 1 < argc; i += 2) {
    unsigned reference = atoi(argv[i]), number = atoi(argv[i + 1]);
    must(get(slave, &reference, 1, values, number), "fmi3GetFloat64");
    for (unsigned k = 0; k < number; k++) printf("%a\n", values[k]);
  }
  must(terminate(slave), "fmi3Terminate");
  release(slave);
  char line[4096];
  for (FILE *maps = fopen("/proc/self/maps", "r"); maps && fgets(line, sizeof line, maps);)
    if (strstr(line, "python")) { fprintf(stderr, "Python is loaded: %s", line); return 1; }
  return 0;
}

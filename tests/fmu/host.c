/* A host without Python: loads the library of an FMU, runs it, prints the values of real variables as exact hexadecimal numbers.
   host LIBRARY GUID STEP COUNT INPUT VALUE REFERENCE...    (the real variable INPUT is set to VALUE before the start) */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct { void (*logger)(void *, const char *, int, const char *, const char *, ...); void *(*allocate)(size_t, size_t);
                 void (*release)(void *); void *finished, *environment; } Callbacks;

static void say(void *e, const char *name, int status, const char *category, const char *text, ...) { fprintf(stderr, "%s\n", text); }

static void must(int status, const char *what) { if (status) { fprintf(stderr, "%s returned %d\n", what, status); exit(1); } }

static void *library;
static void *function(const char *name) {
  void *found = dlsym(library, name);
  if (!found) { fprintf(stderr, "there is no %s\n", name); exit(1); }
  return found;
}

int main(int argc, char **argv) {
  Callbacks callbacks = { say, calloc, free, NULL, NULL };
  double step = atof(argv[3]), value = atof(argv[6]);
  unsigned input = atoi(argv[5]);
  library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
  if (!library) { fprintf(stderr, "%s\n", dlerror()); return 1; }
  void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int) = function("fmi2Instantiate");
  int (*setup)(void *, int, double, double, int, double) = function("fmi2SetupExperiment");
  int (*enter)(void *) = function("fmi2EnterInitializationMode"), (*leave)(void *) = function("fmi2ExitInitializationMode");
  int (*terminate)(void *) = function("fmi2Terminate"), (*advance)(void *, double, double, int) = function("fmi2DoStep");
  int (*set)(void *, const unsigned *, size_t, const double *) = function("fmi2SetReal");
  int (*get)(void *, const unsigned *, size_t, double *) = function("fmi2GetReal");
  void (*release)(void *) = function("fmi2FreeInstance");
  void *slave = instantiate("alone", 1, argv[2], "file:///nowhere", &callbacks, 0, 1);
  if (!slave) return 1;
  must(set(slave, &input, 1, &value), "fmi2SetReal");
  must(setup(slave, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
  must(enter(slave), "fmi2EnterInitializationMode");
  must(leave(slave), "fmi2ExitInitializationMode");
  for (int i = 0; i < atoi(argv[4]); i++) must(advance(slave, i * step, step, 1), "fmi2DoStep");
  for (int i = 7; i < argc; i++) {
    unsigned reference = atoi(argv[i]);
    must(get(slave, &reference, 1, &value), "fmi2GetReal");
    printf("%a\n", value);
  }
  must(terminate(slave), "fmi2Terminate");
  release(slave);
  char line[4096];
  for (FILE *maps = fopen("/proc/self/maps", "r"); maps && fgets(line, sizeof line, maps);)
    if (strstr(line, "python")) { fprintf(stderr, "Python is loaded: %s", line); return 1; }
  return 0;
}

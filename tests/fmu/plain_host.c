/* Runs an FMU of FMI 2.0 without any library: on Linux, and as a program for Windows under wine.

   plain_host LIBRARY GUID STEP COUNT (set REFERENCE VALUE)... get REFERENCE...
   prints the bits of the real variables after COUNT steps, and what the FMU says. */
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(name) (void *)LoadLibraryA(name)
#define FIND(library, name) (void *)GetProcAddress(library, name)
#else
#include <dlfcn.h>
#define OPEN(name) dlopen(name, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

static void say(void *environment, const char *name, int status, const char *category, const char *message, ...) {
  va_list values;
  va_start(values, message);
  printf("said %d: ", status);
  vprintf(message, values);
  printf("\n");
  va_end(values);
}

static void check(const char *call, int status) {
  if (status <= 1) return;
  printf("%s returned %d\n", call, status);
  exit(1);
}

int main(int count, char **words) {
  static struct { void *logger, *(*allocate)(size_t, size_t); void (*release)(void *); void *finished, *environment; } callbacks;
  void *library = OPEN(words[1]), *m;
  if (!library) { printf("cannot be loaded\n"); return 1; }
  void *(*instantiate)(const char *, int, const char *, const char *, void *, int, int) = FIND(library, "fmi2Instantiate");
  int (*set_up)(void *, int, double, double, int, double) = FIND(library, "fmi2SetupExperiment");
  int (*enter)(void *) = FIND(library, "fmi2EnterInitializationMode"), (*leave)(void *) = FIND(library, "fmi2ExitInitializationMode");
  int (*set)(void *, const unsigned *, size_t, const double *) = FIND(library, "fmi2SetReal");
  int (*get)(void *, const unsigned *, size_t, double *) = FIND(library, "fmi2GetReal");
  int (*step)(void *, double, double, int) = FIND(library, "fmi2DoStep");
  double h = atof(words[3]);
  callbacks.logger = (void *)say;
  callbacks.allocate = calloc;
  callbacks.release = free;
  if (!(m = instantiate("m", 1, words[2], "file:///", &callbacks, 0, 1))) return 1;
  check("fmi2SetupExperiment", set_up(m, 0, 0.0, 0.0, 0, 0.0));
  int at = 5;
  for (; at < count && !strcmp(words[at], "set"); at += 3) {
    unsigned reference = atoi(words[at + 1]);
    double value = atof(words[at + 2]);
    check("fmi2SetReal", set(m, &reference, 1, &value));
  }
  check("fmi2EnterInitializationMode", enter(m));
  check("fmi2ExitInitializationMode", leave(m));
  for (int n = 0; n < atoi(words[4]); n++) check("fmi2DoStep", step(m, n * h, h, 1));
  for (at++; at < count; at++) {
    unsigned reference = atoi(words[at]);
    double value;
    uint64_t bits;
    check("fmi2GetReal", get(m, &reference, 1, &value));
    memcpy(&bits, &value, sizeof bits);
    printf("%u %016llx\n", reference, (unsigned long long)bits);
  }
  return 0;
}

/* Runs an FMU of FMI 3.0 without any library: on Linux, and as a program for Windows under wine.

   plain_host3 LIBRARY TOKEN STEP COUNT (set REFERENCE VALUE)... get (REFERENCE LENGTH)...
   prints the bits of the real variables after COUNT steps, and what the FMU says. */
#include <stdbool.h>
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

static void check(const char *call, int status) {
  if (status <= 1) return;
  printf("%s returned %d\n", call, status);
  exit(1);
}

static void say(void *environment, int status, const char *category, const char *message) { printf("said %d: %s\n", status, message); }

int main(int count, char **words) {
  void *library = OPEN(words[1]), *m;
  if (!library) { printf("cannot be loaded\n"); return 1; }
  void *(*instantiate)(const char *, const char *, const char *, bool, bool, bool, bool, const unsigned *, size_t, void *, void *, void *) =
      FIND(library, "fmi3InstantiateCoSimulation");
  int (*enter)(void *, bool, double, double, bool, double) = FIND(library, "fmi3EnterInitializationMode");
  int (*leave)(void *) = FIND(library, "fmi3ExitInitializationMode");
  int (*set)(void *, const unsigned *, size_t, const double *, size_t) = FIND(library, "fmi3SetFloat64");
  int (*get)(void *, const unsigned *, size_t, double *, size_t) = FIND(library, "fmi3GetFloat64");
  int (*step)(void *, double, double, bool, bool *, bool *, bool *, double *) = FIND(library, "fmi3DoStep");
  double h = atof(words[3]), reached;
  bool event, end, early;
  if (!(m = instantiate("m", words[2], NULL, false, true, false, false, NULL, 0, NULL, say, NULL))) return 1;
  int at = 5;
  for (; at < count && !strcmp(words[at], "set"); at += 3) {
    unsigned reference = atoi(words[at + 1]);
    double value = atof(words[at + 2]);
    check("fmi3SetFloat64", set(m, &reference, 1, &value, 1));
  }
  check("fmi3EnterInitializationMode", enter(m, false, 0.0, 0.0, false, 0.0));
  check("fmi3ExitInitializationMode", leave(m));
  for (int n = 0; n < atoi(words[4]); n++) check("fmi3DoStep", step(m, n * h, h, true, &event, &end, &early, &reached));
  for (at++; at + 1 < count; at += 2) {
    unsigned reference = atoi(words[at]);
    size_t length = atoi(words[at + 1]);
    double *values = calloc(length, sizeof *values);
    check("fmi3GetFloat64", get(m, &reference, 1, values, length));
    for (size_t n = 0; n < length; n++) {
      uint64_t bits;
      memcpy(&bits, &values[n], sizeof bits);
      printf("%u %016llx\n", reference, (unsigned long long)bits);
    }
    free(values);
  }
  return 0;
}

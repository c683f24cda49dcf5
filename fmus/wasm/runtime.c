/* What kernels need from a C library, for a host that has none, and their entries with plain integers. */

#include "fma.h"

typedef long long Index;

Index rockshed_initialise(double *, double *, Index *, Index, Index, Index);
Index rockshed_evaluate(double *, double *, Index *, Index, Index, Index);
Index rockshed_step(double, double, double *, double *, Index *, Index, Index, Index);

#define EXPORT(name) __attribute__((export_name(name)))

EXPORT("initialise") int initialise(double *w, double *x, Index *k, int nw, int nx, int nk) {
  return (int)rockshed_initialise(w, x, k, nw, nx, nk);
}

EXPORT("evaluate") int evaluate(double *w, double *x, Index *k, int nw, int nx, int nk) {
  return (int)rockshed_evaluate(w, x, k, nw, nx, nk);
}

EXPORT("step") int step(double t, double h, double *w, double *x, Index *k, int nw, int nx, int nk) {
  return (int)rockshed_step(t, h, w, x, k, nw, nx, nk);
}

/* There are no threads: the kernel does all parts of its work itself. */
int thread_create(Index *thread, const void *attributes, void *(*work)(void *), void *share) { return 1; }
int thread_join(Index thread, void **result) { return 0; }

double sqrt(double number) { return __builtin_sqrt(number); } /* an instruction */

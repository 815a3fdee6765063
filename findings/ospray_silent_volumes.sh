#!/usr/bin/env bash
# OSPRay, as Debian 13 ships it, makes no volumes, and says nothing of it.
#
# One would guess: OSPRay 3.2 renders volumes, which is what it is known for; or, where the distribution leaves out the library that they
# need, ospNewVolume reports an error to the error function, as all its siblings do.
# What happens: ospNewVolume returns null for every type of the manual, and for types that do not exist; neither the error function nor the
# status function is called, at any log level. For a geometry or an image operation that is missing, the denoiser too, the error function
# is called. The first error of a volume is that of the next call, "null handle", which does not say what is missing.
# Why a user of a ray tracer meets it: smoke, clouds and scans are shown by OSPRay in programs of the distribution; they find no cause.
#
# Needs Debian 12, gcc and the network. Debian 13: libospray-dev 3.2.0-1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >make.c <<'C'
#include <ospray/ospray.h>
#include <stdio.h>
#include <string.h>

static int errors, statuses;
static char last[400];

static void on_error(void *user, OSPError code, const char *message) {
  (void)user, (void)code;
  ++errors;
  snprintf(last, sizeof last, "%s", message);
}
static void on_status(void *user, const char *message) {
  (void)user, (void)message;
  ++statuses;
}

int main(int argc, const char **argv) {
  if (ospInit(&argc, argv) != OSP_NO_ERROR) return 1;
  OSPDevice device = ospGetCurrentDevice();
  ospDeviceSetErrorCallback(device, on_error, NULL);
  ospDeviceSetStatusCallback(device, on_status, NULL);
  int level = OSP_LOG_DEBUG;
  ospDeviceSetParam(device, "logLevel", OSP_INT, &level);
  ospDeviceCommit(device);
  errors = statuses = 0;

  const char *kind = argv[1], *type = argv[2];
  void *made = NULL;
  if (strcmp(kind, "volume") == 0) made = ospNewVolume(type);
  if (strcmp(kind, "geometry") == 0) made = ospNewGeometry(type);
  if (strcmp(kind, "operation") == 0) made = ospNewImageOperation(type);
  printf("%s, %d errors, %d statuses", made != NULL ? "made" : "null", errors, statuses);
  if (strcmp(kind, "volume") == 0) {
    const int cells[3] = {2, 2, 2};
    errors = 0, last[0] = 0;
    ospSetParam(made, "dimensions", OSP_VEC3I, cells);
    printf("; then %d errors: %.11s", errors, last);
  }
  printf("\n");
  ospShutdown();
  return 0;
}
C

unpack trixie amd64 libospray-dev=3.2.0-1
gcc -O1 -I"$root/usr/include" make.c -o make -L"$libraries" -lospray -Wl,-rpath-link,"$libraries" -Wl,--allow-shlib-undefined
guess "volumes are made, or the error function says why not"
# make_one KIND TYPE: prints what became of it.
make_one() { run ./make "$1" "$2" 2>&1; }
seen "geometry mesh, for comparison" "made, 0 errors, 0 statuses" "$(make_one geometry mesh)"
seen "a geometry that does not exist" "null, 1 errors, 0 statuses" "$(make_one geometry egg)"
seen "the denoiser" "null, 1 errors, 0 statuses" "$(make_one operation denoiser)"
for type in structuredRegular structuredSpherical amr unstructured vdb particle egg; do
  seen "volume $type" "null, 0 errors, 0 statuses; then 1 errors: null handle" "$(make_one volume $type)"
done
finish

#!/usr/bin/env bash
# A program that includes OpenVDB does not compile once OpenVDB is installed.
#
# One would guess: libopenvdb-dev brings along what its headers include, as other packages of headers do.
# What happens: with libopenvdb-dev 10.0.1 of Debian 12 or 13 and all that it depends on, <openvdb/openvdb.h> ends in "fatal error:
# boost/numeric/conversion/conversion_traits.hpp: No such file or directory". The package depends on the headers of blosc, Imath and TBB, and
# not on Boost's. With libboost-dev it compiles.
# Why a user of a ray tracer meets it: a build that looks for the header and the library finds both, and stops in the middle, or leaves smoke out.
#
# Needs Debian 12, g++ and the network. Debian 12: libopenvdb-dev 10.0.1-2, g++ 4:12.2.0-3, libboost-dev 1.74.0.3. Debian 13: libopenvdb-dev
# 10.0.1-2.3+b1, g++-12 12.4.0-5. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >program.cpp <<'CPP'
#include <openvdb/openvdb.h>
int main() { openvdb::initialize(); }
CPP
# compile SUITE PACKAGE...: what the compiler says if there are only the headers of these packages and of what they depend on.
compile() {
  unpack "$1" amd64 "${@:2}"
  local errors
  if errors=$(g++ --sysroot="$root" -fsyntax-only program.cpp 2>&1); then
    result="it compiles"
  else
    result=$(sed -n 's/.*fatal error: //p' <<<"$errors")
  fi
}
missing="boost/numeric/conversion/conversion_traits.hpp: No such file or directory"

guess "it compiles"
compile bookworm libopenvdb-dev=10.0.1-2 g++=4:12.2.0-3
seen "Debian 12" "$missing" "$result"
compile trixie libopenvdb-dev=10.0.1-2.3+b1 g++-12=12.4.0-5
seen "Debian 13" "$missing" "$result"
compile bookworm libopenvdb-dev=10.0.1-2 g++=4:12.2.0-3 libboost-dev=1.74.0.3
seen "with libboost-dev" "it compiles" "$result"
finish

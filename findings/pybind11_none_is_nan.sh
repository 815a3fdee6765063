#!/usr/bin/env bash
# A function that takes an array of floats through pybind11 accepts None, and gets NaN.
#
# One would guess: None, a text or a date in place of an array of floats is a TypeError. A masked element is not used.
# What happens: py::array_t<float> of pybind11 2.10.3 hands everything to numpy 1.24.2 with "cast at any price". None
# becomes an array without dimensions that holds NaN, None in a list becomes NaN, "1.5" becomes 1.5, the day 2020-01-01 becomes
# 18262, and the number under the mask of a masked array is used. For py::array_t<uint32_t> None is a TypeError, but -1 becomes 4294967295.
# Why a user of a ray tracer meets it: rays and points come from scripts in which a step returned None or a masked
# array. NaN rays miss everything, so the answer is "no hits", not an error.
#
# Needs Debian 12, g++ and the network. Debian 12: pybind11-dev 2.10.3-1, python3-numpy 1:1.24.2-1+deb12u1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 pybind11-dev=2.10.3-1 python3-numpy=1:1.24.2-1+deb12u1 libpython3.11-dev
cd "$work"

cat >module.cpp <<'CPP'
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
namespace py = pybind11;
template <typename T>
std::string first(py::array_t<T, py::array::c_style | py::array::forcecast> values) {
  return std::to_string(values.data()[0]) + " in " + std::to_string(values.ndim()) + " dimensions";
}
PYBIND11_MODULE(arrays, module) {
  module.def("floats", &first<float>);
  module.def("indices", &first<std::uint32_t>);
}
CPP
g++ -std=c++17 -fPIC -shared -I"$root/usr/include" -I"$root/usr/include/python3.11" module.cpp -o arrays.so
cat >ask.py <<'PYTHON'
import sys

sys.path.insert(0, ".")
import arrays
import numpy as np

masked = np.ma.array([9.0, 2.0], mask=[True, False])
for function, value in (
    (arrays.floats, None), (arrays.floats, [None, 1.0]), (arrays.floats, "1.5"), (arrays.floats, np.array(["2020-01-01"], "datetime64[D]")),
    (arrays.floats, masked), (arrays.indices, None), (arrays.indices, np.array([-1])),
):
    try:
        print(function(value))
    except TypeError:
        print("TypeError")
PYTHON
python ask.py >out

guess "TypeError, but for the masked array 2.0 or TypeError"
seen "floats(None)" "nan in 0 dimensions" "$(sed -n 1p out)"
seen "floats([None, 1.0])" "nan in 1 dimensions" "$(sed -n 2p out)"
seen "floats('1.5')" "1.500000 in 0 dimensions" "$(sed -n 3p out)"
seen "floats of the day 2020-01-01" "18262.000000 in 1 dimensions" "$(sed -n 4p out)"
seen "floats of an array whose first element, 9, is masked" "9.000000 in 1 dimensions" "$(sed -n 5p out)"
seen "indices(None)" "TypeError" "$(sed -n 6p out)"
seen "indices of -1" "4294967295 in 1 dimensions" "$(sed -n 7p out)"
finish

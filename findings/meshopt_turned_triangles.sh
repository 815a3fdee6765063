#!/usr/bin/env bash
# meshoptimizer's lossless index codec gives nearly all triangles back with another first vertex.
#
# One would guess: what a lossless codec decodes is what was encoded.
# What happens: meshoptimizer 0.18 keeps each triangle and its orientation, but turns 2016 of the 2048 triangles of a grid: a b c comes
# back as b c a or c a b. The codec of the glTF extension EXT_meshopt_compression is this one.
# Why a user of a ray tracer meets it: u and v of a hit count from the first vertex. Colours, light maps or ground truth that a program
# stored by triangle, u and v belong to other points after the file was packed, though positions, normals and order of triangles are the same.
#
# Needs Debian 12, g++ and the network. Debian 12: libmeshoptimizer-dev 0.18+dfsg-2. About 20 seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 libmeshoptimizer-dev=0.18+dfsg-2 libmeshoptimizer2d=0.18+dfsg-2
cd "$work"

cat >codec.cpp <<'CPP'
#include <meshoptimizer.h>

#include <cstdio>
#include <vector>

int main() {
  const unsigned n = 33;
  std::vector<unsigned> indices;
  for (unsigned j = 0; j + 1 < n; ++j)
    for (unsigned i = 0; i + 1 < n; ++i) {
      const unsigned a = j * n + i;
      indices.insert(indices.end(), {a, a + 1, a + n, a + 1, a + n + 1, a + n});
    }
  std::vector<unsigned char> code(meshopt_encodeIndexBufferBound(indices.size(), n * n));
  code.resize(meshopt_encodeIndexBuffer(code.data(), code.size(), indices.data(), indices.size()));
  std::vector<unsigned> back(indices.size());
  meshopt_decodeIndexBuffer(back.data(), back.size(), sizeof(unsigned), code.data(), code.size());
  int same = 0, turned = 0, other = 0;
  for (std::size_t t = 0; t < indices.size(); t += 3) {
    int turn = 0;
    const auto matches = [&](int corner) { return indices[t + corner] == back[t + (corner + turn) % 3]; };
    while (turn < 3 && !(matches(0) && matches(1) && matches(2))) ++turn;
    ++(turn == 0 ? same : turn < 3 ? turned : other);
  }
  std::printf("%d same, %d turned, %d other\n", same, turned, other);
}
CPP
g++ -O1 -I"$root/usr/include" codec.cpp -o codec -L"$libraries" -lmeshoptimizer
guess "2048 same"
seen "triangles after encoding and decoding" "32 same, 2016 turned, 0 other" "$(run "$work/codec")"
finish

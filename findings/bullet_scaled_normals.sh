#!/usr/bin/env bash
# A ray at a stretched triangle mesh has the right place and the normal of the mesh before it was stretched, in Bullet.
#
# One would guess: btScaledBvhTriangleMeshShape, which shows one mesh at several scales, answers rays as a mesh whose vertices were multiplied does.
# What happens: Bullet 3.24 gives the right place of the hit, and for a slope that is stretched threefold in z the normal (-0.707, 0, 0.707) of the
# mesh that was not. The normal of the mesh with multiplied vertices is (-0.949, 0, 0.316): 27 degrees differ. If the mesh is
# mirrored, the normal leans to the wrong side. The same scale for all axes gives the right one.
# Why a user of a ray tracer meets it: instances of one rock or roof at several sizes are what the shape is for. What is shaded, reflected or put
# on the ground by the normal of such a hit is wrong, and only where the scales of the axes differ.
#
# Needs Debian 12, g++ and the network. Debian 12: libbullet-dev 3.24+dfsg-2. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 libbullet-dev=3.24+dfsg-2
cd "$work"

cat >scaled.cpp <<'CPP'
#include <btBulletCollisionCommon.h>

#include <cstdio>

static const btVector3 corners[3] = {btVector3(0, 0, 0), btVector3(1, 0, 1), btVector3(0, 1, 0)};

// A ray downwards through (x, 0.2).
static void cast(btCollisionShape& shape, float x) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btCollisionWorld world(&dispatcher, &broadphase, &configuration);
  btCollisionObject object;
  object.setCollisionShape(&shape);
  world.addCollisionObject(&object);
  const btVector3 from(x, .2f, 5), to(x, .2f, -5);
  btCollisionWorld::ClosestRayResultCallback hit(from, to);
  world.rayTest(from, to, hit);
  const btVector3 n = hit.m_hitNormalWorld;
  std::printf("z %.3f, normal %.3f %.3f %.3f\n", hit.m_hitPointWorld.z(), n.x(), n.y() + 0, n.z());
  world.removeCollisionObject(&object);
}

static void multiplied(float x, const btVector3& scale) {
  btTriangleMesh triangles;
  triangles.addTriangle(corners[0] * scale, corners[1] * scale, corners[2] * scale);
  btBvhTriangleMeshShape mesh(&triangles, true);
  cast(mesh, x);
}

int main() {
  btTriangleMesh triangles;
  triangles.addTriangle(corners[0], corners[1], corners[2]);
  btBvhTriangleMeshShape mesh(&triangles, true);
  btScaledBvhTriangleMeshShape same(&mesh, btVector3(1, 1, 1)), stretched(&mesh, btVector3(1, 1, 3)), mirrored(&mesh, btVector3(-1, 1, 1)),
    twice(&mesh, btVector3(2, 2, 2));
  cast(same, .2f);
  cast(twice, .4f);
  cast(stretched, .2f);
  multiplied(.2f, btVector3(1, 1, 3));
  cast(mirrored, -.2f);
  multiplied(-.2f, btVector3(-1, 1, 1));
}
CPP
g++ -O1 -I"$root/usr/include/bullet" scaled.cpp -o scaled -L"$libraries" -lBulletCollision -lLinearMath -Wl,-rpath-link,"$libraries"
run "$work/scaled" >out

guess "the same place and normal for a scale and for multiplied vertices"
seen "scale 1" "z 0.200, normal -0.707 0.000 0.707" "$(sed -n 1p out)"
seen "scale 2" "z 0.400, normal -0.707 0.000 0.707" "$(sed -n 2p out)"
seen "scale 3 in z" "z 0.600, normal -0.707 0.000 0.707" "$(sed -n 3p out)"
seen "vertices multiplied by 3 in z" "z 0.600, normal -0.949 0.000 0.316" "$(sed -n 4p out)"
seen "scale -1 in x" "z 0.200, normal -0.707 0.000 0.707" "$(sed -n 5p out)"
seen "vertices multiplied by -1 in x" "z 0.200, normal 0.707 0.000 0.707" "$(sed -n 6p out)"
finish

#!/usr/bin/env bash
# Debian 12's Open3D casts rays that never hit anything.
#
# One would guess: RaycastingScene.cast_rays of a ray at the middle of a triangle says t = 1.
# What happens: with Open3D 0.16.1 and Embree 3.13.5 as Debian 12 ships them every ray misses: t_hit is inf, count_intersections is 0,
# test_occlusions is False, occupancy is 0 inside of a closed box and its signed distance is positive. compute_closest_points is right. No error
# is raised. Debian's Embree is built with ray masks, and Open3D leaves the mask of its rays at 0.
# Why a user of a ray tracer meets it: Open3D is the usual ray caster in Python, and its package is the easy way to get it. Where results are
# compared with it, the other program seems to be wrong.
#
# Needs Debian 12 and its network. Debian 12: python3-open3d 0.16.1+ds-2+b4, libembree3-3 3.13.5+dfsg-2. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 python3-open3d=0.16.1+ds-2+b4 libembree3-3=3.13.5+dfsg-2
cd "$work"

cat >cast.py <<'PYTHON'
import numpy as np
import open3d as o3d

box = o3d.geometry.TriangleMesh.create_box(2, 2, 2)  # from 0 to 2
scene = o3d.t.geometry.RaycastingScene()
scene.add_triangles(o3d.t.geometry.TriangleMesh.from_legacy(box))
ray = np.array([[0.3, 0.7, 3, 0, 0, -1]], np.float32)
middle = np.array([[1, 1.1, 0.9]], np.float32)
print(scene.cast_rays(ray)["t_hit"].numpy()[0])
print(scene.count_intersections(ray).numpy()[0])
print(scene.test_occlusions(ray).numpy()[0])
print(scene.compute_occupancy(middle).numpy()[0])
print("%.3f" % scene.compute_signed_distance(middle).numpy()[0])
print("%.3f" % scene.compute_distance(middle).numpy()[0])
PYTHON
python cast.py >out

guess "1.0, 2, True, 1.0, -0.900, 0.900"
seen "t_hit of a ray at a box" inf "$(sed -n 1p out)"
seen "intersections of the ray" 0 "$(sed -n 2p out)"
seen "is the ray stopped" False "$(sed -n 3p out)"
seen "occupancy in the box" 0.0 "$(sed -n 4p out)"
seen "signed distance in the box" 0.900 "$(sed -n 5p out)"
seen "distance in the box" 0.900 "$(sed -n 6p out)"
finish

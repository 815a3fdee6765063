#!/usr/bin/env bash
# Lamps of Blender hardly fade with distance in Collada files.
#
# One would guess: a point lamp, which in Blender's renderers fades with the square of the distance, gets `quadratic_attenuation` 1 and
# `constant_attenuation` 0, or what amounts to it.
# What happens: Blender 3.4.1 writes a constant attenuation of 1 and a quadratic one of 1/d². The d is `distance` of the lamp's data, which no panel
# shows, and which is 25 for new lamps and 30 for that of the start scene; `falloff_type` of the same lamp says INVERSE_SQUARE. The color is the
# power in watts. Between 1 and 10 units the light falls to 0.86 of what it was, or 0.90, and not to 0.01. Spots are the same. The file also
# has an `extra` of Blender's own that other programs do not know.
# Why a user of a ray tracer meets it: Collada is one of the few formats that carry lamps. The far end of a room is as bright as the wall beside
# the lamp.
#
# Needs Debian 12 and its network. Debian 12: blender 3.4.1+dfsg-2+b1. About two minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >lamps.py <<'PYTHON'
import bpy

# Beside the lamp of the start scene, which is named Light.
for name, kind in ("point", "POINT"), ("near", "POINT"), ("spot", "SPOT"):
    light = bpy.data.lights.new(name, kind)
    light.energy = 1000
    if name == "near":
        light.distance = 1
    bpy.context.collection.objects.link(bpy.data.objects.new(name, light))
assert all(light.falloff_type == "INVERSE_SQUARE" and not light.use_custom_distance for light in bpy.data.lights)
bpy.ops.wm.collada_export(filepath="lamps.dae")
PYTHON
cat >fade.py <<'PYTHON'
import sys
import xml.etree.ElementTree as tree

space = "{http://www.collada.org/2005/11/COLLADASchema}"
for light in tree.parse("lamps.dae").iter(space + "light"):
    if light.get("name").lower() == sys.argv[1]:
        common = light.find(space + "technique_common")[0]
        constant, linear, quadratic = (float(common.find(space + kind + "_attenuation").text) for kind in ("constant", "linear", "quadratic"))
        at_1, at_10 = (1 / (constant + linear * d + quadratic * d * d) for d in (1, 10))
        print("%g %.3f" % (float(common.find(space + "color").text.split()[0]), at_10 / at_1))
PYTHON
unpack bookworm amd64 blender=3.4.1+dfsg-2+b1
paths=$libraries:$root/usr/lib:$libraries/blas:$libraries/lapack:$libraries/pulseaudio
HOME=$work PYTHONHOME=$root/usr BLENDER_SYSTEM_RESOURCES=$root/usr/share/blender BLENDER_SYSTEM_SCRIPTS=$root/usr/share/blender/scripts \
  BLENDER_SYSTEM_DATAFILES=$root/usr/share/blender/datafiles \
  "$root/lib64/ld-linux-x86-64.so.2" --library-path "$paths" "$root/usr/bin/blender" --background -noaudio --factory-startup --python-use-system-env \
  --python lamps.py >log 2>&1
guess "0.010 behind the color each time"
seen "color, and brightness at 10 by that at 1, of the first lamp" "1000 0.901" "$(python fade.py light)"
seen "of a new lamp" "1000 0.863" "$(python fade.py point)"
seen "of one whose distance a script set to 1" "1000 0.020" "$(python fade.py near)"
seen "of a spot" "1000 0.863" "$(python fade.py spot)"
finish

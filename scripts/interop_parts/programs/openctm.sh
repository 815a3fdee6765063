# OpenCTM's converter, which fills concave polygons wrongly.
cd "$OUT"
for from in triangles.obj house.ply house.stl; do
  for to in obj ply stl; do ctmconv "$HOUSE/$from" "from_${from#*.}.$to"; done
done
ctmconv "$HOUSE/house.obj" polygons.obj
for from in obj ply stl; do ctmconv "$BACK/house.$from" "read_$from.ply"; done

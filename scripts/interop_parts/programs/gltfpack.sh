# gltfpack, with floats and with integers. It fills concave polygons wrongly.
pack() { node node_modules/gltfpack/cli.js "$@"; }
for from in house.obj triangles.obj house.glb; do
  name=${from%.*}_${from#*.}
  pack -i "$HOUSE/$from" -o "$OUT/from_$name.glb" -noq -km -kv
  pack -i "$HOUSE/$from" -o "$OUT/integers_from_$name.glb" -vp 16 -vt 16 -vn 16 -vc 16 -km -kv
done
for from in obj glb; do pack -i "$BACK/house.$from" -o "$OUT/read_$from.glb" -noq -km -kv; done

# The Point Cloud Library's converters.
cd "$OUT"
for from in obj ply stl; do
  for to in obj ply stl; do pcl_converter "$HOUSE/house.$from" "from_$from.$to"; done
  pcl_converter -f ascii "$BACK/house.$from" "read_$from.ply"
done
pcl_obj2ply "$HOUSE/house.obj" obj2ply.ply

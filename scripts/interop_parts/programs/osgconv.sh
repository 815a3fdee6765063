# OpenSceneGraph's converter.
for from in obj ply stl; do
  for to in obj stl ply; do (cd "$HOUSE" && osgconv house.$from "$OUT/from_$from.$to"); done
  (cd "$BACK" && osgconv house.$from "$OUT/read_$from.obj")
done

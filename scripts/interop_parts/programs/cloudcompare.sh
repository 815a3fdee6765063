# CloudCompare's command line, which may wait for a window after its work is done.
cd "$OUT"
program=$(command -v CloudCompare || command -v cloudcompare.CloudCompare || echo cloudcompare)
cc() { xvfb-run -a timeout 15 "$program" -SILENT -AUTO_SAVE OFF "$@" >&2; }
for from in house.obj triangles.obj house.ply; do
  for to in OBJ PLY STL; do cc -O "$HOUSE/$from" -M_EXPORT_FMT $to -SAVE_MESHES FILE "$OUT/from_${from%.*}_${from#*.}.${to,,}"; done
done
for from in obj ply stl; do cc -O "$BACK/house.$from" -M_EXPORT_FMT PLY -SAVE_MESHES FILE "$OUT/read_$from.ply"; done

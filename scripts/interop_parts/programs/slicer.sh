# PrusaSlicer; version 2.5 takes triangles alone.
cd "$OUT"
for to in obj stl; do
  for from in triangles.obj house.stl; do prusa-slicer --dont-arrange --export-$to -o "from_${from#*.}.$to" "$HOUSE/$from"; done
done
for from in obj stl; do prusa-slicer --dont-arrange --export-obj -o "read_$from.obj" "$BACK/house.$from"; done

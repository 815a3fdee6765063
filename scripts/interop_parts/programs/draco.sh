# Draco's commands, without rounding.
cd "$OUT"
exact="-qp 0 -qt 0 -qn 0 -qg 0"
for from in triangles.obj house.ply; do
  draco_encoder -i "$HOUSE/$from" -o house.drc $exact
  for to in obj ply stl; do draco_decoder -i house.drc -o "from_${from#*.}.$to"; done
done
for from in obj ply stl; do draco_encoder -i "$BACK/house.$from" -o $from.drc $exact && draco_decoder -i $from.drc -o "read_$from.obj"; done
rm -f ./*.drc

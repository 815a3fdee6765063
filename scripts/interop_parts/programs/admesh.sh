# ADMesh.
cd "$OUT"
admesh --no-check "-b$OUT/house.stl" "$HOUSE/house.stl"
admesh --no-check "-a$OUT/text.stl" "$HOUSE/house.stl"
admesh --no-check "-a$OUT/read_stl.stl" "$BACK/house.stl"

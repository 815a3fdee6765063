# OpenSCAD, by its import.
cd "$OUT"
convert() { echo "import(\"$1\");" >in.scad; openscad -o "$2" in.scad; }
convert "$HOUSE/house.stl" house.stl
for form in stl obj; do convert "$BACK/house.$form" read_$form.stl; done
rm -f in.scad

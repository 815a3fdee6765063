# Assimp's command: it reads the house as OBJ, PLY and GLB, and writes each of its formats.
cd "$OUT"
for from in obj ply glb; do
  for to in obj ply plyb stl stlb gltf2 glb2; do
    case $to in gltf2) name=house.gltf ;; glb2) name=house.glb ;; plyb) name=bytes.ply ;; stlb) name=bytes.stl ;; *) name=house.$to ;; esac
    assimp export "$HOUSE/house.$from" "from_$from.$name" "-f$to" >/dev/null || echo "FAILED $from to $to"
  done
done
for from in obj ply stl glb; do assimp export "$BACK/house.$from" "read_$from.glb" -fglb2 >/dev/null; done

# MeshLab's command line, up to 2020.
cd "$OUT"
export LD_LIBRARY_PATH=$LD_LIBRARY_PATH:/usr/lib/x86_64-linux-gnu/meshlab
server() { xvfb-run -a meshlabserver "$@"; }
server -i "$HOUSE/house.obj" -o house.obj -m vc vn wt fc >&2
server -i "$HOUSE/house.obj" -o house.ply -m vc vn wt >&2
server -i "$HOUSE/house.ply" -o from_ply.ply -m vc vn vt >&2
server -i "$HOUSE/house.ply" -o from_ply.obj -m vc vn vt >&2
server -i "$HOUSE/house.obj" -o house.stl >&2
for from in obj ply stl; do server -i "$BACK/house.$from" -o "read_$from.ply" -m vc vn wt vt >&2; done

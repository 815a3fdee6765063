#!/usr/bin/env bash
# gdaldem turns the aspect of a slope over if the rows of the terrain run from south to north; its hillshade is right.
#
# One would guess: a height field is the same terrain, whether its first row is the northernmost or the southernmost, if the file says
# which; so it has the same slopes, aspects and shades. gdallocationinfo gives the same heights at the same places.
# What happens: gdaldem of GDAL 3.6.2 (Debian 12) and 3.10.3 (Debian 13) gives an aspect of 206.6 degrees, towards the south-west, to rows
# from north to south, and of 333.4, towards the north-west, to rows from south to north, with each of its two formulas, without a warning. Slope and hillshade
# are the same for both.
# Why a user of a ray tracer meets it: height fields of simulations and of point clouds begin in the south. Their sunny slopes become
# shady ones, if light or plants are placed by aspect.
#
# Needs Debian 12 and its network. Debian 12: gdal-bin 3.6.2+dfsg-1+b2. Debian 13: gdal-bin 3.10.3+dfsg-1. About three minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

# A plane of 9 * 9 cells of 10 metres that rises by 1 per metre to the north and by 1/2 per metre to the east: it faces 206.6 degrees.
{
  printf '%s\n' 'ncols 9' 'nrows 9' 'xllcorner 0' 'yllcorner 0' 'cellsize 10'
  for y in 85 75 65 55 45 35 25 15 5; do
    for x in 5 15 25 35 45 55 65 75 85; do printf '%d.%d ' $((y + x / 2)) $((x % 2 * 5)); done
    echo
  done
} >plane.asc
# The same cells, row by row in the other order, with a place that begins in the south and steps of +10 northwards.
{
  echo '<VRTDataset rasterXSize="9" rasterYSize="9"><GeoTransform>0,10,0,0,0,10</GeoTransform><VRTRasterBand dataType="Float32" band="1">'
  for row in 0 1 2 3 4 5 6 7 8; do
    echo "<SimpleSource><SourceFilename relativeToVRT=\"1\">north.tif</SourceFilename><SourceBand>1</SourceBand>" \
      "<SrcRect xOff=\"0\" yOff=\"$((8 - row))\" xSize=\"9\" ySize=\"1\"/><DstRect xOff=\"0\" yOff=\"$row\" xSize=\"9\" ySize=\"1\"/></SimpleSource>"
  done
  echo '</VRTRasterBand></VRTDataset>'
} >south.vrt

# gdal PROGRAM [ARGUMENT...]
gdal() {
  local program=$root/usr/bin/$1
  shift
  PROJ_DATA=$root/usr/share/proj GDAL_DATA=$root/usr/share/gdal "$root/lib64/ld-linux-x86-64.so.2" \
    --library-path "$libraries:$libraries/blas:$libraries/lapack:$root/usr/lib" "$program" "$@"
}
# at FILE: the value in the fourth column and the third row from the south.
at() { printf '%.1f' "$(gdal gdallocationinfo -valonly -geoloc "$1" 35 25)"; }

guess "the same numbers for both orders of rows; an aspect of 206.6"
for release in "bookworm 3.6.2+dfsg-1+b2" "trixie 3.10.3+dfsg-1"; do
  read -r suite version <<<"$release"
  unpack "$suite" amd64 gdal-bin="$version"
  gdal gdal_translate -q -ot Float32 plane.asc north.tif
  gdal gdal_translate -q south.vrt south.tif
  for rows in north south; do
    gdal gdaldem slope -q $rows.tif $rows.slope.tif
    gdal gdaldem hillshade -q $rows.tif $rows.hillshade.tif
    gdal gdaldem aspect -q $rows.tif $rows.aspect.tif
    gdal gdaldem aspect -q -alg ZevenbergenThorne $rows.tif $rows.other.tif
  done
  seen "$version, height by both" "42.5 42.5" "$(at north.tif) $(at south.tif)"
  seen "slope by both" "48.2 48.2" "$(at north.slope.tif) $(at south.slope.tif)"
  seen "hillshade by both" "78.0 78.0" "$(at north.hillshade.tif) $(at south.hillshade.tif)"
  seen "aspect by both" "206.6 333.4" "$(at north.aspect.tif) $(at south.aspect.tif)"
  seen "aspect by both, by the other formula" "206.6 333.4" "$(at north.other.tif) $(at south.other.tif)"
done
finish

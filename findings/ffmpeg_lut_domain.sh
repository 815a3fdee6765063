#!/usr/bin/env bash
# FFmpeg moves colours by a lookup table that changes nothing, if the table is for other colours than 0 to 1.
#
# One would guess: a .cube file with DOMAIN_MIN -1 and DOMAIN_MAX 1, or 0 and 0.5, whose entries are the colours themselves, leaves each colour of
# its domain as it is. OpenColorIO 2.1.2 does that.
# What happens: filter lut3d of FFmpeg 5.1.9 (Debian 12) and 7.1.5 (Debian 13) makes 0.1 of it -0.9 with the first file and 0.05 with the second,
# without a warning.
# A domain of 0 to 4 is kept. (The least of a domain is not subtracted, and a scale of more than 1 is cut to 1.)
# Why a user of a ray tracer meets it: tables for tone mapping and film colours are made for radiances or logarithms of them, so for
# domains of their own. Frames in floats become a dark or black film.
#
# Needs Debian 12 and its network. Debian 12: ffmpeg 7:5.1.9-0+deb12u1, opencolorio-tools 2.1.2+dfsg1-4+b3. Debian 13: ffmpeg 7:7.1.5-0+deb13u1.
# About three minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 ffmpeg=7:5.1.9-0+deb12u1 opencolorio-tools=2.1.2+dfsg1-4+b3
cd "$work"

# table LEAST GREATEST: a table of 5 * 5 * 5 colours, each of which stays as it is.
table() {
  printf 'LUT_3D_SIZE 5\nDOMAIN_MIN %s %s %s\nDOMAIN_MAX %s %s %s\n' "$1" "$1" "$1" "$2" "$2" "$2"
  awk -v least="$1" -v greatest="$2" 'BEGIN { step = (greatest - least) / 4
    for (b = 0; b < 5; ++b) for (g = 0; g < 5; ++g) for (r = 0; r < 5; ++r)
      printf "%.6f %.6f %.6f\n", least + r * step, least + g * step, least + b * step }'
}
table 0 1 >unit.cube
table 0 4 >wide.cube
table -1 1 >signed.cube
table 0 0.5 >half.cube
# Two grey pixels in floats, 0.1 and 0.4, little-endian.
{
  printf 'PF\n2 1\n-1.0\n'
  tenth='\315\314\314\75' two_fifths='\315\314\314\76'
  printf "$tenth$tenth$tenth$two_fifths$two_fifths$two_fifths"
} >grey.pfm

# ffmpeg_gives TABLE, ocio_gives TABLE: red of the two pixels after this table.
ffmpeg_gives() {
  rm -f out.pfm
  "$root/lib64/ld-linux-x86-64.so.2" --library-path "$libraries:$libraries/blas:$libraries/lapack:$libraries/pulseaudio" \
    "$root/usr/bin/ffmpeg" -v error -y -i grey.pfm -vf "format=gbrpf32le,lut3d=$1.cube:interp=trilinear" out.pfm 2>log || cat log >&2
  tail -c 24 out.pfm | od -An -v -t f4 -w12 | awk '{ printf "%.3f\n", $1 }' | paste -sd' '
}
ocio_gives() {
  local grey
  for grey in 0.1 0.4; do run "$root/usr/bin/ociochecklut" $1.cube $grey $grey $grey | tail -n 1 | awk '{ printf "%.3f\n", $1 }'; done | paste -sd' '
}

guess "0.100 0.400 after each table"
for name in unit wide signed half; do seen "OpenColorIO, $name" "0.100 0.400" "$(ocio_gives $name)"; done
for release in "bookworm 7:5.1.9-0+deb12u1" "trixie 7:7.1.5-0+deb13u1"; do
  read -r suite version <<<"$release"
  if [ "$suite" = trixie ]; then unpack trixie amd64 ffmpeg="$version"; fi
  seen "FFmpeg ${version#*:}, 0 to 1" "0.100 0.400" "$(ffmpeg_gives unit)"
  seen "0 to 4" "0.100 0.400" "$(ffmpeg_gives wide)"
  seen "-1 to 1" "-0.900 -0.600" "$(ffmpeg_gives signed)"
  seen "0 to 0.5" "0.050 0.200" "$(ffmpeg_gives half)"
done
finish

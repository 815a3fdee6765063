#!/usr/bin/env bash
# maketx spreads what stands at the edges of an environment picture, if it writes EXR.
#
# One would guess: the first level of a texture holds the picture itself, whatever the format.
# What happens: `maketx --envlatl` of OpenImageIO 2.4.7 (Debian 12) and 2.5.18 (Debian 13) puts the mean of the first and the last column in
# both and the mean of the first row in all of it, where it writes EXR; it sets oiio:sampleborder, by which pixels at the
# edges lie on the seam and at the poles, and shifts no other pixel to its new place. In TIFF all pixels are the same. The manual page and
# --help do not tell.
# Why a user of a ray tracer meets it: a sun of 1000 in the first column becomes two of 500, and programs that take pixels for squares show
# one at either end.
#
# Needs Debian 12 and its network. Debian 12: openimageio-tools 2.4.7.1+dfsg-2. Debian 13: openimageio-tools 2.5.18.0+dfsg-1+b1. About two minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

# tool NAME [ARGUMENT...]: a program of OpenImageIO.
tool() { run --library-path "$libraries:$libraries/blas:$libraries/lapack:$root/usr/lib" "$root/usr/bin/$1" "${@:2}"; }
# lit FILE: the pixels that are not 0.
lit() { tool oiiotool --dumpdata "$1" | awk '$1 == "Pixel" && $4 > 0 { printf "%s%s %s %g", comma, $2, $3, $4; comma = ", " }'; }
# edges SUITE VERSION: a sun in the first column with a lamp beside it, and one in the first row, before and after.
edges() {
  unpack "$1" amd64 openimageio-tools="$2"
  tool oiiotool --create 8x4 1 --box:color=1000:fill=1 0,2,0,2 --box:color=7:fill=1 1,1,1,1 -d float -o column.exr
  tool oiiotool --create 8x4 1 --box:color=1000:fill=1 3,0,3,0 -d float -o row.exr
  for format in exr tif; do
    for sun in column row; do tool maketx --envlatl --nomipmap -d float $sun.exr -o "$sun.tx.$format" >log; done
  done
  seen "lit pixels of $1's picture" "(1, 1): 7, (0, 2): 1000" "$(lit column.exr)"
  seen "as TIFF" "(1, 1): 7, (0, 2): 1000" "$(lit column.tx.tif)"
  seen "as EXR" "(1, 1): 7, (0, 2): 500, (7, 2): 500" "$(lit column.tx.exr)"
  seen "oiio:sampleborder of EXR" "1" "$(tool oiiotool --info -v column.tx.exr | sed -n 's/.*oiio:sampleborder: //p')"
  seen "of a picture with a sun in the first row, as TIFF" "(3, 0): 1000" "$(lit row.tx.tif)"
  seen "as EXR" "$(for i in 0 1 2 3 4 5 6 7; do printf '(%d, 0): 125\n' $i; done | paste -sd, | sed 's/,(/, (/g')" "$(lit row.tx.exr)"
}

guess "(1, 1): 7, (0, 2): 1000, and in the other picture (3, 0): 1000, in both formats"
edges bookworm 2.4.7.1+dfsg-2
edges trixie 2.5.18.0+dfsg-1+b1
finish

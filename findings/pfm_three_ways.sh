#!/usr/bin/env bash
# One valid PFM file is a picture twice as bright, half as bright, or upside down.
#
# One would guess: programs agree about a format of three lines of text, after which rows of floats follow from the lowest to the uppermost. The
# third number is negative for little-endian floats, and its absolute value is a scale.
# What happens: of a file with -2.0 in the third line OpenImageIO 2.4.7 and 2.5.18 multiply the floats by 2. OpenCV 4.6.0, netpbm's pfmtopam
# 11.1.0 and FFmpeg divide them by 2. FFmpeg 5.1.9 takes the first row for the uppermost, besides, whatever the scale, and writes PFM in
# that order, too, so that it understands itself; 7.1.5 has the rows right.
# Why a user of a ray tracer meets it: renderers and denoisers exchange pictures as PFM. A film made of them stands on its head, and depths
# whose scale is not 1, as the 1/255 of stereo data, are wrong by the square of it.
#
# Needs Debian 12 and its network. Debian 12: ffmpeg 7:5.1.9-0+deb12u1, netpbm 2:11.01.00-2, openimageio-tools 2.4.7.1+dfsg-2, python3-opencv
# 4.6.0+dfsg-12. Debian 13: ffmpeg 7:7.1.5-0+deb13u1, openimageio-tools 2.5.18.0+dfsg-1+b1. About nine minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >write.py <<'PYTHON'
import struct

# One pixel above another. The lowest row comes first.
for scale in "-1.0", "-2.0":
    open("scale%s.pfm" % scale, "wb").write(b"Pf\n1 2\n%s\n" % scale.encode() + struct.pack("<2f", 0.2, 0.4))
PYTHON
tool() { run --library-path "$libraries:$libraries/blas:$libraries/lapack:$libraries/pulseaudio:$root/usr/lib" "$root/usr/bin/$1" "${@:2}"; }
# Each prints the upper and the lower pixel.
with_oiio() { tool oiiotool --dumpdata "$1" | awk '$1 == "Pixel" { print $4 }' | two; }
with_opencv() { python -c 'import sys, cv2; print(*cv2.imread(sys.argv[1], -1).ravel())' "$1" | two; }
with_netpbm() { tool pfmtopam "$1" | tail -c 2 | od -An -tu1 | awk '{ print $1 / 255, $2 / 255 }' | two; }
with_ffmpeg() { tool ffmpeg -v error -i "$1" -f rawvideo -pix_fmt grayf32le - </dev/null | od -An -tf4 | two; }
two() { xargs printf '%.1f %.1f'; }

guess "0.4 0.2 for scale -1, and with any program the same for scale -2"
unpack bookworm amd64 ffmpeg=7:5.1.9-0+deb12u1 netpbm=2:11.01.00-2 openimageio-tools=2.4.7.1+dfsg-2 python3-opencv=4.6.0+dfsg-12
python write.py
seen "scale -1, OpenImageIO 2.4.7" "0.4 0.2" "$(with_oiio scale-1.0.pfm)"
seen "scale -1, OpenCV 4.6.0" "0.4 0.2" "$(with_opencv scale-1.0.pfm)"
seen "scale -1, netpbm 11.1.0" "0.4 0.2" "$(with_netpbm scale-1.0.pfm)"
seen "scale -1, FFmpeg 5.1.9" "0.2 0.4" "$(with_ffmpeg scale-1.0.pfm)"
seen "scale -2, OpenImageIO 2.4.7" "0.8 0.4" "$(with_oiio scale-2.0.pfm)"
seen "scale -2, OpenCV 4.6.0" "0.2 0.1" "$(with_opencv scale-2.0.pfm)"
seen "scale -2, netpbm 11.1.0" "0.2 0.1" "$(with_netpbm scale-2.0.pfm)"
seen "scale -2, FFmpeg 5.1.9" "0.1 0.2" "$(with_ffmpeg scale-2.0.pfm)"
python -c 'import cv2, numpy; cv2.imwrite("picture.png", numpy.array([[255], [0]], numpy.uint8))'
tool ffmpeg -v error -i picture.png -pix_fmt grayf32le written.pfm </dev/null
seen "PFM that FFmpeg 5.1.9 writes of white above black, OpenCV 4.6.0" "0.0 1.0" "$(with_opencv written.pfm)"
unpack trixie amd64 ffmpeg=7:7.1.5-0+deb13u1 openimageio-tools=2.5.18.0+dfsg-1+b1
seen "scale -1, OpenImageIO 2.5.18" "0.4 0.2" "$(with_oiio scale-1.0.pfm)"
seen "scale -1, FFmpeg 7.1.5" "0.4 0.2" "$(with_ffmpeg scale-1.0.pfm)"
seen "scale -2, OpenImageIO 2.5.18" "0.8 0.4" "$(with_oiio scale-2.0.pfm)"
seen "scale -2, FFmpeg 7.1.5" "0.2 0.1" "$(with_ffmpeg scale-2.0.pfm)"
finish

#!/usr/bin/env bash
# POV-Ray's pattern `ripples` uses `frequency` and `phase` twice: inside the sines, and again for their mean.
#
# One would guess: as for all other patterns, `phase 0.25` adds 0.25 to the value, or shifts the waves by a quarter; and half a
# frequency makes the waves twice as long.
# What happens: POV-Ray 3.7.0.10 shifts the sines by the phase, takes the mean, and then multiplies it by the frequency and adds the
# phase once more, as for any pattern. At the origin, where the sines agree, the value 0.5 becomes (almost) 0.25 with phase 0.25,
# for the sine has reached its top, 1, and 1 + 0.25 begins anew. Values of `ripples` with frequency 0.25 do not exceed 0.25.
# Why a user of a ray tracer meets it: water that is made coarser by `frequency` becomes flat, too; a renderer that reads such scenes
# must do the same to show the same waves.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#declare F = function { pattern { ripples } }
#declare G = function { pattern { ripples phase 0.25 } }
#declare H = function { pattern { ripples frequency 0.25 } }
#declare Most = 0;
#for (i, 0, 999)
  #declare Most = max(Most, H(i * 0.0137, i * 0.0731, i * 0.0519));
#end
#debug concat("RESULT ", str(F(0, 0, 0), 0, 3), " ", str(G(0, 0, 0), 0, 3), " ", str(Most, 0, 3), "\n")
POV
))
guess "0.5, then 0.75 or 1, and waves that reach 1 with any frequency"
seen "ripples at the origin" 0.500 "${result[0]}"
seen "with phase 0.25" 0.250 "${result[1]}"
seen "greatest of 1000 values with frequency 0.25" 0.250 "${result[2]}"
finish

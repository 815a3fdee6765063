# Open CASCADE's DRAW.
pload ALL
foreach {form command} {obj ReadObj glb ReadGltf stl ReadStl ply ReadPly} {
  foreach {place folder} [list write $env(HOUSE) read $env(BACK)] {
    catch {Close * }
    if {[catch {$command D $folder/house.$form} message]} { puts "FAILED $command $message" ; continue }
    if {$place == "write"} {
      foreach {to writer} {obj WriteObj glb WriteGltf gltf WriteGltf ply WritePly} { if {[catch {$writer D $env(OUT)/from_$form.$to} message]} { puts "FAILED $writer $message" } }
    } else {
      if {[catch {WriteGltf D $env(OUT)/read_$form.glb} message]} { puts "FAILED $message" }
    }
  }
}
exit

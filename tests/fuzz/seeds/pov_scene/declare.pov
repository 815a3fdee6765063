#version 3.7;
#declare A = array[2][2] {{1, 2}, {3, 4}}
#local V = <1, 2, 3> * A[1][0] + x;
#declare C = color rgb <.1, .2, .3> * 2 filter .5;
#declare S = "text";
#declare O = sphere { V, 1.5e-1 pigment { C } }
#undef S
#ifdef (O) object { O translate -V.y } #else box { 0, 1 } #end
#declare A[0][0] = V;
camera { location <0, 0, -5> look_at 0 }

#debug concat(str(val("1.5"), 8, 2), chr(65), substr("hello", 2, 3), strupr("a"), vstr(3, x + y, ", ", 0, 1), datetime(0))
text { ttf "a\\b\u0041.ttf" strlwr("ABC") 1, 0 }
#if (strcmp("a", "b") < 0 & strlen("abc") = 3) box { min_extent(sphere { 0, 1 }), max_extent(sphere { 0, 1 }) } #end
#declare O = sphere { 0, 1 } #declare N = x; #declare Q = trace(O, -5 * z, z, N); #if (inside(O, 0)) #end
mesh2 { vertex_vectors { 3, <0, 0, 0>, <1, 0, 0>, <0, 1, 0> } face_indices { 1, <0, 1, 2> } }
/* a /* nested */ comment */ // and another
quartic { < 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 > sturm }

#declare F = function(x, y) { sin(x) * y - -2 / max(x, y, 1) + (x < y | x = 1 & y >= 2) }
#declare G = function { F(x, y) + sum(i, 1, 3, i * z) + select(x, 1, 2, 3) }
#declare P = function { pigment { gradient x color_map { [0 rgb 0] [1 rgb 1] } } }
#declare T = function { transform { rotate 30 * y scale 2 matrix <1,0,0, 0,1,0, 0,0,1, 1,2,3> inverse } }
#declare I = function { internal(3) }
#declare H = function { P(x, y, z).gray + T(x, y, z).y + I(x, 1) }
#declare S = spline { natural_spline 0, <0, 1> 1, <2, 3> 2, <1, 1> }
#declare R = seed(1);
isosurface { function { H(x, y, z) - G(x, y, z) } max_gradient F(1, 2) + rand(R) }
sphere { S(.5), vlength(T(1, 2, 3)) + S(.3, cubic_spline).x }

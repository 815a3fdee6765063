#macro M(a) #if (a > 0) M(a - 1) #else 3 #end #end
#switch (M(2)) #case (#if (1) 3 #end) #declare A = array[2][2] { {1, 2} {3, 4} } #break #else #end
#while (defined(A[#undef A 0][1])) #break #end
#if (#ifdef (B) 1 #else 0 #end) #elseif (M(1) = 3) #declare B = A; #end
#declare T = transform { translate x } #declare T = transform { transform T transform T inverse }
#declare F = function { transform { T } } #declare S = spline { natural_spline 0, x, 1, y, 2, z }
#declare G = function(q) { sum(i, 1, 3, i * F(q, q, 0).x) + S(q).y }
#declare X = G(2); #declare P = F(1, 2, 3) + S(.5, cubic_spline);

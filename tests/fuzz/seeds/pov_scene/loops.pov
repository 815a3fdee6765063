#macro M(P, Q) #local T = P; #declare P = Q; #if (Q > 0) M(P, Q - 1) #end #end
#declare N = 1; M(N, 5)
#declare I = 0; #while (I < 3) #declare I = I + 1; #if (I = 2) #break #end sphere { I, .5 } #end
#for (K, 0, 1, .5) #switch (K) #case (0) #debug str(K, 4, 2) #break #range (.4, .6) #else #warning "x" #end #end
#default { finish { ambient .1 } texture { pigment { rgb 1 } } }

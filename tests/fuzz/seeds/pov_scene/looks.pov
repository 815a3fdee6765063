#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 7 }
camera { panoramic location -5*z look_at 0 angle 120 }
sky_sphere { pigment { gradient y color_map { [0 rgb 1] [1 rgb z] } turbulence 0.3 } pigment { wrinkles color_map { [0 rgbt 1] [1 rgb 1] } } }
#declare T = texture { pigment { granite color_map { [0.2 rgb x] [0 rgb 1] [1 rgbf 1] } warp { repeat x flip y } rotate 30 } normal { bumps 0.3 scale 0.5 } finish { phong 1 reflection { 0.1, 0.5 metallic } } }
sphere { 0, 1 texture { T scale 2 } translate x }
box { -1, 1 texture { gradient x texture_map { [0.3 T] [0.7 pigment { brick rgb 1, rgb 0 mortar 0.1 } finish { diffuse 1 }] } } }
torus { 2, 0.5 texture { pigment { checker pigment { radial frequency 3 }, rgb y } } texture { pigment { rgbt <1, 0, 0, 0.5> } normal { wrinkles slope_map { [0 <0, 1>] [1 <1, 0>] } } } }
julia_fractal { <-0.1, 0.8, 0, 0> hypercomplex cube max_iteration 5 slice <0, 0, 0, 1>, 0.1 pigment { average pigment_map { [1 spiral1 3] [2 julia <0.3, 0.5>, 10 exponent 3 interior 1, 2] } } interior { ior 1.5 } }
intersection { sphere { 0, 2 } plane { y, 0 } pigment { function { x + sin(y) } poly_wave 2 } clipped_by { box { -1, 1 } } }
cubic { <0,0,0,1, 0,0,0,0, 1,0,0,0, 0,0,0,0, 0,0,0,-1> scale 2 bounded_by { sphere { 0, 3 } box { -2, 2 } } translate x pigment { rgb 1 } }
prism { cubic_spline 0, 1, 7, <0.3,0.3>, <0,0>, <0.5,0>, <0.5,0.5>, <0,0.5>, <0,0>, <0.5,0> pigment { crackle form <1, 0, 0> metric 1 offset 0.1 solid } }
light_source { <3, 5, -4>, rgb 1 spotlight radius 10 falloff 20 tightness 3 point_at 0 area_light x, z, 3, 3 fade_distance 5 fade_power 2 }
light_source { 5*y, 1 cylinder radius 1 falloff 2 point_at 0 shadowless }

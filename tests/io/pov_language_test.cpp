#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/pov/read_pov.h"
#include "tests/support/temp_dir.h"

namespace oktett::test::pov_language_test {
namespace {

using pov::Block;
using pov::Document;
using pov::Element;
using pov::Numbers;
using pov::ReadOptions;
using Cases = std::vector<std::pair<std::string, std::string>>;

/// Answers for the unit sphere, whatever the object.
class UnitSphere final : public pov::ObjectQueries {
 public:
  std::optional<bool> inside(const BlockPointer&, const Point& p) override {
    return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] < 1;
  }
  std::optional<Hit> trace(const BlockPointer&, const Point&, const Point&) override {
    return Hit{true, {0, 0, -1}, {0, 0, -1}};
  }
  std::optional<std::pair<Point, Point>> extent(const BlockPointer&) override {
    return {{{-1, -1, -1}, {1, 1, 1}}};
  }
  std::optional<std::array<double, 5>> pigment(const BlockPointer&, const Point& p) override {
    return {{p[0], p[0], p[0], 0, 0}};
  }
  std::optional<double> pattern(const BlockPointer&, const Point& p) override { return p[0]; }
  std::optional<double> internal(std::uint32_t number, std::span<const double> a) override {
    return number + a[0];
  }
};

struct Result {
  Document document;
  std::string debug;
};

Result read(const std::string& text, ReadOptions options = {}) {
  const TempDir dir;
  Result result;
  options.said = [&result](const std::string& said) { result.debug += said; };
  result.document = pov::read_pov(dir.write("a.pov", text), options);
  return result;
}

std::string debug_of(const std::string& text, const ReadOptions& options = {}) {
  return read(text, options).debug;
}

/// What is wrong with a scene, without its folder.
std::string error_of(const std::string& text, const ReadOptions& options = {}) {
  const TempDir dir;
  const std::string path = dir.write("a.pov", text);
  try {
    pov::read_pov(path, options);
  } catch (const Error& error) {
    std::string message = error.what();
    const std::string folder = dir.path().string() + "/";
    for (std::size_t at; (at = message.find(folder)) != std::string::npos;) message.erase(at, folder.size());
    return message;
  }
  return "no error";
}

const Block& block_at(const std::vector<Element>& elements, std::size_t index) {
  return *std::get<std::shared_ptr<const Block>>(elements.at(index).value);
}
const Numbers& numbers_at(const Block& block, std::size_t index) {
  return std::get<Numbers>(block.elements.at(index).value);
}
std::string_view word_at(const Block& block, std::size_t index) {
  return std::get<pov::Word>(block.elements.at(index).value).text;
}

const std::string kStart =
    "#version 3.7; #declare V = <1,2,3>; #declare F = 5; #declare C = color rgb <.1,.2,.3>;\n";

// What POV-Ray 3.7.0.10 prints for each of these.
TEST(PovLanguage, SaysWhatPovRaySays) {
  const Cases cases{
      {R"(#debug str(1+2*3,0,4))", R"(7.0000)"},
      {R"(#declare X = (F < 6); #debug str(X,0,3))", R"(1.000)"},
      {R"(#debug str(sin(F<6),0,3))", R"(0.841)"},
      {R"(#debug str((2*3=6 & 1),0,3))", R"(1.000)"},
      {R"(#debug vstr(3,<1,2>*<1,2,3>,",",0,3))", R"(1.000,4.000,0.000)"},
      {R"(#debug vstr(5,C,",",0,3))", R"(0.100,0.200,0.300,0.000,0.000)"},
      {R"(#debug vstr(5,C*2,",",0,3))", R"(0.200,0.400,0.600,0.000,0.000)"},
      {R"(#debug vstr(5,C+1,",",0,3))", R"(1.100,1.200,1.300,1.000,1.000)"},
      {R"(#debug vstr(5,2*C+<1,1,1>,",",0,3))", R"(1.200,1.400,1.600,0.000,0.000)"},
      {R"(#debug str((<1,2,3>).x,0,3))", R"(1.000)"},
      {R"(#debug str(<1,2,3>.y,0,3))", R"(2.000)"},
      {R"(#debug str(vnormalize(V).y,0,3))", R"(0.535)"},
      {R"(#debug str((V+V).y,0,3))", R"(4.000)"},
      {R"(#debug str(C.red,0,3))", R"(0.100)"},
      {R"(#debug str(C.gray,0,5))", R"(0.18170)"},
      {R"(#debug str(V.gray,0,5))", R"(1.81700)"},
      {R"(#debug str(V.red,0,5))", R"(1.00000)"},
      {R"(#debug str(V.u,0,5))", R"(1.00000)"},
      {R"(#declare A = array[3]{1,2,3}; #macro M(q) #declare q = 9; #end M(A[1]) #debug str(A[1],0,3))",
       R"(9.000)"},
      {R"(#macro B() #debug str(loc,0,3) #end #macro A() #local loc=7; B() #end A())", R"(7.000)"},
      {R"(#local X=3; #macro A() #declare X=4; #end A() #debug str(X,0,3))", R"(4.000)"},
      {R"(#macro A() #local X=1; #declare X=4; #debug str(X,0,3) #end A() #ifdef(X) #debug " global" #else #debug " none" #end)",
       R"(4.000 none)"},
      {R"(#macro A() #local X=1; B() #debug str(X,0,3) #end #macro B() #declare X=4; #end A() #ifdef(X) #debug " global" #else #debug " none" #end)",
       R"(4.000 none)"},
      {R"(#macro A(p) #local p=p+1; #debug str(p,0,3) #end #declare G=1; A(G) #debug str(G,0,3))",
       R"(2.0002.000)"},
      {R"(#macro A(p) #declare p=p+1; #debug str(p,0,3) #end #declare G=1; A(G) #debug str(G,0,3))",
       R"(2.0002.000)"},
      {R"(#macro A(p) #declare p=p+1; #debug str(p,0,3) #end #declare G=1; A(G+0) #debug str(G,0,3))",
       R"(2.0001.000)"},
      {R"(#declare A = array[2]{1,2}; #declare B = A; #declare B[0]=7; #debug str(A[0],0,3))", R"(1.000)"},
      {R"(#declare A = array[2]; #declare A[0]=array[2]{3,4}; #debug str(A[0][1],0,3))", R"(4.000)"},
      {R"(#for(i,0,1,0.1) #debug concat(str(i,0,2)," ") #end #debug str(i,0,3))",
       R"(0.00 0.10 0.20 0.30 0.40 0.50 0.60 0.70 0.80 0.90 1.00 1.100)"},
      {R"(#for(i,3,1,-1) #debug concat(str(i,0,2)," ") #end)", R"(3.00 2.00 1.00 )"},
      {R"(#for(i,3,1) #debug concat(str(i,0,2)," ") #end)", R"()"},
      {R"(#declare X=color red 1 green 0.5+0.2 blue .25*2; #debug vstr(5,X,",",0,3))",
       R"(1.000,0.700,0.500,0.000,0.000)"},
      {R"(#declare X=color rgb 1+0.5; #debug vstr(5,X,",",0,3))", R"(1.500,1.500,1.500,0.000,0.000)"},
      {R"(#declare X=rgb <1,2,3>*2 filter 0.3; #debug vstr(5,X,",",0,3))",
       R"(2.000,4.000,6.000,0.300,0.000)"},
      {R"(#declare X=color C*2 + C filter .5; #debug vstr(5,X,",",0,3))", R"(0.300,0.600,0.900,0.500,0.000)"},
      {R"(#declare X=color C + x; #debug vstr(5,X,",",0,3))", R"(1.100,0.200,0.300,0.000,0.000)"},
      {R"(#declare X=color rgb <.1,.2,.3>*2 + C; #debug vstr(5,X,",",0,3))",
       R"(0.300,0.600,0.900,0.000,0.000)"},
      {R"(#declare X=color rgbft .5; #debug vstr(5,X,",",0,3))", R"(0.500,0.500,0.500,0.500,0.500)"},
      {R"(#declare X=color rgbf <.1,.2,.3>; #debug vstr(5,X,",",0,3))", R"(0.100,0.200,0.300,0.000,0.000)"},
      {R"(#declare X=color rgbt <.1,.2,.3,.4>*2; #debug vstr(5,X,",",0,3))",
       R"(0.200,0.400,0.600,0.000,0.800)"},
      {R"(#declare X=color rgb <.1,.2,.3,.4,.5>; #debug vstr(5,X,",",0,3))",
       R"(0.100,0.200,0.300,0.400,0.500)"},
      {R"(#declare X=color <.1,.2,.3,.4>; #debug vstr(5,X,",",0,3))", R"(0.100,0.200,0.300,0.400,0.000)"},
      {R"(#declare X=color .5; #debug vstr(5,X,",",0,3))", R"(0.500,0.500,0.500,0.500,0.500)"},
      {R"(#declare X=2*C; #debug vstr(5,X,",",0,3) #debug str(X.transmit,0,3))",
       R"(0.200,0.400,0.600,0.000,0.0000.000)"},
      {R"(#declare X=-C; #debug vstr(5,X,",",0,3))", R"(-0.100,-0.200,-0.300,-0.000,-0.000)"},
      {R"(#declare X=(C+C)*2; #debug vstr(5,X,",",0,3))", R"(0.400,0.800,1.200,0.000,0.000)"},
      {R"(#declare X=<1,2,3>+C; #debug vstr(5,X,",",0,3))", R"(1.100,2.200,3.300,0.000,0.000)"},
      {R"(#declare X=<1,2,3,4>; #debug vstr(4,X,",",0,3) #debug str(X.t,0,2))",
       R"(1.000,2.000,3.000,4.0004.00)"},
      {R"(#declare X=<1,2,3,4,5>; #debug str(X.t,0,2) #debug str(X.filter,0,2)#debug str(X.transmit,0,2))",
       R"(4.004.005.00)"},
      {R"(#declare X=<1,2>+1; #debug vstr(2,X,",",0,3))", R"(2.000,3.000)"},
      {R"(#debug vstr(3,5,",",0,3))", R"(5.000,0.000,0.000)"},
      {R"(#debug str((1=1+1e-11),0,3) #debug str((1=1+1e-9),0,3))", R"(1.0000.000)"},
      {R"(#debug str((2 > 1 > 0),0,3))", R"(1.000)"},
      {R"(#debug str((1 | 0 & 0),0,3))", R"(0.000)"},
      {R"(#debug str((2 & 1 = 1),0,3))", R"(1.000)"},
      {R"(#debug str((!2 + 1),0,3) #debug str(!0,0,3))", R"(1.0001.000)"},
      {R"(#debug str((1 ? 2 : 3 ? 4 : 5),0,3))", R"(2.000)"},
      {R"(#debug str((0 ? 2 : 0 ? 4 : 5),0,3))", R"(5.000)"},
      {R"(#debug str((1+1 = 2 ? 7 : 8),0,3))", R"(7.000)"},
      {R"(#debug str((1 < 2 ? V : 8).y,0,3))", R"(2.000)"},
      {R"(#debug str(-2*-3,0,3) #debug str(2--3,0,3) #debug str(2*-3,0,3) #debug str(2/-4,0,3) #debug str(2-+3,0,3))",
       R"(6.0005.000-6.000-0.500-1.000)"},
      {R"(#debug str(1/0,0,3))", R"(inf)"},
      {R"(#debug str(10/4/2,0,3) #debug str(10-4-2,0,3))", R"(1.2504.000)"},
      {R"(#debug str(mod(-5,3),0,3) #debug str(mod(5,-3),0,3) #debug str(mod(5.5,2),0,3))",
       R"(-2.0002.0001.500)"},
      {R"(#debug str(div(-5,3),0,3) #debug str(div(5.9,2),0,3) #debug str(int(-1.5),0,3) #debug str(floor(-1.5),0,3) #debug str(ceil(-1.5),0,3))",
       R"(-1.0002.000-1.000-2.000-1.000)"},
      {R"(#debug str(select(-1,1,2,3),0,3) #debug str(select(0,1,2,3),0,3)#debug str(select(1,1,2,3),0,3)#debug str(select(-1,1,2),0,3)#debug str(select(0,1,2),0,3))",
       R"(1.0002.0003.0001.0002.000)"},
      {R"(#debug str(bitwise_and(6,3),0,3) #debug str(bitwise_or(6,3),0,3)#debug str(bitwise_xor(6,3),0,3) #debug str(bitwise_or(1,2,4),0,3))",
       R"(2.0007.0005.0007.000)"},
      {R"(#debug str(bitwise_and(6.9,-1),0,3) #debug str(max(1,2,7,3),0,3)#debug str(min(4,2,7),0,3))",
       R"(6.0007.0002.000)"},
      {R"(#debug str(pow(2,-1),0,3) #debug str(pow(-2,3),0,3) #debug str(exp(1),0,5)#debug str(log(100),0,5)#debug str(ln(2),0,5))",
       R"(0.500-8.0002.718282.000000.69315)"},
      {R"(#debug str(pow(-2,.5),0,3))", R"(-nan)"},
      {R"(#debug str(degrees(pi),0,5) #debug str(radians(180),0,5) #debug str(atan2(1,-1),0,5) #debug str(asc("A"),0,1))",
       R"(180.000003.141592.3561965.0)"},
      {R"(#debug str(acos(2),0,3))", R"(0.000)"},
      {R"(#debug str(3.14159,10,3) #debug "|" #debug str(3.14159,-10,3) #debug "|" #debug str(3.14159,0,-1) #debug "|" #debug str(1e10,0,-1) #debug str(2.5,0,0))",
       R"(     3.142|000003.142|3.141590|10000000000.0000002)"},
      {R"(#debug concat("a","b",str(1,0,0)) #debug substr("hello",2,3) #debug strupr("abC1") #debug strlwr("AbC"))",
       R"(ab1ellABC1abc)"},
      {R"(#debug substr("hello",0,2))", R"()"},
      {R"(#debug str(strcmp("a","b"),0,2) #debug str(strcmp("b","a"),0,2) #debug str(strcmp("a","a"),0,2) #debug str(strcmp("a","c"),0,2))",
       R"(-1.001.000.00-2.00)"},
      {R"(#debug str(val("1.5"),0,3) #debug str(val("1.5abc"),0,3) #debug str(val("abc"),0,3) #debug str(val(" -2e1"),0,3))",
       R"(1.5001.5000.000-20.000)"},
      {R"(#debug chr(65) #debug str(strlen("abc"),0,1) #debug "\u0041" #debug "a\\b" #debug "q\"q")",
       R"(A3.0Aa\bq"q)"},
      {R"(#debug str(asc(""),0,1))", R"(0.0)"},
      {R"(#debug vstr(3,vrotate(<1,2,3>,<10,20,30>),",",0,6) #debug vstr(3,vaxis_rotate(<1,2,3>,<1,1,0>,30),",",0,6))",
       R"(1.067425,2.289059,2.7605812.127647,0.872353,2.951630)"},
      {R"(#debug vstr(3,vnormalize(<0,0,0>),",",0,6))", R"(0.000000,0.000000,0.000000)"},
      {R"(#debug vstr(3,vcross(<1,2,3>,<4,5,7>),",",0,6) #debug str(vdot(<1,2,3>,<4,5,7>),0,6) #debug str(vlength(<1,2,3>),0,6))",
       R"(-1.000000,5.000000,-3.00000035.0000003.741657)"},
      {R"(#declare A = array[2][3] {{1,2,3},{4,5,6}}; #debug str(A[1][2],0,1) #debug str(dimensions(A),0,1) #debug str(dimension_size(A,2),0,1))",
       R"(6.02.03.0)"},
      {R"(#declare A = array[2]; #ifdef(A[1]) #debug "y" #else #debug "n" #end #declare A[1]=3; #ifdef(A[1]) #debug "y" #else #debug "n" #end #undef A[1])",
       R"(ny)"},
      {R"(#declare A = array[2]{1,2}; #debug str(A[1.7],0,1))", R"(2.0)"},
      {R"(#declare A = array[2]{<1,2,3>,<4,5,6>}; #debug str(A[1].y,0,1))", R"(5.0)"},
      {R"(#switch (3) #case (1) #debug "1" #range (2,4) #debug "r" #case (7) #debug "7" #break #else #debug "e" #end)",
       R"(r7)"},
      {R"(#switch (9) #case (1) #debug "1" #break #else #debug "e" #end)", R"(e)"},
      {R"(#macro M() (<1,2,3>) #end #macro N() #local V=<4,5,6>; V #end #declare A = 1+M().y; #debug str(A+N().z,0,1) #debug str((M().x),0,1))",
       R"(9.01.0)"},
      {R"(#switch (1) #case (1) #debug "1" #else #debug "e" #end #debug "z")", R"(1ez)"},
      {R"(#declare i=0; #while (1) #declare i=i+1; #if (i=4) #break #end #debug str(i,0,0) #end)", R"(123)"},
      {R"(#declare Fn = function(p,q){p*q+2}; #debug str(Fn(3,4),0,1))", R"(14.0)"},
      {R"(#declare Fn = function{x+y*z}; #debug str(Fn(3,4,5),0,1))", R"(23.0)"},
      {R"(#declare Fn = function(x){1|0&0};  #debug str(Fn(3),0,1))", R"(1.0)"},
      {R"(#declare Fn = function(x){x<2};  #debug str(Fn(1),0,1)#debug str(Fn(3),0,1))", R"(1.00.0)"},
      {R"(#declare Fn = function(x){select(x,1,2,3)};  #debug str(Fn(1),0,1))", R"(3.0)"},
      {R"(#declare Fn = function(x){select(x,1,2)};  #debug str(Fn(-1),0,1)#debug str(Fn(0),0,1))",
       R"(1.02.0)"},
      {R"(#declare Fn = function(x){sum(i,1,x,i*i)};  #debug str(Fn(4),0,1))", R"(30.0)"},
      {R"(#declare Fn = function(x){prod(i,1,x,i)};  #debug str(Fn(4),0,1))", R"(24.0)"},
      {R"(#declare Fn = function(x){-x*2 - -3};  #debug str(Fn(4),0,1))", R"(-5.0)"},
      {R"(#declare Fn = function{transform{translate <1,2,3>}}; #debug vstr(3,Fn(1,1,1),",",0,3) #declare G=function{Fn(x,y,z).y*2}; #debug str(G(1,1,1),0,1))",
       R"(2.000,3.000,4.0006.0)"},
      {R"(#declare S = spline{linear_spline 0,<0,0,0> 1,<2,4,6>}; #debug vstr(3,S(.5),",",0,3) #debug str(S(.5).y,0,2))",
       R"(1.000,2.000,3.0002.00)"},
      {R"(#declare S = spline{linear_spline 1,<3,2> 0,<1,7>}; #debug vstr(2,S(.25),",",0,3))",
       R"(1.500,5.750)"},
      {R"(#declare S = spline{0,<1,7> 1,<3,2> 0.5,<1,0>}; #debug vstr(2,S(.25),",",0,3))", R"(1.000,3.500)"},
      {R"(#macro A(p,q) p+q #end #debug str(A(1,2)*2,0,1))", R"(5.0)"},
      {R"(#macro A(p) concat(p,"x") #end #debug A("b"))", R"(bx)"},
      {R"(#macro A() #debug "in" #end A() #macro A() #debug "second" #end A())", R"(insecond)"},
      {R"(#declare X = vnormalize(V)*2; #debug str(vlength(X),0,2))", R"(2.00)"},
      {R"(#declare X=3; ; #debug "ok")", R"(ok)"},
      {R"(#declare Foo=sphere{0,1} #declare Bar = 3; object{Foo} #debug "ok")", R"(ok)"},
      {R"(#declare Foo=sphere{0,1} Foo #debug "ok")", R"(ok)"},
      {R"(#declare A=5; #declare A=V; #debug str(A.y,0,1))", R"(2.0)"},
      {R"(#declare A="x"; #declare A=V; #debug str(A.y,0,1))", R"(2.0)"},
      {R"(#declare A=V; #declare A=2; #debug str(A,0,1))", R"(2.0)"},
      {R"(#debug str(defined(V),0,1))", R"(1.0)"},
      {R"(#ifdef(sphere) #debug "y" #else #debug "n" #end)", R"(n)"},
      {R"(#debug str(1.e2,0,1) #debug str(.5e+1,0,1) #debug str(1E2,0,1))", R"(100.05.0100.0)"},
      {R"(#if (F) #debug "y" #elseif (1) #debug "z" #end)", R"(y)"},
      {R"(#if (0) #debug "y" #elseif (1) #debug "z" #else #debug "w" #end)", R"(z)"},
      {R"(# declare ZZ = 3; #debug str(ZZ,0,0) # if (1) #debug "k" # end)", R"(3k)"},
      {R"(#debug concat("a" "b"))", R"(ab)"},
      {R"(#debug str(vlength(5),0,4))", R"(8.6603)"},
      {R"(#debug str(asinh(1),0,5) #debug str(acosh(2),0,5) #debug str(atanh(.5),0,5) #debug str(tan(1),0,5) #debug str(sinh(1),0,5)#debug str(cosh(1),0,5)#debug str(tanh(1),0,5))",
       R"(0.881371.316960.549311.557411.175201.543080.76159)"},
      {R"(#debug str(yes,0,1)#debug str(on,0,1)#debug str(off,0,1)#debug str(no,0,1)#debug str(true,0,1)#debug str(false,0,1) #debug vstr(4,t,",",0,1)#debug vstr(2,u,",",0,1)#debug vstr(2,v,",",0,1))",
       R"(1.01.00.00.01.00.00.0,0.0,0.0,1.01.0,0.00.0,1.0)"},
      {R"(#local i=5; #for (i,1,2) #end #debug str(i,0,1))", R"(3.0)"},
      {R"(#for (i,1,2) #local i = 9; #debug str(i,0,1) #end)", R"(9.0)"},
      {R"(#for (i,1,0) #end #ifdef(i) #debug str(i,0,1) #end)", R"(1.0)"},
      {R"(#debug datetime(0) #debug "" #debug datetime(0,"%Y-%m-%d"))", R"(2000-01-01 00:00:00Z2000-01-01)"},
      {R"(#declare S = spline{quadratic_spline 0,<0,0,0> 1,<1,0,2> 3,<2,4,6> 4,<0,1,0>}; #debug vstr(3,S(5),",",0,4) #debug " " #debug vstr(3,S(-1),",",0,4))",
       R"(0.0000,1.0000,0.0000 0.0000,0.0000,0.0000)"},
      {R"(#declare S = spline{natural_spline 0,<0,0,0> 1,<1,0,2> 3,<2,4,6> 4,<0,1,0>}; #debug vstr(3,S(5),",",0,4) #debug " " #debug vstr(3,S(-1),",",0,4))",
       R"(0.0000,1.0000,0.0000 0.0000,0.0000,0.0000)"},
      {R"(#declare S = spline{linear_spline 0,<0,0,0> 1,<1,0,2> 3,<2,4,6> 4,<0,1,0>}; #debug vstr(3,S(5),",",0,4) #debug " " #debug vstr(3,S(-1),",",0,4))",
       R"(0.0000,1.0000,0.0000 0.0000,0.0000,0.0000)"},
      {R"(#declare S = spline{cubic_spline 0,<0,0,0> 1,<1,0,2> 3,<2,4,6> 4,<0,1,0>}; #debug vstr(3,S(1.5),",",0,6) #debug " "  #debug vstr(3,S(2),",",0,6))",
       R"(1.437500,0.953125,3.375000 1.875000,2.375000,5.000000)"},
      {R"(#declare S = spline{linear_spline 0,<0,0> 0,<1,5> 1,<2,6>}; #debug vstr(2,S(0),",",0,6))",
       R"(1.000000,5.000000)"},
      {R"(#declare S = spline{linear_spline 0,<0,0> 1,<1,0> 1,<5,0> 2,<2,0>}; #declare T = spline{linear_spline 0,<0,0> 1,<1,0> 2,<2,0> 1,<5,0>}; #declare U = spline{S 2,<9,0> 1,<7,0>}; #debug vstr(3,<S(1).x,T(1).x,U(2).x>,",",0,1) #debug str(U(1).x,0,1))",
       R"(1.0,5.0,2.07.0)"},
      {R"(#declare S = spline{linear_spline 0,<0,0,1,2> 1,<1,2,3,4>}; #debug vstr(4,S(.5),",",0,3))",
       R"(0.500,1.000,2.000,3.000)"},
      {R"(#declare S = spline{linear_spline 0,<0,0,1,2,5> 1,<1,2,3,4,5>}; #declare S2=spline{S quadratic_spline 2,<0,0,0,0,0>}; #debug vstr(5,S2(.5),",",0,3))",
       R"(0.750,1.500,2.625,3.750,5.625)"},
      {R"(#declare S = spline{quadratic_spline 0,<0,0> 1,<1,2>}; #debug vstr(2,S(.25),",",0,3))",
       R"(0.250,0.500)"},
      {R"(#declare S = spline{natural_spline 0,<0,0> 1,<1,2>}; #debug vstr(2,S(.25),",",0,3))",
       R"(0.250,0.500)"},
      {R"(#debug str(int(5.99999999999),0,1) #debug str(mod(6,0),0,1))", R"(5.0-nan)"},
      {R"(#debug str(val("0x10"),0,1)#debug str(strcmp("abc","b"),0,1) #debug str(strcmp("b","abd"),0,1) #debug str(strcmp("abc","ab"),0,1))",
       R"(16.0-1.01.099.0)"},
      {R"(#debug vstr(3,V,"-",8,2))", R"(    1.00-    2.00-    3.00)"},
      {R"(#debug vstr(3,C,",",0,2) #debug vstr(5,V,",",0,2))", R"(0.10,0.20,0.301.00,2.00,3.00,0.00,0.00)"},
      {R"(#debug vstr(3,vrotate(V,90),",",0,2))", R"(3.00,2.00,-1.00)"},
      {R"(#macro A(p) #local p = 7; #end #declare A1=array[2]{1,2}; A(A1[0]) #debug str(A1[0],0,1))",
       R"(7.0)"},
      {R"(#macro A(p) #declare p[0] = 7; #end #declare A1=array[2]{1,2}; A(A1) #debug str(A1[0],0,1))",
       R"(7.0)"},
      {R"(#macro A(p) #undef p #end #declare G=1; A(G) #ifdef(G) #debug "def" #else #debug "undef" #end)",
       R"(def)"},
      {R"(#declare A1=array[2]{sphere{0,1},sphere{0,2}}; #debug "ok" object{A1[0]})", R"(ok)"},
      {R"(#declare A1=array[2]{sphere{0,1} sphere{0,2}} object{A1[1] scale 2} #debug "ok")", R"(ok)"},
      {R"(#declare T=transform{translate x} sphere{0,1 transform T} sphere{0,1 transform{T}} #debug "ok")",
       R"(ok)"},
      {R"(#declare L=array[2]{function(x){x}, function(x){x*2}}; #debug str(L[1](3),0,1))", R"(6.0)"},
      {R"(#declare i=3; #switch(i) #range(1,2) #debug "a" #break #case(3) #debug "b" #case(4) #debug "c" #break #case(5) #debug "d" #else #debug "e" #end)",
       R"(bc)"},
      {R"(#declare F2=function(x,y){ x*y }; #declare F3=function{F2(x,y)+F2(z,2)}; #debug str(F3(1,2,3),0,1))",
       R"(8.0)"},
      {R"(#declare F2=function(r){ r*2 }; #declare F3=function(r,w){F2(w)-r}; #debug str(F3(1,2),0,1))",
       R"(3.0)"},
      {R"(#declare F2=function(x){ degrees(x)+radians(x)+div(x,2) }; #debug str(F2(3),0,4))", R"(172.9397)"},
      {R"(#declare F2=function(x){ x - 2 - 3*x/4/2 }; #debug str(F2(3),0,4))", R"(-0.1250)"},
      {R"(#declare F2=function(x){ -x*x }; #debug str(F2(3),0,4))", R"(-9.0000)"},
      {R"(#declare F2=function(x){ 1 = x | 2 = x & 0 }; #debug str(F2(1),0,4))", R"(1.0000)"},
      {R"(#declare F2=function(x){ 1e3*x + .5 }; #debug str(F2(1),0,4))", R"(1000.5000)"},
      {R"(#declare F2=function(x){ 1<x<3 }; #debug str(F2(5),0,4))", R"(1.0000)"},
      {R"(#declare F2=function(x){ 1+x<3 }; #debug str(F2(5),0,4))", R"(0.0000)"},
      {R"(#macro A(a,b) #local c=a; #declare a=b; #declare b=c; #end #declare p=1; #declare q=2; A(p,q) #debug str(p,0,0) #debug str(q,0,0))",
       R"(21)"},
      {R"(#macro A(s) #if(s>0) #debug str(s,0,0) A(s-1) #debug str(s,0,0) #end #end A(3))", R"(321123)"},
      {R"(#macro A(s) #local k=0; #while(k<3) #local k=k+1; #if(k=2) #break #end #end #debug str(k,0,0) #end A(3))",
       R"(2)"},
      {R"(#declare A=array[3][2]{{1,2}{3,4}{5,6}} #debug str(A[2][0],0,0) #debug str(dimension_size(A,1),0,0))",
       R"(53)"},
      {R"(#declare A=array[2]{array[2]{1,2},array[2]{3,4}} #debug str(A[1][0],0,0))", R"(3)"},
      {R"(#declare i=0; #while(i<2) #switch(i) #case(0) #debug "zero" #break #case(1) #debug "one" #break #end #declare i=i+1; #end)",
       R"(zeroone)"},
      {R"(#declare T=function{transform{translate <1,2,3>}} #declare G=function(x,y,z){T(x,y,z).y} #debug str(G(0,0,0),0,1))",
       R"(2.0)"},
      {R"(#ifdef(nope) #error "x" #else #debug "e" #end #ifndef(nope) #debug "n" #end)", R"(en)"},
      {R"(#local a1=#if(1) 3; #end #debug str(a1,0,0))", R"(3)"},
  };
  for (const auto& [text, said] : cases) EXPECT_EQ(debug_of(kStart + text), said) << text;
}

// By POV-Ray 3.7.0.10, too.
TEST(PovLanguage, RandomNumbersAreThoseOfPovRay) {
  const std::string next = " #debug concat(str(rand(R), 0, 17), \" \")";
  EXPECT_EQ(debug_of("#declare R = seed(0);" + next + next), "0.00000287429429658 0.46656368450880137 ");
  EXPECT_EQ(debug_of("#declare R = seed(1);" + next + next), "0.42199287526821549 0.48712119820693534 ");
  EXPECT_EQ(debug_of("#declare R = seed(123456);" + next + next), "0.19755098065304361 0.41497421041479665 ");
}

TEST(PovLanguage, RedIsDecodedFromSrgb) {
  EXPECT_EQ(debug_of("#declare X = srgbft <.1,.5,.02,.3,.4>; #debug vstr(5, X, \",\", 0, 6)"),
            "0.010023,0.214041,0.001548,0.300000,0.400000");
  EXPECT_EQ(debug_of("#declare X = srgb <.1,.5,.02>*2; #debug vstr(3, X, \",\", 0, 6)"),
            "0.033105,1.000000,0.003096");
}

// By POV-Ray 3.7.0.10, too.
TEST(PovLanguage, StringsAreCompared) {
  EXPECT_EQ(debug_of("#declare S = \"x\"; #if (S = \"x\" & S != \"y\") #debug \"a\" #end "
                     "#if (\"abc\" < \"abd\") #debug \"b\" #end #if (\"abc\" = \"ABC\") #debug \"c\" #end "
                     "#if (concat(\"a\", S) >= \"ax\") #debug \"d\" #end"),
            "abd");
  EXPECT_EQ(debug_of("#declare A = array[2] {\"p\", \"q\"} #macro M(s) #if (s != \"\") #debug s #end #end "
                     "M(A[1]) M(\"\") #if (A[0] < A[1] & 1 < 2) #debug \"!\" #end"),
            "q!");
  EXPECT_EQ(error_of("#if (\"a\") #end"), "a.pov:1:9: expected a comparison behind a string, found ')'");
  EXPECT_EQ(error_of("#if (\"a\" = 1) #end"), "a.pov:1:12: expected a string, found the number 1");
  EXPECT_EQ(error_of("#declare S = \"a\"; #if (1 = S) #end"),
            "a.pov:1:28: expected a number, a vector or a colour, found 'S', which is a string");
}

// By POV-Ray 3.7.0.10, too.
TEST(PovLanguage, ValuesMayEndInTheTextOfAMacro) {
  // The ';' ends the declaration, and what it declares stands outside of the macro.
  EXPECT_EQ(debug_of("#macro V() #local Q = 3; Q; #end #declare Q = V() #debug str(Q, 0, 0) "
                     "#macro W() #local R = V() #debug str(R, 0, 0) #end W()"),
            "33");
  EXPECT_EQ(
      debug_of("#macro V(A) #if (A) A; #else 7; #end #end #macro W() #local R = V(0) #local R = R + V(2) "
               "#debug str(R, 0, 0) #end W() #ifdef (R) #debug \"left\" #end"),
      "9");
}

TEST(PovLanguage, WhatPovRayIsLenientWith) {
  // Commas between the values of a macro, a '#' without a directive, the texture that a macro is given at
  // once.
  EXPECT_EQ(debug_of("#macro M(A, B) #debug str(A - B.x, 0, 0) #end M(5 <2,0,0>)"), "3");
  EXPECT_EQ(read("camera { look_at <0,2,0>#\n}").document.statements.size(), 1u);
  const Document document =
      read("#macro M(T) sphere { 0, 1 texture { T } } #end #declare T = texture { pigment { rgb 1 } }\nM(T)")
          .document;
  EXPECT_EQ(document.statements.size(), 1u);
  EXPECT_EQ(error_of("#macro M(A) #end M(5"),
            "a.pov:1:21: expected ')', as macro 'M' takes 1 value, found the end of the file");
}

TEST(PovLanguage, EntriesWithoutANumberHaveTheWeightOne) {
  const Document document = read(
                                "pigment { average pigment_map { [function { x } color_map { [0 rgb 0] }] "
                                "[2 rgb 1] } }")
                                .document;
  const auto inner = [](const Element& e) { return std::get<std::shared_ptr<const Block>>(e.value); };
  const auto map = inner(inner(document.statements.at(0))->elements.at(1));
  const auto first = inner(map->elements.at(0)), second = inner(map->elements.at(1));
  ASSERT_EQ(first->elements.size(), 3u);
  EXPECT_EQ(std::get<Numbers>(first->elements[0].value).v[0], 1);
  EXPECT_EQ(std::get<Numbers>(second->elements.at(0).value).v[0], 2);
}

TEST(PovLanguage, QuestionsGoToTheCaller) {
  UnitSphere sphere;
  ReadOptions options;
  options.queries = &sphere;
  const std::string object = "#declare O = sphere { 0, 1 } ";
  EXPECT_EQ(debug_of(object + "#debug str(inside(O, x*.5) + inside(O, x*2), 0, 0)", options), "1");
  EXPECT_EQ(
      debug_of(object + "#declare N = x; #declare P = trace(O, -5*z, z, N); #debug vstr(3, P+N, \",\", 0, 0)",
               options),
      "0,0,-2");
  EXPECT_EQ(debug_of(object + "#debug vstr(3, max_extent(O), \",\", 0, 0)", options), "1,1,1");
  EXPECT_EQ(debug_of("#declare G = function { internal(7) } #debug str(G(3, 1), 0, 0)", options), "10");
  EXPECT_EQ(
      debug_of("#declare G = function { pigment { gradient x } } #declare H = function { G(x, y, z).gray } "
               "#debug str(H(2, 0, 0), 0, 1)",
               options),
      "2.0");
  EXPECT_EQ(error_of(object + "box { inside(O, 0) }"),
            "a.pov:1:36: 'inside' is not available here: it needs the objects of the scene");
}

TEST(PovLanguage, ErrorsNameThePlace) {
  const Cases cases{
      {"#declare X = 5;\nsphere { Y, 1 }", "2:10: nothing is declared as 'Y'"},
      {"#macro A(p)\n p +\n#end\n#macro B(q) A(q) #end\nsphere { B(1) }",
       "5:15: expected a number, a vector or a colour, found '}'"},
      {"#macro A(p)\n sqrt(p)\n#end\n#macro B(q) A(q) #end\nsphere { B(-1) }",
       "2:2: the square root of a negative number; in macro 'A' called at a.pov:4:13, in 'B' called at "
       "a.pov:5:10"},
      {"#if (1)\nsphere { 0, 1 }", "1:1: this directive has no #end"},
      {"sphere { 0, 1", "1:1: this block has no '}'"},
      {"#declare sphere = 3;", "1:10: expected a name to declare, found the keyword 'sphere'"},
      {"#end", "1:1: there is no directive that this ends"},
      {"#break", "1:1: there is no loop or #switch to leave"},
      {"#declare A = array[2]; box { A[2] }",
       "1:32: index 2.000000 is out of range: the array 'A' has elements 0 to 1"},
      {"#error concat(\"a\", \"b\")", "1:1: the scene stops here: ab"},
      {"#decalre X = 3;", "1:2: expected a directive behind '#', found 'decalre'; did you mean 'declare'?"},
      {"/* x", "1:1: the comment that starts here has no end"},
      {"box { \"abc", "1:7: the string that starts here has no end"},
      {"#macro M(a) a #end M(1, 2)", "1:25: expected ')', as macro 'M' takes 1 value, found the number 2"},
      {"#declare F = function(p) { p + qq };",
       "1:32: the function has no parameter 'qq', and nothing is declared by this name"},
      {"box { <1,2>.z }", "1:13: this vector of 2 has no component 'z'"},
      {"#for (I, 0, 1, 0) #end", "1:16: the step of #for must not be 0"},
      {"@", "1:1: unexpected character '@'"},
      {"#declare X = \"\\q\";", "1:15: unknown character behind a backslash in a string: 'q'"},
      {"#include \"nope.inc\"",
       "1:1: cannot include 'nope.inc': no such file beside 'a.pov' or in a library folder"},
      {"#fopen F \"a\" read",
       "1:8: #fopen is not allowed: the option --files names a folder for files of scenes"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(error_of(text), "a.pov:" + message) << text;
}

TEST(PovLanguage, LimitsEndEachKindOfExcess) {
  ReadOptions options;
  options.limits.steps = 1000;
  options.limits.values = 100;
  options.limits.array_elements = 50;
  options.limits.string_length = 100;
  options.limits.macro_depth = 20;
  options.limits.nesting = 30;
  options.limits.value_depth = 10;
  const std::string open(50, '(');
  std::string blocks;
  for (int i = 0; i < 50; ++i) blocks += "union { ";
  const Cases cases{
      {"#while (1) #declare X = 1; #end", "the scene takes more than 1000 steps"},
      {"#for (I, 1, 1e9) #end #while (1) #debug \"\" #end", "the scene takes more than 1000 steps"},
      {"#for (I, 1, 300) sphere { I, 1 } #end", "more than 100 values"},
      {"#declare A = array[51];", "arrays have more than 50 elements"},
      {"#declare S = \"0123456789\"; #while (1) #declare S = concat(S, S); #end",
       "a string is longer than 100 characters"},
      {"#macro M() M() #end M()", "more than 20 calls of macros within each other"},
      {"box { " + open + "1", "more than 30 blocks, parentheses and directives within each other"},
      {blocks, "more than 30 blocks, parentheses and directives within each other"},
      {"#declare O = sphere { 0, 1 } #while (1) #declare O = union { object { O } } #end",
       "more than 10 declared values within each other"},
      {"#declare F = function(x) { x } #while (1) #declare F = function(x) { F(x) } #end",
       "more than 10 declared values within each other"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_NE(error_of(text, options).find(message), std::string::npos) << text << error_of(text, options);
}

// What would take long counts as many steps or values.
TEST(PovLanguage, NothingTakesForever) {
  const auto repeated = [](const char* text, int count) {
    std::string result;
    for (int i = 0; i < count; ++i) result += text;
    return result;
  };
  ReadOptions options;
  options.limits.steps = 200'000;
  options.limits.values = 1'000'000;
  options.limits.array_elements = 1'000'000;
  const std::string nested = "blocks, parentheses and directives within each other";
  const std::string steps = "the scene takes more than 200000 steps";
  const std::string comment = "/*" + std::string(100'000, 'x') + "*/";
  const std::string points = repeated("1,<1,2,3> ", 1000);
  const Cases cases{
      {"#declare X = " + repeated("(", 100'000), nested},
      {"#declare X = (" + repeated("1?", 100'000), nested},
      {"#declare X = " + repeated("sin(", 100'000), nested},
      {"#declare X = " + repeated("<1,", 100'000), nested},
      {"#declare F = function { " + repeated("(", 100'000), nested},
      {"#declare F = function { " + repeated("sum(i,1,2,", 100'000), nested},
      {"#declare S = " + repeated("concat(", 100'000), nested},
      {"#declare A = " + repeated("array[1] { ", 100'000), nested},
      {"#declare A = array[2]; #declare X = " + repeated("A[", 100'000), nested},
      {"#macro M(n) n #end #declare X = " + repeated("M(", 100'000), nested},
      {"#declare T = " + repeated("union {", 100'000), nested},
      {"pigment { color_map { " + repeated("[", 100'000), nested},
      {"#while (1) " + comment + " #end", steps},
      {"#while (1) #if (0) " + comment + " #end #end", steps},
      {"#macro M() " + comment + " M() #end M()", steps},
      {"#declare S = \"" + std::string(100'000, 'x') + "\"; #while (1) #declare T = S; #end", steps},
      {"#declare A = array[100000]; #declare A[0] = 1; #while (1) #declare B = A; #declare B[0] = 2; #end",
       steps},
      {"#while (1) #declare A = array[100000]; #end", steps},
      {"#while (1) #default { finish { ambient 0 } } #end", "more than 1000000 values"},
      {"#declare S = spline { natural_spline 0,x " + points +
           "}; #while (1) #declare X = S(.5, linear_spline); #end",
       steps},
      {"#declare F = function(x) { x } " + repeated("#declare F = function(x) { F(x) + F(x) } ", 100) +
           "#declare X = F(1);",
       steps},
      {"#declare F = function(x) { sum(i, 1, 1e12, i * x) } #declare X = F(1);", steps},
      {"#declare A = array[1]; #while (1) #declare B = array[1]; #declare B[0] = A; #declare A = B; #end",
       "more than 1000 declared values within each other"},
      {"#while (1) #if (file_exists(\"nope\")) #end #end", steps},
      {std::string(100'000, 'a'), "nothing is declared as 'aaa"},
  };
  for (const auto& [text, message] : cases) {
    const std::string said = error_of(text, options);
    EXPECT_NE(said.find(message), std::string::npos) << text.substr(0, 100) << ": " << said.substr(0, 300);
    EXPECT_TRUE(said.starts_with("a.pov:1:")) << said.substr(0, 300);
  }
}

TEST(PovLanguage, TransformsThatDoubleAreComputedOnce) {
  std::string text = "#declare T = transform { translate 0 } #declare S = transform { translate x } ";
  for (int i = 0; i < 200; ++i) text += "#declare T = transform { transform T transform T } ";
  text +=
      "#declare F = function { transform { transform T transform S } } #debug vstr(3, F(1, 2, 3), \",\", 0, "
      "0)";
  EXPECT_EQ(debug_of(text), "2,2,3");
  EXPECT_EQ(
      error_of("#declare F = function { transform { scale <1,0,1> matrix 3 } } #declare X = F(1, 2, 3);"),
      "a.pov:1:51: expected a vector of 12 numbers behind 'matrix'");
}

/// Include files that change the version and are to leave it put it back themselves.
TEST(PovLanguage, VersionsOfIncludesStay) {
  const TempDir dir;
  dir.write("old.inc", "#version 3.5;");
  std::string said;
  ReadOptions options;
  options.said = [&said](const std::string& text) { said += text; };
  const std::string scene =
      dir.write("a.pov", "#version 3.7; #include \"old.inc\" #debug str(version, 0, 1)");
  EXPECT_EQ(pov::read_pov(scene, options).version, 3.5);
  EXPECT_EQ(said, "3.5");
}

TEST(PovLanguage, ConditionsLeaveTheirDirectiveAlone) {
  const std::string message = "what ends here began before the condition that this stands in";
  EXPECT_EQ(error_of("#switch (1) #case ( #end 2) #end"), "a.pov:1:21: " + message);
  EXPECT_EQ(error_of("#if (1) #while ( #end 1) #end"), "a.pov:1:18: " + message);
  EXPECT_EQ(error_of("#while (1) #if ( #break 1) #end #end"), "a.pov:1:18: " + message);
  EXPECT_EQ(error_of("#macro M() 3) #end #while (M() #end"),
            "a.pov:1:12: the condition of this directive does not end where it began; in macro 'M' called at "
            "a.pov:1:28");
  EXPECT_EQ(debug_of("#macro M(a) #debug str(a, 0, 0) #end M( #undef M 3)"), "3");
  EXPECT_EQ(error_of("#declare A = array[1]; #if (defined(A[ #undef A 0])) #end"), "no error");
  EXPECT_EQ(error_of("#declare F = function() { spline { 0,x, 1,y } }"),
            "a.pov:1:27: a function of a spline takes a parameter");
}

TEST(PovLanguage, OddTextsAreReadOrRefused) {
  EXPECT_EQ(error_of("sphere { 0, 1 }"), "no error");
  EXPECT_EQ(error_of(std::string("box { 0, 1 } \0 ", 16)), "a.pov:1:14: unexpected character '?'");
  EXPECT_EQ(error_of("#if (0)" + std::string(1000, '\0') + "#end"), "no error");
  EXPECT_EQ(error_of("#declare X = " + std::string(100'000, '9') + ";"), "no error");
}

TEST(PovLanguage, BlocksHoldValuesWordsAndBlocksInOrder) {
  const Document document = read(kStart +
                                 "#declare T = texture { pigment { C } }\n"
                                 "sphere { V, 1 -2 texture { T } translate -x*2 scale <1, 2, 3>*2 }")
                                .document;
  ASSERT_EQ(document.statements.size(), 1u);
  const Block& sphere = block_at(document.statements, 0);
  EXPECT_EQ(sphere.keyword, "sphere");
  EXPECT_EQ(sphere.where.line, 3u);
  EXPECT_EQ(numbers_at(sphere, 0).v, (std::array<double, 5>{1, 2, 3, 0, 0}));
  EXPECT_EQ(numbers_at(sphere, 1).v[0], -1);
  const Block& texture = block_at(sphere.elements, 2);
  EXPECT_EQ(block_at(texture.elements, 0).name, "T");
  EXPECT_TRUE(numbers_at(block_at(block_at(texture.elements, 0).elements, 0), 0).is_color);
  EXPECT_EQ(word_at(sphere, 3), "translate");
  EXPECT_EQ(numbers_at(sphere, 4).v[0], -2);
  EXPECT_EQ(numbers_at(sphere, 6).v[2], 6);
}

TEST(PovLanguage, EntriesOfMapsAreBlocks) {
  const Document document = read(
                                "#declare A = rgb 1; pigment { color_map { [0.5 color A filter .25] [0.2, "
                                "0.4 color A color red 1] } }")
                                .document;
  const Block& map = block_at(block_at(document.statements, 0).elements, 0);
  EXPECT_EQ(map.keyword, "color_map");
  const Block& first = block_at(map.elements, 0);
  EXPECT_EQ(first.keyword, "[");
  EXPECT_EQ(numbers_at(first, 1).v[3], 0.25);
  EXPECT_EQ(block_at(map.elements, 1).elements.size(), 4u);
}

TEST(PovLanguage, LongVectorsAndWordsThatAreFunctionsToo) {
  const Document document =
      read(
          "quartic { <1,2,3,4,5,6,7,8,9,10,11,12,13,14,15> sturm } julia_fractal { <1,2,3,4> sqr } "
          "julia_fractal { 0 pwr(2, -1) }")
          .document;
  const Block& list = block_at(block_at(document.statements, 0).elements, 0);
  EXPECT_EQ(list.keyword, "<");
  EXPECT_EQ(list.elements.size(), 15u);
  EXPECT_EQ(word_at(block_at(document.statements, 1), 1), "sqr");
  EXPECT_EQ(word_at(block_at(document.statements, 2), 1), "pwr");
  EXPECT_EQ(numbers_at(block_at(document.statements, 2), 3).v[0], -1);
}

TEST(PovLanguage, DefaultsAddUp) {
  const Document document =
      read("#default { texture { pigment { rgb 1 } } } #default { finish { ambient 0 } } sphere { 0, 1 }")
          .document;
  const Block& sphere = block_at(document.statements, 0);
  ASSERT_NE(sphere.default_texture, nullptr);
  EXPECT_EQ(block_at(sphere.default_texture->elements, 0).keyword, "pigment");
  EXPECT_EQ(block_at(sphere.default_texture->elements, 1).keyword, "finish");
}

TEST(PovLanguage, WarningsAreKept) {
  const Document document = read("\n #warning \"mind\" ").document;
  ASSERT_EQ(document.warnings.size(), 1u);
  EXPECT_EQ(document.warnings[0].message, "mind");
  EXPECT_EQ(document.warnings[0].where.line, 2);
}

TEST(PovLanguage, DefinitionsOfTheCaller) {
  ReadOptions options;
  options.definitions = {{"N", 3.0}, {"T", std::string("t")}};
  options.clock = 0.5;
  EXPECT_EQ(debug_of("#debug concat(T, str(N + clock, 0, 1), str(image_width, 0, 0))", options), "t3.5800");
}

TEST(PovLanguage, FilesStayInTheirFolder) {
  const TempDir folder, other;
  std::filesystem::create_symlink(other.path(), folder.path() / "link");
  ReadOptions options;
  options.file_folder = folder.path().string();
  EXPECT_EQ(
      debug_of(
          "#fopen H \"t\" write #write (H, 7, \",\\\"a\\\", \", <1,2>, \" -3 \") #fclose H #fopen H \"t\" "
          "read "
          "#while (defined(H)) #read (H, A, B, X, D) #debug concat(str(A, 0, 0), B, vstr(2, X, \",\", 0, 0), "
          "str(D, 0, 0)) #end",
          options),
      "7a1,2-3");
  EXPECT_EQ(file_content(folder.path() / "t"), "7,\"a\", <1,2>  -3 ");
  for (const std::string path : {"../t", "/tmp/t", "link/t", "a/../../t", "link"})
    EXPECT_NE(error_of("#fopen H \"" + path + "\" write", options).find("cannot open '" + path + "'"),
              std::string::npos);
  // A zero byte would hide the dots from a comparison, but not from the system.
  EXPECT_NE(error_of("#fopen H \"..\\0/t\" write", options).find("a path has no zero byte"),
            std::string::npos);
  EXPECT_EQ(file_count(other), 0u);
}

TEST(PovLanguage, IncludesHaveScopesAndPlaces) {
  const TempDir dir;
  dir.write("b.inc", "#local L = 1; #declare G = 2; #ifdef (L) #declare H = L; #end");
  const std::string path =
      dir.write("a.pov", "#include \"b.inc\" #ifdef (L) #error \"L\" #end sphere { G, H }");
  const Document document = pov::read_pov(path);
  EXPECT_EQ(document.files.size(), 2u);
  EXPECT_EQ(numbers_at(block_at(document.statements, 0), 0).v[0], 2);
  // A declaration may end with the file.
  dir.write("d.inc", "#declare A = 5");
  EXPECT_NO_THROW(pov::read_pov(dir.write("d.pov", "#include \"d.inc\" #declare B = A;")));
  // Names may lack their ending.
  EXPECT_EQ(pov::read_pov(dir.write("e.pov", "#include \"d\" #declare B = A;")).files.size(), 2u);
  const std::string again = dir.write("c.pov", "#include \"c.pov\"");
  EXPECT_THROW(pov::read_pov(again), Error);
}

/// Macros give values of any kind, within each other, too.
TEST(PovLanguage, MacrosThatGiveValuesCallOthers) {
  const std::string inner = "#macro A() #local M = array[1]; #local M[0] = 2; M #end ";
  EXPECT_EQ(debug_of(inner + "#macro B() #local D = A(); D #end #declare E = B(); #debug str(E[0], 0, 0)"),
            "2");
  EXPECT_EQ(debug_of("#macro A() \"x\" #end #macro B() #local D = A(); #if (1) concat(D, \"y\") #end #end "
                     "#declare E = B(); #debug E"),
            "xy");
  EXPECT_EQ(
      debug_of("#macro A() \"x\" #end #macro B() #local D = A() #debug D D #end #declare E = B() #debug E"),
      "xx");
}

TEST(PovLanguage, NamesAreDeclaredBeforeAValue) {
  EXPECT_EQ(debug_of("#declare A =\n#declare B = 2;\n#local C = 3; B + C; #debug str(A, 0, 0)"), "5");
  EXPECT_EQ(debug_of("#declare A = #if (1) 4 #else 5 #end; #debug str(A, 0, 0)"), "4");
}

// What the packages of POV-Ray install.
TEST(PovLanguage, StandardIncludesAreRead) {
  const std::filesystem::path folder = "/usr/share/povray-3.7/include";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no include files of POV-Ray";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".inc")) continue;
    // Some need the names of others.
    EXPECT_EQ(error_of("#include \"colors.inc\" #include \"shapes.inc\" #include \"" + name + "\""),
              "no error")
        << name;
  }
}

TEST(PovLanguage, MacrosOfStandardIncludes) {
  if (!std::filesystem::exists("/usr/share/povray-3.7/include"))
    GTEST_SKIP() << "no include files of POV-Ray";
  EXPECT_EQ(
      debug_of("#include \"math.inc\" #debug concat(str(VAngleD(x, y), 0, 4), str(clip(5, 1, 3), 0, 2))"),
      "90.00003.00");
  EXPECT_EQ(debug_of("#include \"transforms.inc\" #declare T = Reorient_Trans(x, y) "
                     "#debug vstr(3, vtransform(x, T), \",\", 0, 4)"),
            "0.0000,1.0000,0.0000");
  EXPECT_EQ(debug_of("#include \"arrays.inc\" #declare A = array[5]{5,3,9,1,2} Sort_Array(A) "
                     "#for (i, 0, 4) #debug str(A[i], 0, 0) #end"),
            "12359");
}

TEST(PovLanguage, ExampleScenesAreRead) {
  const std::filesystem::path folder = "/usr/share/doc/povray/examples/objects";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no example scenes of POV-Ray";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".pov") continue;
    EXPECT_NO_THROW(EXPECT_FALSE(pov::read_pov(entry.path().string()).statements.empty())) << entry.path();
  }
}

}  // namespace
}  // namespace oktett::test::pov_language_test

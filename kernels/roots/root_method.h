#pragma once
/// \file How the roots of polynomials are found.

namespace oktett::roots {

/// Greatest degree of a polynomial.
inline constexpr int kMaxDegree = 32;

/// How the roots of a polynomial are found. The last three prove nothing: with them rays may miss a surface.
enum class Method {
  automatic,  ///< the fastest for the degree among those that prove their answer
  closed,     ///< closed forms up to degree 4; `bernstein` above
  bernstein,  ///< isolation by the signs of Bernstein coefficients
  sturm,      ///< isolation by Sturm chains
  laguerre,   ///< Laguerre's method
  bisection,  ///< sampling and bisection
  newton,     ///< Newton's method between critical points
};

/// How the zeros of a polynomial along a ray are found.
void describe_root_finder(auto& p, Method& method) {
  p.choice("root_finder", method,
           {{"auto", Method::automatic},
            {"closed", Method::closed},
            {"bernstein", Method::bernstein},
            {"sturm", Method::sturm},
            {"laguerre", Method::laguerre},
            {"bisection", Method::bisection},
            {"newton", Method::newton}},
           "how zeros along a ray are found; [which of them prove what](roots.md)");
}

}  // namespace oktett::roots

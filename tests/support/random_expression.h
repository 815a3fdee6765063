#pragma once
/// \file Random functions of x, y and z.

#include <random>
#include <string>

namespace oktett {

/// A random expression of every function there is.
inline std::string random_expression(std::mt19937& random, int depth) {
  if (depth == 0 || random() % 8 == 0) {
    static const char* const kLeaves[] = {"x", "y", "z", "0.7", "2", "(-1.3)", "pi"};
    return kLeaves[random() % 7];
  }
  static const char* const kUnary[] = {"sqrt",  "abs",  "sin",   "cos",  "tan",  "asin",
                                       "acos",  "atan", "exp",   "log",  "log2", "log10",
                                       "floor", "ceil", "round", "sign", "-"};
  static const char* const kPowers[] = {"^2", "^3", "^-1", "^-2", "^0", "^1.5", "^-0.3", "^7", "^0.5"};
  const std::string a = random_expression(random, depth - 1), b = random_expression(random, depth - 1);
  switch (random() % 13) {
    case 0:
    case 1:
    case 2:
    case 3:
      return std::string(kUnary[random() % 17]) + "(" + a + ")";
    case 4:
      return "(" + a + ")" + kPowers[random() % 9];
    case 5:
      return "(" + a + "+" + b + ")";
    case 6:
      return "(" + a + "-(" + b + "))";
    case 7:
      return "((" + a + ")*(" + b + "))";
    case 8:
      return "((" + a + ")/(" + b + "))";
    case 9:
      return (random() % 2 ? "min(" : "max(") + a + "," + b + ")";
    case 10:
      return (random() % 2 ? "hypot(" : "atan2(") + a + "," + b + ")";
    case 11:
      return (a.size() % 2 != 0 ? "noise(" : "povray_noise(") + a + "," + b + "," +
             random_expression(random, depth - 1) + ")";
    default:
      return "(" + a + ")^(" + b + ")";
  }
}

}  // namespace oktett

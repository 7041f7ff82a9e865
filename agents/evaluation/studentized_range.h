// The studentized range distribution: of the range of k standard normal values over an independent
// estimate of their standard deviation with df degrees of freedom. Tukey's and Games and Howell's
// tests need it, and Boost has none.
//
//   W(w) = k  integral phi(z) (Phi(z) - Phi(z - w))^(k-1) dz         the range itself
//   P(q) = integral f_df(s) W(q s) ds,   s = chi_df / sqrt(df)       studentized
//
// Both integrals are taken by the trapezoidal rule, which converges exponentially for functions
// that are analytic and vanish at both ends (Trefethen and Weideman, SIAM Review 56, 2014); the
// outer one in t = ln s, with the weights normalised by their own sum. Good to 1e-12 (tests compare
// with k = 2, which is Student's t, with other step lengths and with published tables).
#pragma once

namespace forewalk::agents {

/// P(range <= q), absolute error below 1e-12. Degrees of freedom may be infinite; above 1e10 they
/// are taken to be.
///
/// REQUIRES: k from 2 to 1000; df > 0; q not NaN (below 0 gives 0, infinity 1). About 0.2 ms.
double studentizedRangeBelow(double q, int k, double df);

/// P(range > q), as well absolutely, and to 1e-7 relatively down to 1e-12.
double studentizedRangeAbove(double q, int k, double df);

/// The q that is exceeded with chance p: q(0.05; k, df) of the tables. Good to 1e-10 relatively.
///
/// REQUIRES: 0 < p < 1; k and df as above. Costs some ten evaluations.
double studentizedRangeQuantile(double p, int k, double df);

}  // namespace forewalk::agents

// The matrix of an elastic body, shifted, factorised once and solved many times: MUMPS, with a METIS ordering
// of the nodes.
//
// Owns the factors (RAII, movable). MUMPS keeps global state, so its calls are serialised by a mutex: objects
// may live on any thread, but only one works at a time. BLAS is set to one thread for the whole process, so
// that the factors, and with them every mode, are the same on any machine. Cost: 75,000 degrees of freedom
// take about 0.8 s, 190 MB, and 70 ms a solve. Source: Amestoy et al., "A fully asynchronous multifrontal
// solver", 2001; Karypis & Kumar, METIS, 1998.
#pragma once

#include <memory>

#include "intaglio/core/error.h"
#include "intaglio/sound/fem/assemble.h"

namespace intaglio::sound {

enum class Definiteness { positive, indefinite };

class Factorisation {
 public:
  // Factorises K - shift * M. Fails when it is singular, or, said to be positive definite, is not, or when
  // memory runs out.
  static Result<Factorisation> of(const ElasticSystem& system, double shift, Definiteness definiteness);

  Factorisation(Factorisation&&) noexcept;
  Factorisation& operator=(Factorisation&&) noexcept;
  ~Factorisation();

  // Overwrites the columns of `b` with the solutions of A x = b. The columns are solved together, which is
  // several times faster than one by one.
  void solve(Eigen::MatrixXd& b) const;

  // How many eigenvalues of the matrix are negative (Sylvester's law of inertia). Indefinite factorisations
  // only.
  int negative_eigenvalues() const;

 private:
  struct Instance;
  explicit Factorisation(std::unique_ptr<Instance> instance);

  std::unique_ptr<Instance> instance_;
};

}  // namespace intaglio::sound
